//! A light's parameters for optimisation.

use glam::{DMat4, DQuat, DVec2, DVec3, DVec4};

use app_scene::geometry::disc::vogel_disc;
use app_scene::scene::Light;

/// Number of a lamp's parameters: two angles, its inverse distance, and its spread.
pub(super) const N_PARTS: usize = 4;
/// Index of the inverse distance among them.
pub(super) const INVERSE_DISTANCE: usize = 2;
/// Index of the spread.
pub(super) const SPREAD: usize = 3;

/// A light seen from the toy, in camera space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp {
    /// Unit vector from the toy.
    pub(super) direction: DVec3,
    /// Inverse distance in 1/m; 0 for a light at infinity.
    pub(super) inverse_distance: f64,
    /// Tangent of the angular radius.
    pub(super) spread: f64,
}

impl Lamp {
    /// `None` for a light around the centre of the toy.
    pub(super) fn new(light: &Light, camera_from_world: &DMat4, toy: DVec3) -> Option<Self> {
        let in_camera = light.moved(camera_from_world);
        Some(Self {
            direction: in_camera.vector_from(toy).try_normalize()?,
            inverse_distance: in_camera.distance_m_from(toy).map_or(0.0, f64::recip),
            spread: in_camera.slope_from(toy)?,
        })
    }

    /// The light in the world.
    pub(super) fn light(&self, world_from_camera: &DMat4, toy: DVec3) -> Light {
        let angular_radius_rad = self.spread.atan();
        if self.is_far() {
            let direction = world_from_camera.transform_vector3(self.direction).normalize();
            Light::directional(direction, angular_radius_rad)
        } else {
            let distance_m = self.inverse_distance.recip();
            let position = world_from_camera.transform_point3(toy + distance_m * self.direction);
            Light::sphere(position, angular_radius_rad.sin() * distance_m)
        }
    }

    /// Whether it is at infinity.
    pub(super) fn is_far(&self) -> bool {
        self.inverse_distance <= 0.0
    }

    /// Turned by two angles in radians about axes across its direction, with the third number added
    /// to its inverse distance, and the fourth to its spread.
    pub(super) fn moved(&self, step: &[f64; N_PARTS]) -> Self {
        let (across, along) = self.direction.any_orthonormal_pair();
        let turn = DQuat::from_scaled_axis(step[0] * across + step[1] * along);
        Self {
            direction: (turn * self.direction).normalize(),
            inverse_distance: (self.inverse_distance + step[INVERSE_DISTANCE]).max(0.0),
            spread: (self.spread + step[SPREAD]).max(0.0),
        }
    }

    /// Points over its disc in a space, homogeneous.
    pub(super) fn points(&self, space_from_camera: &DMat4, toy: DVec3, disc: &[DVec2]) -> Vec<DVec4> {
        let (across, along) = self.direction.any_orthonormal_pair();
        let point = |at: &DVec2| {
            let to = self.direction + self.spread * (at.x * across + at.y * along);
            if self.is_far() {
                space_from_camera.transform_vector3(to).extend(0.0)
            } else {
                let place = toy + to / self.inverse_distance;
                space_from_camera.transform_point3(place).extend(1.0)
            }
        };
        disc.iter().map(point).collect()
    }

    /// Its centre in a space, homogeneous.
    pub(super) fn middle(&self, space_from_camera: &DMat4, toy: DVec3) -> DVec4 {
        self.points(space_from_camera, toy, &[DVec2::ZERO])[0]
    }
}

/// At least three points over the unit disc, of equal areas, with the disc's own mean and variance,
/// from which a spiral of few points deviates slightly.
pub(super) fn disc(n_points: usize) -> Vec<DVec2> {
    let mut points: Vec<DVec2> = vogel_disc(n_points).collect();
    let mean_of = |values: &mut dyn Iterator<Item = DVec2>| {
        let n = n_points as f64;
        values.sum::<DVec2>() / n
    };
    let mean = mean_of(&mut points.iter().copied());
    let variance = mean_of(&mut points.iter().map(|point| (*point - mean) * (*point - mean)));
    // A disc's variance along each axis is 1/4.
    let scale = 0.5 / DVec2::new(variance.x.sqrt(), variance.y.sqrt());
    for point in &mut points {
        *point = (*point - mean) * scale;
    }
    points
}
