//! Receivers of unknown place, fitted under a toy that stands.
//!
//! A photograph without a tracker constrains the toy's place relative to the camera to a tenth of a
//! millimetre, and the table hardly at all. But the toy stands on it: the plane of the toy's feet
//! is the table's.

use glam::{DMat4, DQuat, DVec3};

use crate::pose::{Plane, feet};
use crate::shape::Shape;
use app_scene::geometry::nearest_receivers::nearest_to_toy;
use app_scene::scene::{Receiver, Scene};
use app_scene::toy::ToyError;

/// All receivers of a scene, moved as one so that the toy stands on the nearest of the most level; `None`
/// if the toy has no three feet that support it.
pub(super) fn placed_receivers(
    scene: &Scene,
    world_from_object: &DMat4,
) -> Result<Option<Vec<Receiver>>, ToyError> {
    let shape = Shape::new(scene, world_from_object)?;
    let nearest = nearest_to_toy(scene, world_from_object);
    let planes = nearest.into_iter().map(|index| plane_of(&scene.receivers[index]));
    let Some(plane) = Plane::most_level(planes, DVec3::Y) else {
        return Ok(None);
    };
    Ok(feet(&shape, &plane).map(|[a, b, c]| {
        let across = (b - a).cross(c - a);
        let up = across.normalize_or(plane.normal);
        let up = if up.dot(plane.normal) < 0.0 { -up } else { up };
        let middle = (a + b + c) / 3.0;
        // Rotated about the point below the centre of the feet, then lifted to it.
        let below = middle - plane.height_m(middle) * plane.normal;
        let turn = DQuat::from_rotation_arc(plane.normal, up);
        let motion =
            DMat4::from_translation(middle) * DMat4::from_quat(turn) * DMat4::from_translation(-below);
        let receivers = scene.receivers.iter().cloned();
        let moved = receivers.map(|receiver| Receiver {
            world_from_plane: motion * receiver.world_from_plane,
            ..receiver
        });
        moved.collect()
    }))
}

/// Smaller inclinations of the feet's plane, in radians, are errors of the model: the toy stands
/// upright.
const LEAST_LEAN_RAD: f64 = 0.012;

/// Possible ground planes of an upright toy; +Y is the normal. The first is level, below its lowest
/// point; the second is the plane of its feet, if that is clearly inclined.
pub(super) fn planes_under(
    scene: &Scene,
    world_from_object: &DMat4,
    up: DVec3,
) -> Result<Vec<DMat4>, ToyError> {
    let shape = Shape::new(scene, world_from_object)?;
    let lowest = shape.points.iter().min_by(|a, b| a.dot(up).total_cmp(&b.dot(up)));
    let level = Plane {
        normal: up,
        point: lowest.copied().unwrap_or(shape.centre),
    };
    let of_feet = feet(&shape, &level).map(|[a, b, c]| {
        let across = (b - a).cross(c - a).normalize_or(up);
        Plane {
            normal: across * across.dot(up).signum(),
            point: (a + b + c) / 3.0,
        }
    });
    let leans = |plane: &Plane| plane.normal.dot(up) < LEAST_LEAN_RAD.cos();
    let planes = std::iter::once(level).chain(of_feet.filter(leans));
    Ok(planes
        .map(|plane| {
            let turn = DQuat::from_rotation_arc(DVec3::Y, plane.normal);
            DMat4::from_rotation_translation(turn, plane.point)
        })
        .collect())
}

fn plane_of(receiver: &Receiver) -> Plane {
    let [normal, point] = [receiver.world_from_plane.y_axis, receiver.world_from_plane.w_axis];
    Plane {
        normal: normal.truncate().normalize_or(DVec3::Y),
        point: point.truncate(),
    }
}
