//! CPU reference of `appearance.wgsl`: the toy's own colours, carried a little past its outline.

use glam::{DVec3, DVec4, IVec2, UVec2};

use super::raster::Raster;

/// Farthest that a pixel of one surface is looked for, in pixels along each side.
pub const REACH_PX: i32 = 3;
/// Weight of a colour at another depth, against one at its own: next to nothing, but it will do where there is no other.
pub const OTHER_SURFACE: f64 = 1e-4;
/// Difference of reversed depth, as a fraction of the larger, beyond which two pixels show two surfaces.
const DEPTH_STEP: f64 = 0.005;

/// A pixel of the physical toy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToyPixel {
    /// Linear colour of the camera's frame.
    pub color: DVec3,
    /// Each light's cosine times its visibility.
    pub received: DVec4,
    /// Base colour of the model, and the part of what it sees that lies above the horizon.
    pub base: DVec4,
}

/// What is known of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// What it shows and is.
    pub pixel: ToyPixel,
    /// Reversed depth of the toy; 0 where it is not.
    pub depth: f64,
    /// Whether it shows one surface of the toy and nothing else.
    pub is_one_surface: bool,
}

/// What is found for `texel`: its own where it shows one surface, else the mean of those near that do, by the inverse
/// fourth power of their distance, preferring those at its own depth; of a part too thin to have one its own; none
/// beside the toy.
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
    let (mut sum, mut total) = (ToyPixel::default(), 0.0);
    for offset in offsets {
        // Beyond the border the last pixel stands for those that are not there.
        let other = seen.at((texel.as_ivec2() + offset).clamp(IVec2::ZERO, last).as_uvec2());
        if !other.is_one_surface {
            continue;
        }
        let larger = here.depth.max(other.depth);
        let is_own = here.depth == 0.0 || (here.depth - other.depth).abs() <= DEPTH_STEP * larger;
        let preference = if is_own { 1.0 } else { OTHER_SURFACE };
        let weight = preference / f64::from(offset.length_squared().max(1)).powi(2);
        sum.color += weight * other.pixel.color;
        sum.received += weight * other.pixel.received;
        sum.base += weight * other.pixel.base;
        total += weight;
    }
    if total > 0.0 {
        return Some(ToyPixel {
            color: sum.color / total,
            received: sum.received / total,
            base: sum.base / total,
        });
    }
    (here.depth > 0.0).then_some(here.pixel)
}
