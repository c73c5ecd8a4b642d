//! CPU reference of `appearance.wgsl`: the toy's own colours, carried a little past its outline.

use glam::{DVec3, IVec2, UVec2};

use super::raster::Raster;
use super::{ConstantError, shader_constant};

/// What the shader fixes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AppearanceConstants {
    /// Farthest that a pixel of one surface is looked for, along each side.
    pub reach_px: i32,
    /// Weight of a colour at another depth.
    pub other_surface: f64,
    /// Relative step of depth that makes an edge between two surfaces.
    pub depth_step: f64,
}

impl AppearanceConstants {
    /// Reads them from the shader.
    ///
    /// # Errors
    /// When it has no such constant.
    pub fn from_shader() -> Result<Self, ConstantError> {
        Ok(Self {
            reach_px: shader_constant("appearance", "REACH_PX")?,
            other_surface: shader_constant("appearance", "OTHER_SURFACE")?,
            depth_step: shader_constant("appearance", "DEPTH_STEP")?,
        })
    }
}

/// A pixel of the physical toy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToyPixel {
    /// Linear colour of the camera's frame.
    pub color: DVec3,
    /// Radiance over base colour that the fit gives to it.
    pub lit: DVec3,
    /// Base colour of the model.
    pub base: DVec3,
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
pub fn clean(seen: &Raster<Seen>, constants: &AppearanceConstants, texel: UVec2) -> Option<ToyPixel> {
    let here = seen.at(texel);
    if here.is_one_surface {
        return Some(here.pixel);
    }
    let last = seen.size().as_ivec2() - 1;
    let reach = -constants.reach_px..=constants.reach_px;
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
        let is_own = here.depth == 0.0 || (here.depth - other.depth).abs() <= constants.depth_step * larger;
        let preference = if is_own { 1.0 } else { constants.other_surface };
        let weight = preference / f64::from(offset.length_squared().max(1)).powi(2);
        sum.color += weight * other.pixel.color;
        sum.lit += weight * other.pixel.lit;
        sum.base += weight * other.pixel.base;
        total += weight;
    }
    if total > 0.0 {
        return Some(ToyPixel {
            color: sum.color / total,
            lit: sum.lit / total,
            base: sum.base / total,
        });
    }
    (here.depth > 0.0).then_some(here.pixel)
}
