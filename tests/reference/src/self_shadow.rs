//! CPU reference of `self_shadow.wgsl` and `common/self_shadow.wgsl`: irradiance of a point of the
//! toy from each light, by rays rather than depth maps.

use glam::{DVec3, DVec4};

use super::model::Region;
use super::occlusion::Occluder;

/// Offset of a ray's start from its surface, in metres: above rounding, below visibility.
const LIFT_M: f64 = 1e-6;

/// Cosine to each light times the visible share of its points.
#[must_use]
pub fn received(
    region: &Region,
    occluder: &Occluder,
    light_points: &[Vec<DVec4>],
    in_plane: DVec3,
    normal: DVec3,
) -> DVec4 {
    let from = in_plane + normal * LIFT_M;
    let mut received = DVec4::ZERO;
    for (i, (light, points)) in region.lights.iter().zip(light_points).enumerate() {
        let to_light = light.truncate() - in_plane * light.w;
        let cosine = normal.dot(to_light.normalize()).max(0.0);
        let in_sight = points
            .iter()
            .filter(|point| !occluder.stands_between(from, **point));
        let visibility = (in_sight.count() as f64) / (points.len() as f64);
        received[i] = cosine * visibility;
    }
    received
}
