//! CPU reference of `self_shadow.wgsl` and `common/self_shadow.wgsl`: what a point of the toy receives of each light, by rays
//! rather than depth maps.

use glam::{DVec3, DVec4};

use super::model::Region;
use super::occlusion::Occluder;
use super::real::{Real, Vector};

/// By how much a ray starts above its surface, in metres: rounding, and nothing that can be seen.
const LIFT_M: f64 = 1e-6;

/// Cosine to each light times the share of its points in sight.
#[must_use]
pub fn received<R: Real>(
    region: &Region,
    occluder: &Occluder<R>,
    light_points: &[Vec<DVec4>],
    in_plane: DVec3,
    normal: DVec3,
) -> DVec4 {
    let (at, normal) = (Vector::from(in_plane), Vector::from(normal));
    let from = at + normal * R::from_f64(LIFT_M);
    let mut received = DVec4::ZERO;
    for (i, (light, points)) in region.lights.iter().zip(light_points).enumerate() {
        let to_light = Vector::from(light.truncate()) - at * R::from_f64(light.w);
        let cosine = normal.dot(to_light.normalize()).max(R::ZERO);
        let in_sight = points
            .iter()
            .filter(|point| !occluder.stands_between(from.into(), **point));
        let visibility = R::from_f64(in_sight.count() as f64) / R::from_f64(points.len() as f64);
        received[i] = (cosine * visibility).to_f64();
    }
    received
}
