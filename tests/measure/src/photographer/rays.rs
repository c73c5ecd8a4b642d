//! Light transport to points of a world: intersections, visibility of lights, and reflected light.

use std::array;

use glam::{DMat4, DVec2, DVec3};

use super::lamp::{Cone, Lamp, disc};
use super::motion::stance_at;
use super::shape::Shape;
use super::world::{Ground, Shown, World};

/// Number of fixed patterns that alternate, so that the rays of one pixel do not repeat each other.
const N_PATTERNS: usize = 4;

/// A world at a moment, ready for rays: the toy in a pose, or absent.
#[derive(Debug)]
pub struct Place<'a> {
    world: &'a World,
    bodies: Vec<Body<'a>>,
    planes: Vec<(DMat4, &'a Ground)>,
    light_pattern: [Vec<DVec2>; N_PATTERNS],
    sky_pattern: [Vec<DVec2>; N_PATTERNS],
}

#[derive(Debug)]
struct Body<'a> {
    shape: &'a Shape,
    color: DVec3,
    world_from_part: DMat4,
    part_from_world: DMat4,
    centre: DVec3,
    radius_m: f64,
}

/// The target of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Thing {
    /// A part of the toy.
    Body(usize),
    /// A receiver.
    Ground(usize),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    pub(super) thing: Thing,
    pub(super) at: DVec3,
    /// Unit normal, on the ray's side.
    pub(super) normal: DVec3,
    pub(super) albedo: DVec3,
    distance: f64,
}

impl<'a> Place<'a> {
    /// The world with its toy in a pose.
    #[must_use]
    pub fn new(world: &'a World, pose: Shown) -> Self {
        let bodies = world.parts.iter().map(|part| {
            let stance = match pose {
                Shown::Rest => part.rest,
                Shown::At { time_secs } => stance_at(part.rest, &part.keys, time_secs),
            };
            let world_from_part = world.world_from_object * stance.object_from_part();
            Body {
                shape: &part.shape,
                color: part.color,
                world_from_part,
                part_from_world: world_from_part.inverse(),
                centre: world_from_part.w_axis.truncate(),
                radius_m: world_from_part.x_axis.truncate().length() * part.shape.radius_m(),
            }
        });
        Self {
            bodies: bodies.collect(),
            ..Self::empty(world)
        }
    }

    /// The world without its toy.
    #[must_use]
    pub fn empty(world: &'a World) -> Self {
        let patterns = |n: u32| array::from_fn(|i| disc(n, i as f64 / N_PATTERNS as f64));
        let planes = world.grounds.iter();
        Self {
            world,
            bodies: Vec::new(),
            planes: planes
                .map(|ground| (ground.world_from_plane.inverse(), ground))
                .collect(),
            light_pattern: patterns(world.quality.n_light_rays),
            sky_pattern: patterns(world.quality.n_sky_rays),
        }
    }

    /// Fraction of a lamp's light that reaches (x, z) of a receiver, 0 to 1.
    #[must_use]
    pub fn visibility_on(&self, ground: usize, in_plane: DVec2, lamp: usize) -> f64 {
        let hit = self.point_on(ground, in_plane);
        let lamp = &self.world.lamps[lamp];
        let of_pattern = |pattern| {
            let [reached, total] = self.cosines(&hit, lamp, pattern);
            DVec3::splat(visibility(reached, total))
        };
        self.mean(of_pattern).x
    }

    /// Light at (x, z) of a receiver, as the radiance of a white surface there.
    #[must_use]
    pub fn light_on(&self, ground: usize, in_plane: DVec2) -> DVec3 {
        let hit = Hit {
            albedo: DVec3::ONE,
            ..self.point_on(ground, in_plane)
        };
        self.mean(|pattern| self.look(&hit, pattern).0)
    }

    /// Distance of a point from the surface of the nearest part, along rays through that part's
    /// centre.
    #[must_use]
    pub fn distance_to_surface(&self, at: DVec3) -> f64 {
        let distances = self.bodies.iter().filter_map(|body| {
            let in_part = body.part_from_world.transform_point3(at);
            let crossing = body.shape.crossing(DVec3::ZERO, in_part)?;
            let scale = body.world_from_part.x_axis.truncate().length();
            Some(scale * in_part.length() * (crossing.leave - 1.0).abs())
        });
        distances.fold(f64::INFINITY, f64::min)
    }

    fn point_on(&self, ground: usize, in_plane: DVec2) -> Hit {
        let (_, plane) = self.planes[ground];
        let at = DVec3::new(in_plane.x, 0.0, in_plane.y);
        Hit {
            thing: Thing::Ground(ground),
            at: plane.world_from_plane.transform_point3(at),
            normal: plane.world_from_plane.y_axis.truncate(),
            albedo: plane.paint.at(in_plane),
            distance: 0.0,
        }
    }

    fn mean(&self, of_pattern: impl Fn(usize) -> DVec3) -> DVec3 {
        let n_patterns = N_PATTERNS as f64;
        (0..N_PATTERNS).map(of_pattern).sum::<DVec3>() / n_patterns
    }

    /// The nearest intersection of a ray.
    pub(super) fn nearest(&self, origin: DVec3, direction: DVec3, skipped: Option<Thing>) -> Option<Hit> {
        let bodies = self.bodies.iter().enumerate().filter_map(|(index, body)| {
            let thing = Thing::Body(index);
            if skipped == Some(thing) || body.is_passed_by(origin, direction) {
                return None;
            }
            let in_part = body.part_from_world.transform_point3(origin);
            let along = body.part_from_world.transform_vector3(direction);
            let crossing = body.shape.crossing(in_part, along)?;
            let normal = body.world_from_part.transform_vector3(crossing.normal);
            (crossing.enter > 0.0).then(|| Hit {
                thing,
                at: origin + crossing.enter * direction,
                normal: normal.normalize(),
                albedo: body.color,
                distance: crossing.enter,
            })
        });
        let planes = self.planes.iter().enumerate();
        let grounds = planes.filter_map(|(index, (plane_from_world, ground))| {
            let thing = Thing::Ground(index);
            if skipped == Some(thing) {
                return None;
            }
            let (distance, in_plane) = meets(plane_from_world, ground, origin, direction)?;
            let up = ground.world_from_plane.y_axis.truncate();
            Some(Hit {
                thing,
                at: origin + distance * direction,
                normal: if up.dot(direction) > 0.0 { -up } else { up },
                albedo: ground.paint.at(in_plane),
                distance,
            })
        });
        bodies
            .chain(grounds)
            .min_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// Linear radiance from a point towards the camera, and the smallest visibility over all
    /// lights, with the pattern of that number.
    pub(super) fn look(&self, hit: &Hit, pattern: usize) -> (DVec3, f64) {
        let mut light = self.indirect(hit, pattern);
        let mut smallest = 1.0_f64;
        let is_toy = matches!(hit.thing, Thing::Body(_));
        let sheen = self.world.sheen.as_ref().filter(|_| is_toy);
        let to_camera = (self.world.camera.world_from_camera.w_axis.truncate() - hit.at).normalize();
        let mut reflected = DVec3::ZERO;
        for lamp in &self.world.lamps {
            let [reached, total] = self.cosines(hit, lamp, pattern);
            light += lamp.color * reached;
            if let Some(sheen) = sheen {
                reflected += lamp.color * reached * sheen.of_lamp(hit, to_camera, lamp);
            }
            smallest = smallest.min(visibility(reached, total));
        }
        if let Some(sheen) = sheen {
            reflected += sheen.of_place((self, hit), to_camera, pattern);
        }
        (hit.albedo * light + reflected, smallest)
    }

    /// Light of a lamp at a point, with and without occlusion.
    fn cosines(&self, hit: &Hit, lamp: &Lamp, pattern: usize) -> [f64; 2] {
        let cone = lamp.cone(hit.at);
        let suspects = self.suspects(hit, &cone);
        let above = hit.normal.dot(cone.axis);
        if suspects.is_empty() && above >= cone.sine {
            // A sphere fully above the horizon has the irradiance of its centre.
            return [cone.strength * above; 2];
        }
        let centre = [DVec2::ZERO];
        let pattern = if cone.sine == 0.0 {
            &centre[..]
        } else {
            &self.light_pattern[pattern]
        };
        let (mut reached, mut total) = (0.0, 0.0);
        for direction in cone.directions(pattern) {
            let cosine = hit.normal.dot(direction).max(0.0);
            total += cosine;
            if cosine > 0.0 && !self.hides(hit.at, &suspects, direction, cone.distance_m) {
                reached += cosine;
            }
        }
        let weight = cone.weight() / pattern.len() as f64;
        [reached, total].map(|sum| weight * sum)
    }

    /// Possible occluders between a point and a light.
    fn suspects(&self, hit: &Hit, cone: &Cone) -> Vec<Thing> {
        let bodies = self.bodies.iter().enumerate();
        let bodies = bodies
            .filter(|(_, body)| !cone.misses(body.centre - hit.at, body.radius_m))
            .map(|(index, _)| Thing::Body(index));
        let planes = self.planes.iter().enumerate();
        let planes = planes
            .filter(|(_, (plane_from_world, _))| {
                let height_m = plane_from_world.transform_point3(hit.at).y;
                let rise = plane_from_world.transform_vector3(cone.axis).y;
                // All directions of the cone lead away from the plane.
                let is_left = rise.abs() >= cone.sine && rise * height_m > 0.0;
                !is_left
            })
            .map(|(index, _)| Thing::Ground(index));
        // A convex part does not occlude front-facing points of its own surface, nor does a plane.
        bodies.chain(planes).filter(|thing| *thing != hit.thing).collect()
    }

    fn hides(&self, from: DVec3, suspects: &[Thing], direction: DVec3, distance_m: f64) -> bool {
        suspects.iter().any(|thing| match *thing {
            Thing::Body(index) => {
                let body = &self.bodies[index];
                let in_part = body.part_from_world.transform_point3(from);
                let along = body.part_from_world.transform_vector3(direction);
                let crossing = body.shape.crossing(in_part, along);
                crossing.is_some_and(|crossing| crossing.leave > 0.0 && crossing.enter < distance_m)
            }
            Thing::Ground(index) => {
                let (plane_from_world, ground) = &self.planes[index];
                meets(plane_from_world, ground, from, direction).is_some_and(|(at, _)| at < distance_m)
            }
        })
    }

    /// Light of the sky and from other surfaces, on a white surface at a point.
    fn indirect(&self, hit: &Hit, pattern: usize) -> DVec3 {
        if self.bodies.is_empty() && self.planes.len() < 2 {
            return self.world.sky;
        }
        let (across, along) = hit.normal.any_orthonormal_pair();
        let pattern = &self.sky_pattern[pattern];
        let light = pattern.iter().map(|at| {
            // Uniform over the disc below a hemisphere is cosine-weighted over the hemisphere.
            // Source: Malley 1988.
            let up = (1.0 - at.length_squared()).max(0.0).sqrt();
            let direction = up * hit.normal + at.x * across + at.y * along;
            self.light_along(hit, direction)
        });
        let n_rays = pattern.len() as f64;
        light.sum::<DVec3>() / n_rays
    }

    /// Light of the sky, or of what another thing throws back, from a direction.
    pub(super) fn light_along(&self, hit: &Hit, direction: DVec3) -> DVec3 {
        match self.nearest(hit.at, direction, Some(hit.thing)) {
            None => self.world.sky,
            Some(other) if self.world.bounces => self.thrown_back(&other),
            Some(_) => DVec3::ZERO,
        }
    }

    /// One of the patterns of rays into the hemisphere.
    pub(super) fn sky_pattern(&self, pattern: usize) -> &[DVec2] {
        &self.sky_pattern[pattern]
    }

    /// Light that a surface reflects of the sky and of the lamps' centres.
    fn thrown_back(&self, hit: &Hit) -> DVec3 {
        let lamps = self.world.lamps.iter().map(|lamp| {
            let cone = lamp.cone(hit.at);
            let cosine = hit.normal.dot(cone.axis);
            let suspects = self.suspects(hit, &cone);
            if cosine <= 0.0 || self.hides(hit.at, &suspects, cone.axis, cone.distance_m) {
                return DVec3::ZERO;
            }
            cosine * cone.strength * lamp.color
        });
        hit.albedo * (self.world.sky + lamps.sum::<DVec3>())
    }

    /// Radiance of the background.
    pub(super) fn backdrop(&self) -> DVec3 {
        self.world.sky
    }

    pub(super) fn world(&self) -> &World {
        self.world
    }
}

/// Fraction of a light that reaches a point, 0 to 1; 1 for a light behind it.
fn visibility(reached: f64, total: f64) -> f64 {
    if total > 0.0 { reached / total } else { 1.0 }
}

impl Body<'_> {
    /// Whether a ray misses even the sphere around the part.
    fn is_passed_by(&self, origin: DVec3, direction: DVec3) -> bool {
        let to_centre = self.centre - origin;
        let along = to_centre.dot(direction);
        let squared_length = direction.length_squared();
        let squared_distance = to_centre.length_squared() - along * along / squared_length;
        let squared_radius = self.radius_m * self.radius_m;
        squared_distance > squared_radius * 1.000_001
            || (along < 0.0 && to_centre.length_squared() > squared_radius)
    }
}

/// Intersection of a ray with a rectangle, from either side: multiples of its direction, and (x,
/// z).
fn meets(plane_from_world: &DMat4, ground: &Ground, origin: DVec3, direction: DVec3) -> Option<(f64, DVec2)> {
    let start = plane_from_world.transform_point3(origin);
    let along = plane_from_world.transform_vector3(direction);
    let distance = -start.y / along.y;
    if !(distance > 0.0 && distance.is_finite()) {
        return None;
    }
    let at = start + distance * along;
    let in_plane = DVec2::new(at.x, at.z);
    in_plane
        .abs()
        .cmple(ground.half_extent_m)
        .all()
        .then_some((distance, in_plane))
}
