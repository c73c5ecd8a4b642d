//! A toy that stands: its support points stay on their plane.
//!
//! An outline constrains a toy's distance ten times worse than its lateral place. The table helps:
//! the lowest points of a standing toy are on it.

use glam::DVec3;

use crate::report::Stand;
use crate::shape::Shape;

/// Standard deviation of the distance between a toy's support points and their plane, in metres:
/// felt pads, soft paws, and a table that is not quite flat.
pub(super) const DEVIATION_M: f64 = 1.5e-4;
/// Largest inclination of a standing toy, in radians.
const MOST_LEAN_RAD: f64 = 0.12;
/// Difference of the inclinations, in radians, of planes that are equally level: a tracker's error.
const AS_LEVEL_RAD: f64 = 0.01;
/// Largest inclination of a guessed plane against the toy's feet, in radians: beyond it, the toy
/// stands on other feet.
const MOST_GUESSED_LEAN_RAD: f64 = 0.5;
/// Number of rounds in which support points are exchanged; each round goes lower.
const N_ROUNDS: usize = 64;
/// Distance of the initial points of such a search, over the toy's radius, and again their height.
const FAR: f64 = 10.0;
/// Tolerance for points on a plane, over the toy's radius.
const ON_PLANE: f64 = 1e-6;

/// A plane in camera space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// Unit normal, towards the toy.
    pub(crate) normal: DVec3,
    /// A point on it.
    pub(crate) point: DVec3,
}

/// The ground that a toy may stand on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground {
    pub(crate) plane: Plane,
    /// Whether the toy certainly stands there.
    pub(crate) is_certain: bool,
}

impl Plane {
    /// The first of the most level of some planes: a toy that touches a wall does not stand on it.
    pub(crate) fn most_level(planes: impl Iterator<Item = Self>, up: DVec3) -> Option<Self> {
        let planes = planes.map(|plane| (plane.normal.angle_between(up), plane));
        let planes: Vec<(f64, Self)> = planes.collect();
        let least_rad = planes.iter().map(|(tilt_rad, _)| *tilt_rad).reduce(f64::min)?;
        let level = planes
            .into_iter()
            .find(|(tilt_rad, _)| *tilt_rad <= least_rad + AS_LEVEL_RAD);
        level.map(|(_, plane)| plane)
    }

    /// Distance of a point on the side of the normal, in metres.
    pub(crate) fn height_m(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }
}

/// The support points of a toy in its given place, and their heights above the plane.
#[derive(Clone, Debug)]
pub(super) struct Standing {
    pub(super) plane: Plane,
    pub(super) points: [DVec3; 3],
    pub(super) heights_m: [f64; 3],
}

impl Standing {
    /// With all three points on the plane; `None` if a toy would have to be inclined too far, or
    /// has no wide enough support.
    pub(super) fn on(shape: &Shape, plane: Plane) -> Option<Self> {
        let points = bearing(shape, &plane, MOST_LEAN_RAD)?;
        Some(Self {
            plane,
            points,
            heights_m: [0.0; 3],
        })
    }

    /// For a toy that would topple by its box, such as one on a thin leg: its lowest point on the plane, and those that
    /// would be lowest if it were inclined to any side as high above as they are given; `None` without points.
    pub(super) fn on_lowest(shape: &Shape, plane: Plane) -> Option<Self> {
        let (across, along) = plane.normal.any_orthonormal_pair();
        let lowest = |normal: DVec3| {
            let height = |point: &DVec3| normal.dot(*point - shape.centre);
            let points = shape.points.iter().copied();
            points.min_by(|a, b| height(a).total_cmp(&height(b)))
        };
        let lowest_m = plane.height_m(lowest(plane.normal)?);
        let [a, b, c] = [0.0_f64, 1.0, 2.0].map(|third| {
            let (sine, cosine) = (third * std::f64::consts::TAU / 3.0).sin_cos();
            lowest(plane.normal - MOST_LEAN_RAD * (cosine * across + sine * along))
        });
        let points = [a?, b?, c?];
        Some(Self {
            plane,
            points,
            heights_m: points.map(|point| plane.height_m(point) - lowest_m),
        })
    }

    /// With the same points at their given heights.
    pub(super) fn as_given(&self) -> Self {
        Self {
            heights_m: self.points.map(|point| self.plane.height_m(point)),
            ..*self
        }
    }

    /// Given height of the lowest point, in metres.
    pub(super) fn lowest_m(&self) -> f64 {
        let heights_m = self.points.map(|point| self.plane.height_m(point));
        heights_m.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Given distance of the nearest point from the plane, in metres.
    pub(super) fn nearest_m(&self) -> f64 {
        let heights_m = self.points.map(|point| self.plane.height_m(point).abs());
        heights_m.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Logarithm of the likelihood ratio of the feet's heights after and before a motion.
    pub(super) fn evidence(&self, moved: impl Fn(DVec3) -> DVec3) -> f64 {
        let squares =
            |point: DVec3, height_m: f64| ((self.plane.height_m(point) - height_m) / DEVIATION_M).powi(2);
        let feet = self.points.iter().zip(self.heights_m);
        feet.map(|(point, height_m)| 0.5 * (squares(*point, height_m) - squares(moved(*point), height_m)))
            .sum()
    }

    /// The toy's position on the plane after its points are moved.
    pub(super) fn stand(&self, moved: impl Fn(DVec3) -> DVec3) -> Stand {
        let feet = self.points.map(moved);
        let heights_m = feet.map(|foot| self.plane.height_m(foot));
        let normal = (feet[1] - feet[0])
            .cross(feet[2] - feet[0])
            .normalize_or(self.plane.normal);
        Stand {
            height_m: heights_m.into_iter().fold(0.0, |most: f64, height_m| {
                if height_m.abs() > most.abs() {
                    height_m
                } else {
                    most
                }
            }),
            lean_rad: normal.dot(self.plane.normal).abs().min(1.0).acos(),
        }
    }

    /// Distances of the points from their target heights, in metres.
    pub(super) fn away_m(&self) -> f64 {
        let away = self.points.iter().zip(self.heights_m);
        away.fold(0.0, |most, (point, height_m)| {
            most.max((self.plane.height_m(*point) - height_m).abs())
        })
    }
}

/// The position of a toy on a plane; `None` if it does not stand there.
pub(crate) fn stand(shape: &Shape, plane: Plane) -> Option<Stand> {
    Standing::on(shape, plane).map(|standing| standing.stand(|point| point))
}

/// The feet of a toy that stands on a guessed plane; `None` if it would have to be inclined too
/// far.
pub(crate) fn feet(shape: &Shape, plane: &Plane) -> Option<[DVec3; 3]> {
    bearing(shape, plane, MOST_GUESSED_LEAN_RAD)
}

/// The three points that a toy rests on after it is put down: of all planes without points below,
/// the one that is highest under the toy's centre.
fn bearing(shape: &Shape, plane: &Plane, most_lean_rad: f64) -> Option<[DVec3; 3]> {
    let (across, along) = plane.normal.any_orthonormal_pair();
    // In the plane's own frame, the height last.
    let local: Vec<DVec3> = shape
        .points
        .iter()
        .map(|point| {
            let from = *point - shape.centre;
            DVec3::new(from.dot(across), from.dot(along), from.dot(plane.normal))
        })
        .collect();
    let lowest = |tilt: DVec3| -> Option<usize> {
        let height = |point: &DVec3| point.z - tilt.x * point.x - tilt.y * point.y;
        let order = |(_, a): &(usize, &DVec3), (_, b): &(usize, &DVec3)| height(a).total_cmp(&height(b));
        local.iter().enumerate().min_by(order).map(|(index, _)| index)
    };
    // A triangle around the centre, far away and above everything: its corners are exchanged for
    // points of the toy.
    let far_m = FAR * shape.radius_m;
    let mut corners = [0.0_f64, 1.0, 2.0].map(|third| {
        let angle = third * std::f64::consts::TAU / 3.0;
        DVec3::new(far_m * angle.cos(), far_m * angle.sin(), FAR * far_m)
    });
    let mut indices: [Option<usize>; 3] = [None; 3];
    for _ in 0..N_ROUNDS {
        let Some(tilt) = tilt_of(&corners) else { break };
        let next = lowest(tilt)?;
        let below = |point: DVec3| point.z - tilt.x * point.x - tilt.y * point.y;
        if below(local[next]) >= below(corners[0]) - ON_PLANE * shape.radius_m
            || indices.contains(&Some(next))
        {
            break;
        }
        let place = (0..3).find(|place| {
            let mut exchanged = corners;
            exchanged[*place] = local[next];
            is_around_middle(&exchanged)
        })?;
        (corners[place], indices[place]) = (local[next], Some(next));
    }
    let [Some(a), Some(b), Some(c)] = indices else {
        return None;
    };
    let tilt = tilt_of(&corners)?;
    let lean_rad = tilt.truncate().length().atan();
    (lean_rad <= most_lean_rad).then(|| [a, b, c].map(|index| shape.points[index]))
}

/// Slope of the plane through three points along the first two axes; `None` if it is vertical.
fn tilt_of([a, b, c]: &[DVec3; 3]) -> Option<DVec3> {
    let normal = (*b - *a).cross(*c - *a);
    let is_upright = normal.z.abs() <= 1e-9 * normal.length();
    (!is_upright).then(|| DVec3::new(-normal.x / normal.z, -normal.y / normal.z, 0.0))
}

fn is_around_middle(corners: &[DVec3; 3]) -> bool {
    let [a, b, c] = corners.map(DVec3::truncate);
    let turns = [a.perp_dot(b), b.perp_dot(c), c.perp_dot(a)];
    turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0)
}
