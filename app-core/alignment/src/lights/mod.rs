//! Estimates the lights from the shadows of the toy on the receivers.
//!
//! Each light's direction, distance and size move the shadow that the mesh predicts (`cast`) until
//! it fits frame over plate. The lights' intensities are linear and fitted along (`shading`):
//! variable projection. For listed lights, directions around the given one are tried first, on a
//! small picture, then Gauss-Newton steps follow on larger ones (`step`). If none are listed, or
//! none near a list explains the shadow, they are searched all over the hemisphere (`search`), or
//! around a probe's estimates (`initial_light`). A long light is a line of round ones (`long`); if there is
//! no lamp at all, one wide light may be assumed (`wide`).

mod background;
mod behind;
mod cast;
mod classes;
mod evidence;
mod follow;
mod hemisphere;
mod initial_light;
mod joint;
mod lamp;
mod long;
mod on_plane;
mod prior;
mod receiver_pixels;
mod refine;
mod reflection;
mod relight;
mod search;
mod shading;
mod shadows;
mod step;
mod uncertainty;
mod unexplained;
mod watch;
mod wide;

use glam::{DMat4, DVec2, DVec3, IVec2};

use super::picture::Pyramid;
use super::raster::Rasterizer;
use super::receivers::SeenReceiver;
use super::report::{AssumedLight, EstimatedLight, LightAlignment, LightDeviation, PoseDeviation};
use super::shape::Shape;
use crate::no_light::NoLight;
use app_scene::scene::{Light, LightUncertainty};
use cast::flattened;
pub(crate) use classes::{Compared, Comparison, compare};
pub(super) use follow::{Around, Followed, View};
pub(super) use initial_light::{Hints, InitialLight};
pub(super) use joint::{Joined, OfOutline, joined};
use lamp::{Lamp, N_PARTS, disc};
pub(crate) use on_plane::OnPlane;
use prior::Prior;
pub(super) use reflection::{FoundReflection, reflected, reflection};
pub(super) use relight::Relight;
pub(super) use search::scores;
pub(super) use watch::{Counted, Unlit, Watched, watch};

use shadows::{CELL_PX, LEAST_PIXELS, ROBUST_FAR, ROBUST_NEAR, Shadows, WIDE_PENUMBRA_PX};

/// Spacing of the directions that are tried around the given one.
const SEARCH_STEP_RAD: f64 = 3.5 * std::f64::consts::PI / 180.0;
const SEARCH_STEPS: i32 = 4;
/// Wider spacing for a larger given uncertainty, and its largest angle.
const FAR_STEP_RAD: f64 = 2.0 * SEARCH_STEP_RAD;
const MOST_SEARCH_RAD: f64 = std::f64::consts::PI / 3.0;
/// Number of points over a lamp then.
const N_SEARCH_POINTS: usize = 7;
/// Gauss-Newton rounds: level, number, and scale of the weights.
const ROUNDS: [(usize, usize, f64); 3] = [(3, 4, ROBUST_FAR), (2, 4, ROBUST_NEAR), (1, 3, ROBUST_NEAR)];

/// A light has moved if it turned by more than this fraction of its spread, and by more than this
/// in radians; or if its size or its distance changed by more, as a logarithm.
const LEAST_TURN: f64 = 0.06;
const LEAST_TURN_RAD: f64 = 0.0015;
const LEAST_GROWTH: f64 = 0.15;
const LEAST_DISTANCE: f64 = 0.1;
/// Number of standard deviations of a significant turn.
const SIGNIFICANT: f64 = 3.0;

/// Estimated lights, and their scores.
pub(super) struct Found {
    /// Lights in the given order.
    pub(super) lights: Vec<FoundLight>,
    /// Mean loss with the given and with the estimated lights, for the same pixels.
    pub(super) losses: [f64; 2],
}

/// An estimated light.
pub(super) struct FoundLight {
    /// The light in the world.
    pub(super) light: Light,
    /// Angle from the given direction, in radians.
    pub(super) turned_rad: f64,
    /// Distance over the given one.
    pub(super) distance_ratio: f64,
    /// Tangent of the given angular radius.
    pub(super) given_spread: f64,
    /// Tangent of the estimated angular radius.
    pub(super) spread: f64,
    /// Standard deviation of the direction, by noise alone.
    pub(super) deviation_rad: f64,
}

impl FoundLight {
    /// Whether it moved visibly, and by more than noise.
    pub(super) fn is_moved(&self) -> bool {
        let least_rad = (LEAST_TURN * self.given_spread)
            .max(LEAST_TURN_RAD)
            .max(SIGNIFICANT * self.deviation_rad);
        self.turned_rad > least_rad
            || is_resized([self.given_spread, self.spread])
            || self.distance_ratio.ln().abs() > LEAST_DISTANCE
    }

    pub(super) fn report(&self, is_applied: bool) -> LightAlignment {
        LightAlignment {
            is_applied,
            is_moved: self.is_moved(),
            turned_rad: self.turned_rad,
            distance_ratio: self.distance_ratio,
            size_ratio: (self.given_spread > 0.0).then(|| self.spread / self.given_spread),
            is_resized: is_resized([self.given_spread, self.spread]),
            deviation_rad: self.deviation_rad,
        }
    }
}

/// Whether two sizes of a light, as tangents of the angular radius, differ visibly: `[given,
/// estimate]`.
pub(super) fn is_resized([given, estimate]: [f64; 2]) -> bool {
    (estimate - given).abs() > (LEAST_GROWTH * given).max(LEAST_TURN_RAD)
}

/// Estimates the lights around the given ones, within their uncertainty; `None` if too little of a
/// receiver shows their shadows, if one is at the centre of the toy, or if one would have to be
/// negative.
pub(super) fn find(
    (lights, uncertainty): (&[Light], &LightUncertainty),
    (shape, receivers): (&Shape, &[SeenReceiver]),
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
    let priors: Vec<Prior> = given.iter().map(|lamp| Prior::given(lamp, uncertainty)).collect();
    let mut lamps = given.clone();
    let level = pyramid.level(Pyramid::SMALLEST);
    let coarse = shape.merged_in_px(CELL_PX, level);
    let smallest = Shadows::new(&mut raster, (&coarse, receivers), level, None);
    smallest.search(&mut raster, &mut lamps, uncertainty);
    let mut losses = None;
    let mut deviations_rad = Vec::new();
    for (level, n_rounds, robust) in ROUNDS {
        let mut shadows = Shadows::new(
            &mut raster,
            (shape, receivers),
            pyramid.level(level),
            Some(&[&given[..], &lamps[..]].concat()),
        );
        if shadows.pixels.len() < LEAST_PIXELS {
            return None;
        }
        let shading = shadows.shading(&mut raster, &lamps, robust);
        shadows.light(&lamps, &shading);
        for _ in 0..n_rounds {
            deviations_rad = shadows.step(&mut raster, &mut lamps, &priors, robust)?;
        }
        let as_given = shadows.shading(&mut raster, &given, robust);
        let taken = shadows.taken_of_all(&mut raster, &lamps);
        let shaded = shadows.shaded(&taken);
        let shading = shaded.fit(receivers.len(), robust);
        if !shaded.has_light_of_all(&shading) {
            return None;
        }
        losses = Some([as_given.loss, shading.loss]);
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
                distance_ratio: ratio(lamp, given),
                given_spread: given.spread,
                spread: lamp.spread,
                deviation_rad,
            })
            .collect(),
        losses: losses?,
    })
}

/// The toy's points projected onto each receiver from points over the unit disc of a light, in
/// camera space.
pub(super) fn flat_shadows(
    light: &Light,
    shape: &Shape,
    receivers: &[SeenReceiver],
    camera_from_world: &DMat4,
    disc: &[DVec2],
) -> Vec<Vec<DVec3>> {
    let Some(lamp) = Lamp::new(light, camera_from_world, shape.centre) else {
        return Vec::new();
    };
    let flat = receivers.iter().flat_map(|receiver| {
        let plane_from_camera = &receiver.plane_from_camera;
        let points = lamp.points(plane_from_camera, shape.centre, disc);
        points
            .into_iter()
            .map(|point| flattened(shape, plane_from_camera, point))
    });
    flat.collect()
}

fn ratio(found: &Lamp, given: &Lamp) -> f64 {
    if found.is_far() || given.is_far() {
        1.0
    } else {
        given.inverse_distance / found.inverse_distance
    }
}

impl Shadows<'_> {
    /// Turns each lamp to the best of the directions around it, one after the other.
    fn search(&self, raster: &mut Rasterizer, lamps: &mut [Lamp], uncertainty: &LightUncertainty) {
        let disc = disc(N_SEARCH_POINTS);
        let mut taken: Vec<Vec<f32>> = lamps.iter().map(|lamp| self.taken(raster, lamp, &disc)).collect();
        let loss = |taken: &[Vec<f32>]| {
            let shading = self.shaded(taken).fit(self.caster.receivers.len(), ROBUST_FAR);
            shading.loss
        };
        for (index, lamp) in lamps.iter_mut().enumerate() {
            let mut best = (loss(&taken), *lamp, taken[index].clone());
            for step in directions(uncertainty.direction_rad) {
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

/// Steps to directions on a disc around a lamp's own, within a radius if one is known.
fn directions(most_rad: Option<f64>) -> impl Iterator<Item = [f64; N_PARTS]> {
    let usual_rad = f64::from(SEARCH_STEPS) * SEARCH_STEP_RAD;
    let most_rad = most_rad.unwrap_or(usual_rad).min(MOST_SEARCH_RAD);
    let near = grid(SEARCH_STEP_RAD, most_rad.min(usual_rad));
    let far = grid(FAR_STEP_RAD, most_rad).filter(move |step| step[0].hypot(step[1]) > usual_rad);
    near.chain(far)
}

/// Steps on a square grid of the given spacing within a radius, without zero.
fn grid(apart_rad: f64, most_rad: f64) -> impl Iterator<Item = [f64; N_PARTS]> {
    #[allow(clippy::cast_possible_truncation, reason = "a handful")]
    let n = (most_rad / apart_rad * (1.0 + 1e-9)) as i32;
    let all = (-n..=n).flat_map(move |y| (-n..=n).map(move |x| IVec2::new(x, y)));
    let around = all.filter(move |step| *step != IVec2::ZERO && step.length_squared() <= n * n);
    around.map(move |step| {
        let [x, y] = (step.as_dvec2() * apart_rad).to_array();
        [x, y, 0.0, 0.0]
    })
}

/// Assumes one wide light if none is found; `None` if no such light explains clearly more than
/// ambient light.
pub(super) fn assume_wide(
    shape: &Shape,
    receivers: &[SeenReceiver],
    pyramid: &Pyramid,
    world_from_camera: &DMat4,
) -> Option<AssumedLight> {
    let found = wide::assume(shape, receivers, pyramid)?;
    Some(AssumedLight {
        light: found.lamp.light(world_from_camera, shape.centre),
        share: found.share,
        explained: found.explained,
    })
}

/// A line of round lights that explains the shadow clearly better than one; `None` if there is
/// none.
pub(super) fn line_of(
    light: &Light,
    (shape, receivers): (&Shape, &[SeenReceiver]),
    pyramid: &Pyramid,
    world_from_camera: &DMat4,
) -> Option<Vec<Light>> {
    let lamp = Lamp::new(light, &world_from_camera.inverse(), shape.centre)?;
    let pieces = long::line_of(&lamp, (shape, receivers), pyramid)?;
    Some(
        pieces
            .map(|piece| piece.light(world_from_camera, shape.centre))
            .to_vec(),
    )
}

/// Estimates unlisted lights, strongest first; `pose` is the uncertainty of the toy's. With a
/// probe, its estimates that cast a shadow, refined by it.
pub(super) fn search_lights(
    shape: &Shape,
    receivers: &[SeenReceiver],
    pyramid: &Pyramid,
    world_from_camera: &DMat4,
    pose: &PoseDeviation,
    hints: &Hints,
) -> Result<Vec<EstimatedLight>, NoLight> {
    let mut found = search::search_lights(shape, receivers, pyramid, pose, hints)?;
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    let lights = found.iter().map(|found| {
        let lamp = &found.lamp;
        let [across, along, nearness_per_m, spread] = found.deviations;
        EstimatedLight {
            light: lamp.light(world_from_camera, shape.centre),
            direction_in_world: world_from_camera.transform_vector3(lamp.direction).normalize(),
            distance_m: (!lamp.is_far()).then(|| lamp.inverse_distance.recip()),
            angular_radius_rad: lamp.spread.atan(),
            share: found.share,
            deviation: LightDeviation {
                direction_rad: across.hypot(along),
                nearness_per_m,
                angular_radius_rad: spread / (1.0 + lamp.spread * lamp.spread),
            },
        }
    });
    Ok(lights.collect())
}
