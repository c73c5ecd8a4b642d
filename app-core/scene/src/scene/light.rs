//! The lights that a scene lists, and all properties that depend on their kind.

use glam::{DMat4, DVec2, DVec3, DVec4, Vec4};
use serde::Serialize;

use super::check::{self, InputError};
use crate::geometry::disc::vogel_disc;

/// A light whose direct shadow is retargeted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Light {
    /// A bulb. A radius of zero is a point.
    Sphere {
        /// Centre of the bulb, in metres.
        position_in_world: DVec3,
        /// Radius of the bulb, zero or more.
        radius_m: f64,
    },
    /// A light at infinity.
    Directional {
        /// Unit vector from the scene towards the light.
        direction_to_light_in_world: DVec3,
        /// Angular radius of the light's disc, from 0 to just under 90 degrees.
        angular_radius_rad: f64,
    },
}

impl Light {
    /// A bulb, in metres. A radius of zero is a point.
    #[must_use]
    pub const fn sphere(position_in_world: DVec3, radius_m: f64) -> Self {
        Self::Sphere {
            position_in_world,
            radius_m,
        }
    }

    /// A light at infinity, from the unit vector towards it and its angular radius.
    #[must_use]
    pub const fn directional(direction_to_light_in_world: DVec3, angular_radius_rad: f64) -> Self {
        Self::Directional {
            direction_to_light_in_world,
            angular_radius_rad,
        }
    }

    /// Validates the light, whose fields are below `field`.
    pub fn check(&self, field: &str) -> Result<(), InputError> {
        match *self {
            Self::Sphere {
                position_in_world,
                radius_m,
            } => {
                let position = check::light_position(position_in_world.to_array());
                InputError::at(&format!("{field}.position_in_world"), position)?;
                let radius = check::number(radius_m, &check::RADIUS_M);
                InputError::at(&format!("{field}.radius_m"), radius)?;
            }
            Self::Directional {
                direction_to_light_in_world,
                angular_radius_rad,
            } => {
                let unit = check::unit(direction_to_light_in_world);
                InputError::at(&format!("{field}.direction_to_light_in_world"), unit)?;
                let degrees = check::number(angular_radius_rad.to_degrees(), &check::ANGULAR_RADIUS_DEG);
                InputError::at(&format!("{field}.angular_radius_rad, in degrees"), degrees)?;
            }
        }
        Ok(())
    }

    /// The same light at another place: the functions map its centre, or the direction to it.
    #[must_use]
    pub fn map(&self, position: impl FnOnce(DVec3) -> DVec3, direction: impl FnOnce(DVec3) -> DVec3) -> Self {
        match *self {
            Self::Sphere {
                position_in_world,
                radius_m,
            } => Self::sphere(position(position_in_world), radius_m),
            Self::Directional {
                direction_to_light_in_world,
                angular_radius_rad,
            } => Self::directional(direction(direction_to_light_in_world), angular_radius_rad),
        }
    }

    /// The same light after a rigid motion, or in another space.
    #[must_use]
    pub fn moved(&self, new_from_old: &DMat4) -> Self {
        self.map(
            |position| new_from_old.transform_point3(position),
            |direction| new_from_old.transform_vector3(direction),
        )
    }

    /// Centre of the light, in metres; `None` for a light at infinity.
    #[must_use]
    pub fn position_in_world(&self) -> Option<DVec3> {
        match *self {
            Self::Sphere {
                position_in_world, ..
            } => Some(position_in_world),
            Self::Directional { .. } => None,
        }
    }

    /// Centre of the light in a space, homogeneous: (position, 1) or (unit direction to the light, 0).
    #[must_use]
    pub fn centre_in(&self, space_from_world: &DMat4) -> DVec4 {
        self.moved(space_from_world).centre()
    }

    /// Whether the light shines on the upper side of the plane y = 0 of a space.
    #[must_use]
    pub fn is_above(&self, plane_from_world: &DMat4) -> bool {
        self.centre_in(plane_from_world).y > 0.0
    }

    /// Radius in metres of a bulb, or slope of the rim of a light at infinity: radius over distance
    /// of its disc.
    #[must_use]
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Sphere { radius_m, .. } => radius_m,
            Self::Directional {
                angular_radius_rad, ..
            } => angular_radius_rad.tan(),
        }
    }

    /// The light with its rim's slope times `factor`, as seen from a place in the world. A light
    /// around that place stays the same.
    #[must_use]
    pub fn widened(&self, place_in_world: DVec3, factor: f64) -> Self {
        let Some(slope) = self.slope_from(place_in_world) else {
            return *self;
        };
        let angular_radius_rad = (factor * slope).atan();
        match *self {
            Self::Sphere {
                position_in_world, ..
            } => {
                let distance_m = position_in_world.distance(place_in_world);
                Self::sphere(position_in_world, distance_m * angular_radius_rad.sin())
            }
            Self::Directional {
                direction_to_light_in_world,
                ..
            } => Self::directional(direction_to_light_in_world, angular_radius_rad),
        }
    }

    /// Vector from a place in the world to the light's centre, in metres, or the unit vector to a
    /// light at infinity.
    #[must_use]
    pub fn vector_from(&self, place_in_world: DVec3) -> DVec3 {
        let centre = self.centre();
        if centre.w == 0.0 {
            centre.truncate()
        } else {
            centre.truncate() - place_in_world
        }
    }

    /// Unit vector from a place in the world to the light; `None` at its centre.
    #[must_use]
    pub fn direction_from(&self, place_in_world: DVec3) -> Option<DVec3> {
        match *self {
            Self::Sphere { .. } => self.vector_from(place_in_world).try_normalize(),
            Self::Directional {
                direction_to_light_in_world,
                ..
            } => Some(direction_to_light_in_world),
        }
    }

    /// Distance of the light's centre from a place in the world, in metres; `None` for a light at
    /// infinity.
    #[must_use]
    pub fn distance_m_from(&self, place_in_world: DVec3) -> Option<f64> {
        let position = self.position_in_world()?;
        Some((position - place_in_world).length())
    }

    /// Angular radius of the light as seen from a place in the world, in radians; a right angle
    /// from inside.
    #[must_use]
    pub fn angular_radius_rad_from(&self, place_in_world: DVec3) -> f64 {
        match *self {
            Self::Sphere {
                position_in_world,
                radius_m,
            } => {
                let distance_m = (position_in_world - place_in_world).length();
                (radius_m / distance_m).min(1.0).asin()
            }
            Self::Directional {
                angular_radius_rad, ..
            } => angular_radius_rad,
        }
    }

    /// Slope of the light's rim as seen from a place in the world: radius over distance of its
    /// outline; `None` from inside.
    #[must_use]
    pub fn slope_from(&self, place_in_world: DVec3) -> Option<f64> {
        let radius = self.radius();
        match self.distance_m_from(place_in_world) {
            Some(distance_m) => {
                (radius < distance_m).then(|| outline_radius_m(radius, distance_m) / distance_m)
            }
            None => Some(radius),
        }
    }

    /// `n_points` points over the light's disc as seen from the toy at `target_in_plane`, each representing an equal area:
    /// in plane space, homogeneous as [`Light::centre_in`].
    ///
    /// The disc of a sphere faces the toy, through the sphere's centre; seen from the toy it is the sphere's outline, and
    /// nearly so from anywhere near it.
    /// Source: Vogel 1979 (sunflower spiral).
    #[must_use]
    pub fn points_in(&self, plane_from_world: &DMat4, target_in_plane: DVec3, n_points: usize) -> Vec<Vec4> {
        let disc = self.moved(plane_from_world).disc_facing(target_in_plane);
        vogel_disc(n_points).map(|at| disc.point(at).as_vec4()).collect()
    }

    /// The corners of the square around the light's disc, as [`Light::points_in`], row by row.
    #[must_use]
    pub fn corners_in(&self, plane_from_world: &DMat4, target_in_plane: DVec3) -> [DVec4; 4] {
        let disc = self.moved(plane_from_world).disc_facing(target_in_plane);
        [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(x, y)| disc.point(DVec2::new(x, y)))
    }

    /// The centre, homogeneous: (position, 1) or (unit direction to the light, 0).
    fn centre(&self) -> DVec4 {
        match *self {
            Self::Sphere {
                position_in_world, ..
            } => position_in_world.extend(1.0),
            Self::Directional {
                direction_to_light_in_world,
                ..
            } => direction_to_light_in_world.extend(0.0),
        }
    }

    fn disc_facing(&self, target: DVec3) -> Disc {
        let axis = self.vector_from(target);
        let distance_m = self.distance_m_from(target);
        let radius = distance_m.map_or(self.radius(), |distance_m| {
            outline_radius_m(self.radius(), distance_m)
        });
        // For a light inside the toy, any disc will do.
        let (across, along) = axis.try_normalize().unwrap_or(DVec3::Y).any_orthonormal_pair();
        Disc {
            centre: self.centre(),
            across: radius * across,
            along: radius * along,
        }
    }
}

/// A light's disc, facing the toy.
struct Disc {
    centre: DVec4,
    across: DVec3,
    along: DVec3,
}

impl Disc {
    /// The point at `at` on the unit disc.
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

/// Radius of a sphere's outline, seen from `distance_m`, on the plane through its centre across the
/// line of sight: rays touch the sphere before they meet the plane. From inside there is no
/// outline, and any disc will do.
fn outline_radius_m(radius_m: f64, distance_m: f64) -> f64 {
    let tangent_m = (distance_m * distance_m - radius_m * radius_m).sqrt();
    if tangent_m > 0.0 {
        radius_m * distance_m / tangent_m
    } else {
        radius_m
    }
}
