//! Points over a light, and directions over the hemisphere, from which the mesh is flattened onto the receiver.

use glam::{DMat4, DVec2, DVec3, DVec4, Vec4};

use crate::scene::Light;

/// A light in a receiver's plane space, homogeneous: (position, 1) or (unit direction to the light, 0).
#[must_use]
pub fn light_in_plane(light: &Light, plane_from_world: &DMat4) -> DVec4 {
    match *light {
        Light::Sphere {
            position_in_world, ..
        } => plane_from_world.transform_point3(position_in_world).extend(1.0),
        Light::Directional {
            direction_to_light_in_world,
            ..
        } => plane_from_world
            .transform_vector3(direction_to_light_in_world)
            .extend(0.0),
    }
}

/// `n_points` points over the light's disc as seen from the toy at `target_in_plane`, each representing an equal
/// area.
///
/// The disc of a sphere faces the toy, through the sphere's centre; seen from the toy it is the sphere's outline, and nearly so
/// from anywhere near it.
/// Source: Vogel 1979 (sunflower spiral).
#[must_use]
pub fn light_points(
    light: &Light,
    plane_from_world: &DMat4,
    target_in_plane: DVec3,
    n_points: usize,
) -> Vec<Vec4> {
    let disc = Disc::of(light, plane_from_world, target_in_plane);
    vogel_disc(n_points).map(|at| disc.point(at).as_vec4()).collect()
}

/// The corners of the square around the light's disc, homogeneous as [`light_points`], row by row.
pub fn light_corners(light: &Light, plane_from_world: &DMat4, target_in_plane: DVec3) -> [DVec4; 4] {
    let disc = Disc::of(light, plane_from_world, target_in_plane);
    [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(x, y)| disc.point(DVec2::new(x, y)))
}

/// A light's disc, facing the toy.
struct Disc {
    centre: DVec4,
    across: DVec3,
    along: DVec3,
}

impl Disc {
    fn of(light: &Light, plane_from_world: &DMat4, target_in_plane: DVec3) -> Self {
        let centre = light_in_plane(light, plane_from_world);
        let (axis, radius) = match *light {
            Light::Sphere { radius_m, .. } => {
                let to_centre = centre.truncate() - target_in_plane;
                (to_centre, outline_radius_m(radius_m, to_centre.length()))
            }
            Light::Directional {
                angular_radius_rad, ..
            } => (centre.truncate(), angular_radius_rad.tan()),
        };
        // A light inside the toy has no side that faces it; any disc will do.
        let (across, along) = axis.try_normalize().unwrap_or(DVec3::Y).any_orthonormal_pair();
        Self {
            centre,
            across: radius * across,
            along: radius * along,
        }
    }

    /// `at` is on the unit disc.
    fn point(&self, at: DVec2) -> DVec4 {
        let moved = self.centre.truncate() + at.x * self.across + at.y * self.along;
        let point = if self.centre.w == 0.0 {
            moved.normalize()
        } else {
            moved
        };
        point.extend(self.centre.w)
    }
}

/// Radius of a sphere's outline, seen from `distance_m`, on the plane through its centre across the line of sight: rays touch the
/// sphere before they meet the plane. From within there is no outline, and any disc will do.
pub fn outline_radius_m(radius_m: f64, distance_m: f64) -> f64 {
    let tangent_m = (distance_m * distance_m - radius_m * radius_m).sqrt();
    if tangent_m > 0.0 {
        radius_m * distance_m / tangent_m
    } else {
        radius_m
    }
}

/// `n_directions` directions over the hemisphere, cosine-weighted: each represents an equal fraction of ambient
/// light.
///
/// Source: Malley's method, points on a disc lifted to the hemisphere.
#[must_use]
pub fn ambient_directions(n_directions: usize) -> Vec<Vec4> {
    vogel_disc(n_directions)
        .map(|at| DVec4::new(at.x, (1.0 - at.length_squared()).max(0.0).sqrt(), at.y, 0.0).as_vec4())
        .collect()
}

/// `n_points` points over the unit disc, each representing an equal area.
///
/// Source: Vogel 1979 (sunflower spiral).
pub fn vogel_disc(n_points: usize) -> impl Iterator<Item = DVec2> {
    let golden_angle_rad = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    #[allow(clippy::cast_precision_loss, reason = "a handful of points")]
    (0..n_points).map(move |i| {
        let radius = ((i as f64 + 0.5) / n_points as f64).sqrt();
        radius * DVec2::from_angle(i as f64 * golden_angle_rad)
    })
}
