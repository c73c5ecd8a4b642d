//! CPU reference of `appearance.wgsl`: the toy's own colours, extended a little beyond its outline.

use glam::{DVec3, DVec4, IVec2, UVec2};

use super::raster::Raster;

/// Search range of a pixel of one surface, in pixels along each side.
pub const REACH_PX: i32 = 3;
/// Difference of reversed depth, as a fraction of the larger, beyond which two pixels show two surfaces.
const DEPTH_STEP: f64 = 0.005;

/// A pixel of the physical toy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToyPixel {
    /// Linear colour of the camera's frame.
    pub color: DVec3,
    /// Each light's cosine times its visibility.
    pub received: DVec4,
    /// Base colour of the model, and the fraction of its hemisphere above the horizon.
    pub base: DVec4,
}

/// The data of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Its colours.
    pub pixel: ToyPixel,
    /// Reversed depth of the toy; 0 beside it.
    pub depth: f64,
    /// Whether it shows one surface of the toy and nothing else.
    pub is_one_surface: bool,
}

/// The result for `texel`: its own values if it shows one surface, else those of the nearest pixel
/// that does, the first row by row among equally near ones, with those of its own depth before
/// others; its own for a part too thin to have such a pixel; `None` beside the toy.
#[must_use]
pub fn clean(seen: &Raster<Seen>, texel: UVec2) -> Option<ToyPixel> {
    let here = seen.at(texel);
    if here.is_one_surface {
        return Some(here.pixel);
    }
    let last = seen.size().as_ivec2() - 1;
    let reach = -REACH_PX..=REACH_PX;
    let offsets = reach
        .clone()
        .flat_map(|y| reach.clone().map(move |x| IVec2::new(x, y)));
    // Beyond the border the last pixel is repeated.
    let near = offsets.map(|offset| {
        let other = seen.at((texel.as_ivec2() + offset).clamp(IVec2::ZERO, last).as_uvec2());
        (offset.length_squared(), other)
    });
    let evident = near.filter(|(_, other)| other.is_one_surface);
    let is_other_surface = |other: &Seen| {
        let larger = here.depth.max(other.depth);
        here.depth > 0.0 && (here.depth - other.depth).abs() > DEPTH_STEP * larger
    };
    let nearest =
        evident.min_by_key(|(distance_squared, other)| (is_other_surface(other), *distance_squared));
    match nearest {
        Some((_, nearest)) => Some(nearest.pixel),
        None => (here.depth > 0.0).then_some(here.pixel),
    }
}
