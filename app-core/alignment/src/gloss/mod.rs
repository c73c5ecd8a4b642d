//! Gloss of the toy, estimated from the reflection of its surface beyond the diffuse one.
//!
//! The light on the toy is fitted twice: to a matt toy, and to one that reflects the same light by
//! one lobe as well. This adds only two numbers, roughness and strength, so the gain of the fit
//! does not come from more freedom. The reflection of the **ambient light** is as important as that
//! of the lamps: a glossy toy is a little brighter everywhere, and more so at grazing angles. Only
//! a model that includes this estimates the diffuse light correctly and finds the lobe in the
//! residual.
//!
//! A tone curve imitates a broad, weak lobe. So the loss must fall by more than it does for a matt
//! toy with a tone curve.

mod columns;
mod light_depth;
mod look;
mod reflectance;
mod search;
mod solve;

use app_scene::gloss::{Gloss, N_GLOSSES};

pub(crate) use look::{Lights, Look};

/// Share of the loss that a lobe must explain: accepted from the first value on, in full from the
/// second. Measured: matt toys 0 to .02, through a phone's pipeline too; glossy ones .3 and more.
const BELIEVED: [f64; 2] = [0.15, 0.25];
/// The same for lamps' highlights, which alone constrain the roughness: without them their place in
/// another pose would be a guess.
const HIGHLIGHTS_BELIEVED: [f64; 2] = [0.005, 0.015];
/// Minimum number of pixels of an estimate.
const LEAST_SURFELS: usize = 300;
/// Minimum number of clearly different normals: on a few flat faces any brightness is a paint's.
const LEAST_NORMALS: usize = 12;
/// Maximum number of pixels; more do not improve it.
pub(crate) const MOST_SURFELS: usize = 2500;

/// Estimated gloss of a toy; matt if the pixels do not constrain it.
pub(crate) fn gloss(look: &Look) -> Gloss {
    if look.len() < LEAST_SURFELS || look.n_normals() < LEAST_NORMALS {
        return Gloss::NONE;
    }
    let Some(found) = search::found(look, BELIEVED[0]) else {
        return Gloss::NONE;
    };
    let believed = smoothstep(BELIEVED, found.fall) * smoothstep(HIGHLIGHTS_BELIEVED, found.of_highlights);
    if believed == 0.0 {
        return Gloss::NONE;
    }
    let mut strengths = [0.0; N_GLOSSES];
    for (slot, strength) in strengths.iter_mut().zip(&found.strengths) {
        #[allow(clippy::cast_possible_truncation, reason = "a strength, to 7 digits")]
        let strength = (believed * strength) as f32;
        *slot = strength;
    }
    // Slots beyond the toy's materials repeat the last one.
    let last = strengths[found.strengths.len().clamp(1, N_GLOSSES) - 1];
    strengths[found.strengths.len().min(N_GLOSSES)..].fill(last);
    #[allow(clippy::cast_possible_truncation, reason = "a slope, to 7 digits")]
    let roughness = found.roughness as f32;
    Gloss { roughness, strengths }
}

fn smoothstep([low, high]: [f64; 2], x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
