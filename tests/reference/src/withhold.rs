//! CPU reference of `withhold.wgsl`: evidence without the real shadow.

use glam::DVec4;

use super::model::{Pictures, Region, Solution, centre_px, coarse_at};
use super::raster::Raster;

/// Remaining light, in plates, below which a pixel is in the real shadow.
const LIT: f64 = 0.95;

/// The marks of `validity`, without receiver pixels in shadow: alpha is 0 there, and a half beside
/// the toy.
#[must_use]
pub fn withhold(
    region: &Region,
    pictures: &Pictures,
    solution: &Solution,
    validity: &Raster<DVec4>,
) -> Raster<DVec4> {
    Raster::from_fn(region.size_px, |texel| {
        let (marks, at) = (validity.at(texel), centre_px(texel));
        let in_shadow = region.receiver_point(at).is_some_and(|point| {
            let ambient = coarse_at(&pictures.ambient, region, at);
            let left = solution.receiver_model(region, point, ambient, pictures.visibility.at(texel));
            marks.x > 0.0 && left.min_element() < LIT
        });
        if in_shadow {
            DVec4::W * 0.5 * (1.0 - marks.z)
        } else {
            marks
        }
    })
}
