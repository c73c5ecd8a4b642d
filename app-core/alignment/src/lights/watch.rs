//! Checks whether lights still explain the shadows in a picture.

use glam::DMat4;

use super::lamp::Lamp;
use super::relight::Relight;
use super::shadows::{LEAST_PIXELS, ROBUST_FAR, Shadows};
use crate::picture::Pyramid;
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;
use crate::shape::Shape;
use app_scene::scene::Light;

/// The shadows in a small picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Watched {
    /// Mean loss without any light, in variances: the strength of the shadows.
    pub(crate) shadows: f64,
    /// The fraction of it that lights leave unexplained.
    pub(crate) unexplained: f64,
}

impl Watched {
    /// The unexplained loss, in variances.
    pub(crate) fn left(&self) -> f64 {
        self.shadows * self.unexplained
    }
}

/// The pixels at which a loss counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Counted {
    All,
    /// Those in the lights' shadows: all others may show something else than a shadow of the toy.
    InShadows,
}

/// Part of a light from which on a pixel is in its shadow: the middle of the penumbra.
const SHADOWED: f32 = 0.5;
/// Minimum number of such pixels of the level, since a thing may hide nearly all of a shadow: 70 and 109
/// are left beside two hands.
const LEAST_SHADOWED: usize = 40;

/// The loss that given lights leave in a picture; the intensity of each, and the light on the
/// receivers without a toy, are fitted anew. `None` if too little of the receivers, or of the shadows that
/// count, is visible, and without a plate.
///
/// Measured on six captures and the bundled session, in all their frames: .001 to .019 with exact
/// lights, .010 to .058 with one that is a degree off, .11 to .35 with one that is four.
pub(crate) fn watch(
    (lights, counted): (&[Light], Counted),
    shape: &Shape,
    receivers: &[SeenReceiver],
    pyramid: &Pyramid,
    world_from_camera: &DMat4,
) -> Option<Watched> {
    let camera_from_world = world_from_camera.inverse();
    let lamps = lights
        .iter()
        .map(|light| Lamp::new(light, &camera_from_world, shape.centre));
    let lamps = lamps.collect::<Option<Vec<_>>>()?;
    let mut raster = Rasterizer::default();
    let relight = Relight::of(shape, receivers, pyramid, &camera_from_world)?;
    let level = relight.level(pyramid.level(pyramid.smallest_for_shadows()));
    let mut shadows = Shadows::new(&mut raster, (shape, receivers), &level, None);
    if shadows.pixels.len() < LEAST_PIXELS {
        return None;
    }
    let no_light = shadows.shading(&mut raster, &[], ROBUST_FAR);
    let first_taken = shadows.taken_of_all(&mut raster, &lamps);
    let shading = shadows.shaded(&first_taken).fit(receivers.len(), ROBUST_FAR);
    shadows.light(&lamps, &shading);
    let taken = shadows.taken_of_all(&mut raster, &lamps);
    let lit = shadows.shaded(&taken);
    let with_lights = lit.fit(receivers.len(), ROBUST_FAR);
    let (without, with) = match counted {
        Counted::All => (no_light.loss, with_lights.loss),
        Counted::InShadows => {
            let is_shadowed = |index: usize| first_taken.iter().any(|taken| taken[index] > SHADOWED);
            let n_shadowed = (0..shadows.pixels.len())
                .filter(|index| is_shadowed(*index))
                .count();
            if n_shadowed < LEAST_SHADOWED {
                return None;
            }
            let without = shadows.shaded(&[]).loss(&no_light, ROBUST_FAR, is_shadowed);
            (without, lit.loss(&with_lights, ROBUST_FAR, is_shadowed))
        }
    };
    Some(Watched {
        shadows: without,
        unexplained: if without > 0.0 { with / without } else { 0.0 },
    })
}
