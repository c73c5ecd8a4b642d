//! A toy put on a table by hand: by a tap, a drag and a turn.

use std::f64::consts::TAU;

use glam::{DMat4, DVec2, DVec3};

use app_scene::camera_frame::FoundPlane;
use app_scene::scene::{Camera, Pose};
use app_scene::toy::{Toy, ToyError};

/// A line of sight that meets the table at less than this to its surface tells no place on it: sine of 3 degrees.
const LEAST_SLOPE: f64 = 0.052;
/// A table is not looked for farther away, in metres.
const FARTHEST_M: f64 = 10.0;

/// Where a toy stands on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ghost {
    world_from_plane: DMat4,
    /// In the plane, x and z, in metres.
    place_m: DVec2,
    /// About the plane's normal, in radians.
    yaw_rad: f64,
    /// From the lowest point of the toy to its origin, in metres.
    lift_m: f64,
}

impl Ghost {
    /// A toy that stands where a camera sees the plane at `pixel`, its front, which is object space's +Z, towards the camera; none
    /// where that is no place on the plane.
    ///
    /// # Errors
    /// When the toy cannot be posed.
    pub(super) fn at(
        toy: &Toy,
        plane: &FoundPlane,
        (camera, pixel): (&Camera, DVec2),
    ) -> Result<Option<Self>, ToyError> {
        let lift_m = -f64::from(toy.bounds_of_pose(&Pose::Authored)?.min.y);
        let eye_in_plane = plane
            .world_from_plane
            .inverse()
            .transform_point3(camera.world_from_camera.w_axis.truncate());
        Ok(seen_at(&plane.world_from_plane, camera, pixel).map(|place_m| {
            let to_camera = DVec2::new(eye_in_plane.x, eye_in_plane.z) - place_m;
            Self {
                world_from_plane: plane.world_from_plane,
                place_m,
                yaw_rad: to_camera.x.atan2(to_camera.y),
                lift_m,
            }
        }))
    }

    /// Puts it where a camera sees the plane at `pixel`; where that is no place on the plane it stays.
    pub(super) fn move_to(&mut self, camera: &Camera, pixel: DVec2) {
        if let Some(place_m) = seen_at(&self.world_from_plane, camera, pixel) {
            self.place_m = place_m;
        }
    }

    /// Moves it as a finger goes over the plane.
    pub(super) fn drag(&mut self, camera: &Camera, [from_px, to_px]: [DVec2; 2]) {
        let places = [from_px, to_px].map(|pixel| seen_at(&self.world_from_plane, camera, pixel));
        if let [Some(from_m), Some(to_m)] = places {
            self.place_m += to_m - from_m;
        }
    }

    /// Turns it, counterclockwise from above.
    pub(super) fn turn(&mut self, angle_rad: f64) {
        if angle_rad.is_finite() {
            self.yaw_rad = (self.yaw_rad + angle_rad).rem_euclid(TAU);
        }
    }

    /// Follows the plane, as the tracker corrects it.
    pub(super) fn follow(&mut self, plane: &FoundPlane) {
        self.world_from_plane = plane.world_from_plane;
    }

    /// The toy's transform, from object space to world.
    pub(super) fn world_from_object(&self) -> DMat4 {
        let place = DVec3::new(self.place_m.x, self.lift_m, self.place_m.y);
        self.world_from_plane * DMat4::from_translation(place) * DMat4::from_rotation_y(self.yaw_rad)
    }
}

/// The place of a plane that a camera sees at `pixel`, as its x and z; none above the horizon, from below, or far away.
pub(super) fn seen_at(world_from_plane: &DMat4, camera: &Camera, pixel: DVec2) -> Option<DVec2> {
    let k = &camera.intrinsics;
    let direction = DVec3::new(
        (pixel.x - k.cx_px) / k.fx_px,
        -(pixel.y - k.cy_px) / k.fy_px,
        -1.0,
    );
    let plane_from_camera = world_from_plane.inverse() * camera.world_from_camera;
    let eye = plane_from_camera.w_axis.truncate();
    let ray = plane_from_camera.transform_vector3(direction).try_normalize()?;
    if eye.y <= 0.0 || ray.y > -LEAST_SLOPE {
        return None;
    }
    let distance_m = eye.y / -ray.y;
    let place = eye + distance_m * ray;
    (distance_m <= FARTHEST_M).then_some(DVec2::new(place.x, place.z))
}
