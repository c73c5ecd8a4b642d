//! CPU reference of `search.wgsl`: the concentric ring search.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, IVec2, UVec2};

use super::raster::Raster;
use super::sets::LightSet;

/// The search's parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rings {
    /// Distance between rings.
    pub step_px: f64,
    /// Number of candidates of a ring, evenly spaced; odd rings are turned by half of the spacing.
    pub n_directions: u32,
    /// Number of rings until the search gives up, if it has not left the region before.
    pub n_rings: u32,
}

impl Rings {
    /// The last ring around `at_px` that touches a region of that size.
    fn within(&self, size: UVec2, at_px: DVec2) -> u32 {
        let corners = [UVec2::ZERO, UVec2::X, UVec2::Y, UVec2::ONE].map(|corner| (corner * size).as_dvec2());
        let farthest_px = corners
            .map(|corner| corner.distance(at_px))
            .into_iter()
            .fold(0.0, f64::max);
        let touches = |ring: &u32| f64::from(*ring) * self.step_px <= farthest_px;
        (1..=self.n_rings).take_while(touches).last().unwrap_or_default()
    }
}

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Found {
    /// The texel to sample; `None` without one in range.
    pub texel: Option<IVec2>,
    /// Number of candidates after the first.
    pub n_taps: u32,
}

/// The sources of a texel's shadows, one for each light of its set.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Lights whose new shadows cover the texel; not empty.
    pub set: LightSet,
    /// One point of the region for each of these lights, in their order.
    pub sources_px: Vec<DVec2>,
}

/// The texel to sample: a source's own, or the closest candidate of the first ring with one that
/// has exactly the set's shadows; if there is none, the same for less and less similar sets, of
/// which `seen` has the existing ones. The first of equally close candidates wins.
#[must_use]
pub fn search(eligible: &Raster<LightSet>, seen: &[LightSet], start: &Start, rings: &Rings) -> Found {
    let mut n_taps = 0;
    for accepted in start.set.closest_first(seen) {
        let found = search_sets(eligible, &accepted, start, rings);
        n_taps += found.n_taps;
        if found.texel.is_some() {
            return Found { n_taps, ..found };
        }
    }
    Found { texel: None, n_taps }
}

fn search_sets(eligible: &Raster<LightSet>, accepted: &[LightSet], start: &Start, rings: &Rings) -> Found {
    let is_eligible = |texel: &IVec2| {
        let is_inside = texel.cmpge(IVec2::ZERO).all() && texel.cmplt(eligible.size().as_ivec2()).all();
        is_inside && accepted.contains(&eligible.at(texel.as_uvec2()))
    };
    let own = start.sources_px.iter().map(|source| source.floor().as_ivec2());
    if let Some(texel) = own.into_iter().find(is_eligible) {
        return Found {
            texel: Some(texel),
            n_taps: 0,
        };
    }
    let n_of_ring = rings.n_directions * start.set.0.count_ones();
    let around = start
        .sources_px
        .iter()
        .map(|source| rings.within(eligible.size(), *source));
    let n_rings = around.max().unwrap_or_default();
    for ring in 1..=n_rings {
        let of_source = |source: &DVec2| {
            let source = *source;
            candidates(source, ring, rings).map(move |texel| (texel, away_px(texel, source)))
        };
        let closest = (start.sources_px.iter().flat_map(of_source))
            .filter(|(texel, _)| is_eligible(texel))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((texel, _)) = closest {
            return Found {
                texel: Some(texel),
                n_taps: ring * n_of_ring,
            };
        }
    }
    Found {
        texel: None,
        n_taps: n_rings * n_of_ring,
    }
}

/// The candidates of a ring.
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

/// A sample of the shadow: its colour on a uniform receiver, its ratio to the plate on a textured
/// one.
///
/// For a black plate, the ratio is undefined and set to 1; a shadow never adds light.
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
