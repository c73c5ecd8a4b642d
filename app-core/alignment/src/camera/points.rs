//! Points of the receivers whose brightness is known from a plate.

use glam::{DMat4, DVec3, IVec2};

use super::brightness::Plane;
use crate::picture::places;
use crate::receivers::{SeenReceiver, receiver_at};
use app_scene::scene::{Camera, Receiver};

/// Smallest change of brightness between pixels that is not noise.
const LEAST_GRADIENT: f64 = 0.01;

/// A point that a plate shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// Position in the given space of the estimated camera.
    pub(super) in_camera: DVec3,
    /// Square root of luminance.
    pub(super) brightness: f64,
}

/// Points of one level of a plate at changes of brightness, evenly thinned out to `most`.
pub(super) fn points_of(
    (camera, picture): (&Camera, &Plane),
    receivers: &[Receiver],
    camera_from_world: &DMat4,
    most: usize,
) -> Vec<Point> {
    let plate_camera_from_world = camera.world_from_camera.inverse();
    let seen: Vec<SeenReceiver> = receivers
        .iter()
        .map(|receiver| SeenReceiver::new(receiver, &plate_camera_from_world))
        .collect();
    // Rounded to 32 bits, which are mostly the same for any origin of the world.
    let camera_from_plate = (*camera_from_world * camera.world_from_camera)
        .as_mat4()
        .as_dmat4();
    let intrinsics = picture.intrinsics(&camera.intrinsics);
    let is_textured = |at: IVec2| {
        picture
            .gradient(at)
            .is_some_and(|change| change.length() > LEAST_GRADIENT)
    };
    let points: Vec<Point> = places(picture.size_px)
        .filter(|at| is_textured(*at))
        .filter_map(|at| {
            let (_, in_plate) = receiver_at(&seen, &intrinsics, at)?;
            Some(Point {
                in_camera: camera_from_plate.transform_point3(in_plate),
                brightness: f64::from(picture.get(at)?),
            })
        })
        .collect();
    let stride = points.len().div_ceil(most).max(1);
    points.into_iter().step_by(stride).collect()
}
