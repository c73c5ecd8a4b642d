//! Prior knowledge about lights other than their shadow: a ray to each, perhaps of unknown length.

use glam::{DMat4, DVec2, DVec3};

use super::hemisphere::climb;
use super::lamp::Lamp;
use super::prior::Prior;
use super::shadows::{ROBUST_FAR, Shadows};
use super::unexplained::Unexplained;
use crate::probe::TrackedLight;
use crate::raster::Rasterizer;
use app_scene::scene::MAX_LIGHTS;

/// Lengths of a ray to try if none is known, in metres; a light at infinity is tried as well.
const LENGTHS_M: [f64; 8] = [0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.5, 5.0];
/// The centre of a lamp alone.
const POINT: [DVec2; 1] = [DVec2::ZERO];
/// Rounds of one more lamp beside those before it.
const N_ROUNDS: usize = 5;

/// Knowledge about lights from sources other than shadows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hints {
    /// A probe's estimates: the search is restricted to them.
    pub(crate) initial_lights: Vec<InitialLight>,
    /// Direction towards a light, in camera space, that is a start if shadows alone show none; it
    /// may be far off.
    ///
    /// Measured on five sessions without a plate whose light is not found: an exact direction led
    /// to none either. They lack evidence, not a start.
    pub(crate) estimated: Option<DVec3>,
}

/// A ray to a light, in camera space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InitialLight {
    origin: DVec3,
    direction: DVec3,
    /// `None` if unknown.
    distance_m: Option<f64>,
    /// Tangent of the angular radius.
    spread: f64,
}

impl InitialLight {
    /// A guess from a probe's light.
    pub(crate) fn new(light: &TrackedLight, camera_from_world: &DMat4) -> Option<Self> {
        let seen = &light.seen;
        Some(Self {
            origin: camera_from_world.transform_point3(seen.origin_in_world),
            direction: camera_from_world
                .transform_vector3(seen.direction_in_world)
                .try_normalize()?,
            distance_m: light.distance_m,
            spread: seen.angular_radius_rad.tan(),
        })
    }

    /// Lamps of a toy: a near light has another direction from the toy than from the ray's origin.
    fn lamps(&self, toy: DVec3, radius_m: f64) -> Vec<Lamp> {
        let at = |distance_m: f64| {
            let to = self.origin + distance_m * self.direction - toy;
            // A lamp cannot be inside the toy.
            (to.length() > 2.0 * radius_m).then(|| Lamp {
                direction: to.normalize(),
                inverse_distance: to.length().recip(),
                spread: self.spread,
            })
        };
        let far = Lamp {
            direction: self.direction,
            inverse_distance: 0.0,
            spread: self.spread,
        };
        match self.distance_m.and_then(at) {
            Some(lamp) => vec![lamp],
            None => LENGTHS_M.into_iter().filter_map(at).chain([far]).collect(),
        }
    }
}

/// A lamp for each guess, strongest first: with the length of its ray that explains most of the
/// residual, turned to the best direction around it, and refined by steps.
pub(super) fn best_initial_lights(
    shadows: &Shadows<'_>,
    raster: &mut Rasterizer,
    initial_lights: &[InitialLight],
) -> Vec<Lamp> {
    let shape = shadows.caster.shape;
    let mut lamps: Vec<Lamp> = Vec::new();
    for initial in initial_lights.iter().take(MAX_LIGHTS) {
        let taken = shadows.taken_of_all(raster, &lamps);
        let shaded = shadows.shaded(&taken);
        let shading = shaded.fit(shadows.caster.receivers.len(), ROBUST_FAR);
        let unexplained = Unexplained::new(&shaded, &shading, ROBUST_FAR);
        let mut explained = |lamp: &Lamp| unexplained.explained(&shadows.taken(raster, lamp, &POINT));
        let tried = initial.lamps(shape.centre, shape.radius_m);
        let scored = tried.into_iter().map(|lamp| (explained(&lamp), lamp));
        let Some((_, best)) = scored.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            continue;
        };
        let (_, lamp) = climb(&best, explained);
        let mut priors: Vec<Prior> = lamps.iter().map(Prior::held).collect();
        lamps.push(lamp);
        priors.push(Prior::free(&lamp, shape.radius_m));
        // Unconstrained lamps stay.
        let _ = shadows.rounds(raster, (&mut lamps, &priors), (N_ROUNDS, ROBUST_FAR));
    }
    lamps
}
