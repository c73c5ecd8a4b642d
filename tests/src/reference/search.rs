//! Twin of `search.wgsl`: the concentric ring search.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, IVec2};

use super::raster::Raster;

/// The open constants of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rings {
    /// Distance between rings.
    pub step_px: f64,
    /// Candidates of a ring, even around it; those of odd rings are turned by half of their distance.
    pub n_directions: u32,
    /// Rings until the search gives up.
    pub n_rings: u32,
}

/// What a search came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// The texel to sample; none within reach where there is none.
    pub texel: Option<IVec2>,
    /// Candidates that were looked at after the first.
    pub n_taps: u32,
}

/// The eligible texel to sample for a point of the region: its own, or the closest candidate of the first ring that
/// has one. Of candidates as close as each other the first wins.
#[must_use]
pub fn search(eligible: &Raster<bool>, at_px: DVec2, rings: &Rings) -> Found {
    let is_eligible = |texel: &IVec2| {
        let is_inside = texel.cmpge(IVec2::ZERO).all() && texel.cmplt(eligible.size().as_ivec2()).all();
        is_inside && eligible.at(texel.as_uvec2())
    };
    let own = at_px.floor().as_ivec2();
    if is_eligible(&own) {
        return Found {
            texel: Some(own),
            n_taps: 0,
        };
    }
    for ring in 1..=rings.n_rings {
        let closest = candidates(at_px, ring, rings)
            .filter(is_eligible)
            .min_by(|a, b| away_px(*a, at_px).total_cmp(&away_px(*b, at_px)));
        if closest.is_some() {
            return Found {
                texel: closest,
                n_taps: ring * rings.n_directions,
            };
        }
    }
    Found {
        texel: None,
        n_taps: rings.n_rings * rings.n_directions,
    }
}

/// The texels that a ring looks at.
fn candidates(at_px: DVec2, ring: u32, rings: &Rings) -> impl Iterator<Item = IVec2> {
    let radius_px = f64::from(ring) * rings.step_px;
    let offset = if ring % 2 == 1 { 0.5 } else { 0.0 };
    let step_rad = TAU / f64::from(rings.n_directions);
    (0..rings.n_directions).map(move |k| {
        let toward = DVec2::from_angle((f64::from(k) + offset) * step_rad);
        (at_px + radius_px * toward).floor().as_ivec2()
    })
}

/// From the centre of a texel to a point.
fn away_px(texel: IVec2, at_px: DVec2) -> f64 {
    (texel.as_dvec2() + 0.5).distance(at_px)
}

/// What a sample tells of the shadow: its colour on a uniform receiver, its ratio to the plate on a textured one.
///
/// Where the plate is black, a ratio tells nothing and is 1; a shadow never adds light.
#[must_use]
pub fn term(frame: DVec3, plate: DVec3, is_textured: bool) -> DVec3 {
    if is_textured {
        DVec3::select(
            plate.cmpgt(DVec3::ZERO),
            (frame / plate).min(DVec3::ONE),
            DVec3::ONE,
        )
    } else {
        frame
    }
}
