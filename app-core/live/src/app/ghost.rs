//! A toy that a person puts on a table by a tap, a drag and a turn.

use std::f64::consts::TAU;

use glam::{DMat4, DVec2, DVec3};

use app_scene::camera_frame::FoundPlane;
use app_scene::scene::{Camera, Pose};
use app_scene::toy::{Toy, ToyError};

/// Sine of 3 degrees: smallest angle between a line of sight and the table that gives a usable
/// place.
const LEAST_SLOPE: f64 = 0.052;
/// Largest distance of a table, in metres.
const FARTHEST_M: f64 = 10.0;

/// Pose of a toy on a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ghost {
    world_from_plane: DMat4,
    /// Place in the plane, x and z in metres.
    place_m: DVec2,
    /// Angle about the plane's normal, in radians.
    yaw_rad: f64,
    /// Height of the toy's origin above its lowest point, in metres.
    lift_m: f64,
    /// Radius of the surrounding ring for turning, in metres.
    ring_m: f64,
}

/// Radius of the ring relative to the toy's reach.
const RING: f64 = 1.25;
/// Share of the ring's radius within which a finger moves the ghost.
const WITHIN: f64 = 0.8;
/// Number of the ring's corners.
const N_CORNERS: u32 = 64;

impl Ghost {
    /// A toy at the plane's place at `pixel`, with its front, object space's +Z, towards the
    /// camera; `None` if `pixel` does not show the plane.
    ///
    /// # Errors
    ///
    /// Fails if the toy cannot be posed.
    pub(super) fn at(
        toy: &Toy,
        plane: &FoundPlane,
        (camera, pixel): (&Camera, DVec2),
    ) -> Result<Option<Self>, ToyError> {
        let [lift_m, ring_m] = sizes(toy)?;
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
                ring_m,
            }
        }))
    }

    /// A toy on the plane at the place of the given transform, with the same turn; `None` if the
    /// toy cannot be posed.
    pub(super) fn standing(toy: &Toy, plane: &FoundPlane, world_from_object: &DMat4) -> Option<Self> {
        let [lift_m, ring_m] = sizes(toy).ok()?;
        let in_plane = plane.world_from_plane.inverse() * *world_from_object;
        let place = in_plane.w_axis;
        let ghost = Self {
            world_from_plane: plane.world_from_plane,
            place_m: DVec2::new(place.x, place.z),
            yaw_rad: in_plane.z_axis.x.atan2(in_plane.z_axis.z),
            lift_m,
            ring_m,
        };
        in_plane.is_finite().then_some(ghost)
    }

    /// Moves it to the plane's place at `pixel`; it stays if there is none.
    pub(super) fn move_to(&mut self, camera: &Camera, pixel: DVec2) {
        if let Some(place_m) = seen_at(&self.world_from_plane, camera, pixel) {
            self.place_m = place_m;
        }
    }

    /// The same for a place outside the ring and its knob; a place inside changes nothing. Returns
    /// whether it moved.
    pub(super) fn move_beyond_ring(&mut self, camera: &Camera, pixel: DVec2) -> bool {
        const BEYOND: f64 = 1.2;
        let place_m = seen_at(&self.world_from_plane, camera, pixel);
        let is_beyond = |place_m: &DVec2| place_m.distance(self.place_m) > BEYOND * self.ring_m;
        let Some(place_m) = place_m.filter(is_beyond) else {
            return false;
        };
        self.place_m = place_m;
        true
    }

    /// Moves it if a finger drags within the ring, and turns it if one drags around it elsewhere.
    pub(super) fn drag(&mut self, camera: &Camera, [from_px, to_px]: [DVec2; 2]) {
        let places = [from_px, to_px].map(|pixel| seen_at(&self.world_from_plane, camera, pixel));
        let [Some(from_m), Some(to_m)] = places else {
            return;
        };
        let (from, to) = (from_m - self.place_m, to_m - self.place_m);
        if from.length() < WITHIN * self.ring_m {
            self.place_m += to_m - from_m;
        } else if to.length() > 0.0 {
            // From above, the turn from a plane's x to its z is clockwise.
            self.turn(-from.angle_to(to));
        }
    }

    /// The ring's corners and its knob, in front of the toy, in pixels.
    pub(super) fn ring_px(&self, camera: &Camera) -> Option<(Vec<DVec2>, DVec2)> {
        let pixel = |at_m: DVec2| pixel_of(&self.world_from_plane, camera, at_m);
        let corners = circle(self.place_m, self.ring_m, N_CORNERS).filter_map(pixel);
        let front = DVec2::new(self.yaw_rad.sin(), self.yaw_rad.cos());
        Some((corners.collect(), pixel(self.place_m + self.ring_m * front)?))
    }

    /// Turns it counterclockwise from above.
    pub(super) fn turn(&mut self, angle_rad: f64) {
        if angle_rad.is_finite() {
            self.yaw_rad = (self.yaw_rad + angle_rad).rem_euclid(TAU);
        }
    }

    /// Adopts the tracker's corrections of the plane.
    pub(super) fn follow(&mut self, plane: &FoundPlane) {
        self.world_from_plane = plane.world_from_plane;
    }

    /// The toy's transform, from object space to world.
    pub(super) fn world_from_object(&self) -> DMat4 {
        let place = DVec3::new(self.place_m.x, self.lift_m, self.place_m.y);
        self.world_from_plane * DMat4::from_translation(place) * DMat4::from_rotation_y(self.yaw_rad)
    }
}

/// Height of a toy's origin above its lowest point, and the radius of its ring.
fn sizes(toy: &Toy) -> Result<[f64; 2], ToyError> {
    let bounds = toy.bounds_of_pose(&Pose::Authored)?;
    let [x, z] = [(bounds.min.x, bounds.max.x), (bounds.min.z, bounds.max.z)]
        .map(|(least, most)| f64::from(least.abs().max(most.abs())));
    Ok([-f64::from(bounds.min.y), RING * x.hypot(z)])
}

/// The place of a plane at `pixel`, as its x and z; `None` above the horizon, from below, or far
/// away.
pub(super) fn seen_at(world_from_plane: &DMat4, camera: &Camera, pixel: DVec2) -> Option<DVec2> {
    let plane_from_camera = world_from_plane.inverse() * camera.world_from_camera;
    let eye = plane_from_camera.w_axis.truncate();
    let ray = plane_from_camera
        .transform_vector3(camera.intrinsics.ray(pixel))
        .try_normalize()?;
    if eye.y <= 0.0 || ray.y > -LEAST_SLOPE {
        return None;
    }
    let distance_m = eye.y / -ray.y;
    let place = eye + distance_m * ray;
    (distance_m <= FARTHEST_M).then_some(DVec2::new(place.x, place.z))
}

/// The world's point at `pixel`: of the plane, or as far away as the plane's origin if the pixel
/// does not show the plane, as at the head of a toy.
pub(super) fn point_at(world_from_plane: &DMat4, camera: &Camera, pixel: DVec2) -> Option<DVec3> {
    if let Some(place_m) = seen_at(world_from_plane, camera, pixel) {
        return Some(world_from_plane.transform_point3(DVec3::new(place_m.x, 0.0, place_m.y)));
    }
    let eye = camera.world_from_camera.w_axis.truncate();
    let ray = camera
        .world_from_camera
        .transform_vector3(camera.intrinsics.ray(pixel))
        .try_normalize()?;
    let distance_m = eye.distance(world_from_plane.w_axis.truncate());
    Some(eye + distance_m * ray)
}

/// The image of a place of a plane, given as its x and z, in pixels; `None` behind the camera.
pub(super) fn pixel_of(world_from_plane: &DMat4, camera: &Camera, place_m: DVec2) -> Option<DVec2> {
    let at = world_from_plane.transform_point3(DVec3::new(place_m.x, 0.0, place_m.y));
    camera.pixel_of(at)
}

/// Corners of a circle, starting on the first axis.
pub(super) fn circle(middle: DVec2, radius: f64, n: u32) -> impl Iterator<Item = DVec2> {
    let step_rad = TAU / f64::from(n);
    (0..n).map(move |corner| middle + radius * DVec2::from_angle(step_rad * f64::from(corner)))
}
