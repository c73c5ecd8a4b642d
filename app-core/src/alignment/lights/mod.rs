//! The lights, by the shadows of the toy on the receivers.
//!
//! Each light's direction, distance and size move the shadow that the mesh predicts (`cast`) until frame over plate shows it.
//! What the lights give is linear and fitted along (`shading`): variable projection. Directions around the given one are
//! tried first, on a small picture, then Gauss-Newton steps on larger ones (`step`).

mod cast;
mod floor;
mod lamp;
mod shading;
mod step;

use glam::{DMat4, DVec2, DVec3, IVec2};

use super::picture::{Level, Pyramid};
use super::raster::{Rasterizer, project};
use super::receivers::SeenReceiver;
use super::shape::Shape;
use crate::scene::Light;
use cast::{Caster, flattened};
use floor::{FloorPixel, floor_pixels};
use lamp::{Lamp, N_PARTS, disc};
use shading::{Shaded, Shading};

/// Directions of ambient light.
const N_AMBIENT: usize = 128;
/// Scale of robust weights, in deviations: while lights may be far off, and after.
const ROBUST_FAR: f64 = 30.0;
const ROBUST_NEAR: f64 = 8.0;
/// Directions that are tried around the given one, in steps of `SEARCH_STEP_RAD`.
const SEARCH_STEP_RAD: f64 = 3.5 * std::f64::consts::PI / 180.0;
const SEARCH_STEPS: i32 = 4;
/// Points over a lamp then.
const N_SEARCH_POINTS: usize = 7;
/// Gauss-Newton rounds: level, number, and scale of the weights.
const ROUNDS: [(usize, usize, f64); 3] = [(3, 4, ROBUST_FAR), (2, 4, ROBUST_NEAR), (1, 3, ROBUST_NEAR)];
/// Where every penumbra is at least as wide in pixels of a level, a larger one tells no more.
const WIDE_PENUMBRA_PX: f64 = 5.0;
/// Pixels around the shadows that are looked at, in pixels of a level.
const AROUND_PX: i32 = 16;
/// Fewer pixels beside the toy tell no light.
const LEAST_PIXELS: usize = 100;
/// Wider than the lamps, so that shadows that grow stay in sight.
const GROWN: f64 = 1.5;

/// Lights that were found, and how they were judged.
pub(super) struct Found {
    /// In the order that they were given in.
    pub(super) lights: Vec<FoundLight>,
    /// Mean loss with the given lights, and with those found, of the same pixels.
    pub(super) losses: [f64; 2],
}

/// One of them.
pub(super) struct FoundLight {
    /// In the world.
    pub(super) light: Light,
    /// From the given direction, in radians.
    pub(super) turned_rad: f64,
    /// Over the given distance.
    pub(super) distance_ratio: f64,
    /// Radius over distance, as given.
    pub(super) given_spread: f64,
    /// As found.
    pub(super) spread: f64,
    /// One deviation of the direction, by noise alone.
    pub(super) deviation_rad: f64,
}

/// Finds the lights around those given; none where too little of a receiver shows their shadows, where one of them stands in the
/// middle of the toy, or where one would have to darken what it shines on.
pub(super) fn find(
    lights: &[Light],
    shape: &Shape,
    receivers: &[SeenReceiver],
    pyramid: &Pyramid,
    world_from_camera: &DMat4,
) -> Option<Found> {
    let camera_from_world = world_from_camera.inverse();
    let given: Option<Vec<Lamp>> = lights
        .iter()
        .map(|light| Lamp::new(light, &camera_from_world, shape.centre))
        .collect();
    let given = given?;
    let mut raster = Rasterizer::default();
    let mut lamps = given.clone();
    let smallest = Shadows::new(
        &mut raster,
        (shape, receivers),
        pyramid.level(Pyramid::SMALLEST),
        None,
    );
    smallest.search(&mut raster, &mut lamps);
    let mut losses = None;
    let mut deviations_rad = Vec::new();
    for (level, n_rounds, robust) in ROUNDS {
        let shadows = Shadows::new(
            &mut raster,
            (shape, receivers),
            pyramid.level(level),
            Some(&[&given[..], &lamps[..]].concat()),
        );
        if shadows.pixels.len() < LEAST_PIXELS {
            return None;
        }
        for _ in 0..n_rounds {
            deviations_rad = shadows.step(&mut raster, &mut lamps, &given, robust)?;
        }
        let shadings = [&given, &lamps].map(|lamps| shadows.shading(&mut raster, lamps, robust));
        if !shadings[1].has_light_of_all(lamps.len()) {
            return None;
        }
        losses = Some(shadings.map(|shading| shading.loss));
        if lamps
            .iter()
            .all(|lamp| shadows.penumbra_px(lamp) > WIDE_PENUMBRA_PX)
        {
            break;
        }
    }
    let found = given.iter().zip(&lamps).zip(deviations_rad);
    Some(Found {
        lights: found
            .map(|((given, lamp), deviation_rad)| FoundLight {
                light: lamp.light(world_from_camera, shape.centre),
                turned_rad: given.direction.angle_between(lamp.direction),
                distance_ratio: ratio(lamp.distance_m, given.distance_m),
                given_spread: given.spread,
                spread: lamp.spread,
                deviation_rad,
            })
            .collect(),
        losses: losses?,
    })
}

/// The toy's points flattened onto each receiver from the middle of a light, in camera space.
pub(super) fn hard_shadows(
    light: &Light,
    shape: &Shape,
    receivers: &[SeenReceiver],
    camera_from_world: &DMat4,
) -> Vec<Vec<DVec3>> {
    let Some(lamp) = Lamp::new(light, camera_from_world, shape.centre) else {
        return Vec::new();
    };
    let flat = receivers.iter().map(|receiver| {
        let plane_from_camera = &receiver.plane_from_camera;
        let middle = lamp.points(plane_from_camera, shape.centre, &[DVec2::ZERO]);
        flattened(shape, plane_from_camera, middle[0])
    });
    flat.collect()
}

fn ratio(found_m: Option<f64>, given_m: Option<f64>) -> f64 {
    found_m.zip(given_m).map_or(1.0, |(found, given)| found / given)
}

/// What one level shows of the shadows.
struct Shadows<'a> {
    caster: Caster<'a>,
    pixels: Vec<FloorPixel>,
    ambient: Vec<f32>,
    /// How far the shadow of the toy's top moves as a light turns, about.
    px_per_rad: f64,
}

impl<'a> Shadows<'a> {
    /// All of a level's receivers, or what lies around the shadows of `lamps`.
    fn new(
        raster: &mut Rasterizer,
        (shape, receivers): (&'a Shape, &'a [SeenReceiver]),
        level: &Level,
        lamps: Option<&[Lamp]>,
    ) -> Self {
        let size_px = level.frame.size_px;
        let corners = project(&shape.points, &level.intrinsics);
        let coverage = raster.coverage(&corners, &shape.triangles, size_px);
        let caster = Caster::new(shape, receivers, level.intrinsics, size_px);
        let rect = lamps.map(|lamps| shadow_rect(raster, &caster, lamps));
        let is_wanted =
            |at: IVec2| rect.is_none_or(|[low, high]| at.cmpge(low).all() && at.cmple(high).all());
        let pixels = floor_pixels(level, &coverage, receivers, is_wanted);
        Self {
            ambient: caster.ambient(raster, &pixels, N_AMBIENT),
            caster,
            pixels,
            px_per_rad: level.intrinsics.fx_px * shape.radius_m / shape.centre.length(),
        }
    }

    /// Width of the widest penumbra, about.
    fn penumbra_px(&self, lamp: &Lamp) -> f64 {
        2.0 * lamp.spread * self.px_per_rad
    }

    /// Points over a lamp: more the wider its penumbra.
    fn disc(&self, lamp: &Lamp) -> Vec<DVec2> {
        #[allow(clippy::cast_possible_truncation, reason = "clamped")]
        let n_points = self.penumbra_px(lamp).powi(2).clamp(8.0, 40.0) as usize;
        disc(n_points)
    }

    fn taken(&self, raster: &mut Rasterizer, lamp: &Lamp, disc: &[DVec2]) -> Vec<f32> {
        self.caster.lamp(raster, &self.pixels, lamp, disc)
    }

    /// The part that each lamp loses.
    fn taken_of_all(&self, raster: &mut Rasterizer, lamps: &[Lamp]) -> Vec<Vec<f32>> {
        let taken = lamps
            .iter()
            .map(|lamp| self.taken(raster, lamp, &self.disc(lamp)));
        taken.collect()
    }

    fn shaded<'b>(&'b self, lamps: &'b [Vec<f32>]) -> Shaded<'b> {
        Shaded {
            pixels: &self.pixels,
            ambient: &self.ambient,
            lamps,
        }
    }

    fn shading(&self, raster: &mut Rasterizer, lamps: &[Lamp], robust: f64) -> Shading {
        let taken = self.taken_of_all(raster, lamps);
        self.shaded(&taken).fit(self.caster.receivers.len(), robust)
    }

    /// Turns each lamp to the best of the directions around it, one after the other.
    fn search(&self, raster: &mut Rasterizer, lamps: &mut [Lamp]) {
        let disc = disc(N_SEARCH_POINTS);
        let mut taken: Vec<Vec<f32>> = lamps.iter().map(|lamp| self.taken(raster, lamp, &disc)).collect();
        let loss = |taken: &[Vec<f32>]| {
            let shading = self.shaded(taken).fit(self.caster.receivers.len(), ROBUST_FAR);
            shading.loss
        };
        for (index, lamp) in lamps.iter_mut().enumerate() {
            let mut best = (loss(&taken), *lamp, taken[index].clone());
            for step in directions() {
                let turned = lamp.moved(&step);
                taken[index] = self.taken(raster, &turned, &disc);
                let loss = loss(&taken);
                if loss < best.0 {
                    best = (loss, turned, taken[index].clone());
                }
            }
            (*lamp, taken[index]) = (best.1, best.2);
        }
    }
}

/// Steps to directions on a disc around a lamp's own.
fn directions() -> impl Iterator<Item = [f64; N_PARTS]> {
    let steps = -SEARCH_STEPS..=SEARCH_STEPS;
    let all = steps
        .clone()
        .flat_map(move |y| steps.clone().map(move |x| IVec2::new(x, y)));
    let around =
        all.filter(|step| *step != IVec2::ZERO && step.length_squared() <= SEARCH_STEPS * SEARCH_STEPS);
    around.map(|step| {
        let [x, y] = (step.as_dvec2() * SEARCH_STEP_RAD).to_array();
        [x, y, 0.0, 0.0]
    })
}

/// The pixels around the shadows of lamps, as the first and the last; empty where there is no shadow in the picture.
fn shadow_rect(raster: &mut Rasterizer, caster: &Caster, lamps: &[Lamp]) -> [IVec2; 2] {
    let mut rect = [IVec2::MAX, IVec2::MIN];
    for lamp in lamps {
        let grown = Lamp {
            spread: GROWN * lamp.spread,
            ..*lamp
        };
        let disc: Vec<DVec2> = (0..8)
            .map(|i| DVec2::from_angle(f64::from(i) * std::f64::consts::FRAC_PI_4))
            .collect();
        for [low, high] in caster.rects(raster, &grown, &disc) {
            rect = [rect[0].min(low), rect[1].max(high)];
        }
    }
    [
        rect[0].saturating_sub(IVec2::splat(AROUND_PX)),
        rect[1].saturating_add(IVec2::splat(AROUND_PX)),
    ]
}
