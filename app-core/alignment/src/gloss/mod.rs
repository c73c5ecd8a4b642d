//! How glossy the toy is, by what its surface shows beside diffuse reflection.
//!
//! The light on the toy is fitted twice: to a matt toy, and to one that reflects the same light by one lobe as well. Two numbers are new
//! then, roughness and strength, so what the fit gains by them is not what more freedom gains. The reflection of the **ambient light** is
//! as important as that of the lamps: a glossy toy is a little brighter all over, the more the lower it is looked at, and only a model that
//! knows that has its diffuse light right and sees the lobe in what is left.
//!
//! A tone curve imitates a broad, weak lobe. So the loss must fall by more than it does for a matt toy whose photograph went through one.

mod light_depth;
mod look;
mod reflectance;
mod search;
mod solve;

use app_scene::gloss::{Gloss, N_GLOSSES};

pub(crate) use look::{Lights, Look};
use solve::Material;

/// Part of the loss that goes where a lobe is first believed, and from which on it is in full. Measured: matt toys 0 to .02, through a phone's
/// pipeline too; glossy ones .3 and more.
const BELIEVED: [f64; 2] = [0.15, 0.25];
/// And by lamps' highlights, without which nothing tells the roughness: where these would be in another pose is a guess then.
const HIGHLIGHTS_BELIEVED: [f64; 2] = [0.005, 0.015];
/// Fewer pixels tell nothing.
const LEAST_SURFELS: usize = 300;
/// More add nothing.
pub(crate) const MOST_SURFELS: usize = 2500;

/// How glossy a toy is; none of it where nothing tells.
pub(crate) fn gloss(look: &Look) -> Gloss {
    if look.len() < LEAST_SURFELS {
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
    // Materials that the toy does not have are as the last.
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

/// Index of the strength that a material has.
fn slot_of(material: usize) -> Material {
    material.min(N_GLOSSES - 1)
}
