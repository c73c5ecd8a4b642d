//! Checks whether lights still explain the shadows in a picture.

use glam::DMat4;

use super::cast::Ambient;
use super::lamp::Lamp;
use super::receiver_pixels::ReceiverPixel;
use super::relight::Relight;
use super::shading::Shading;
use super::shadows::{LEAST_PIXELS, ROBUST_FAR, Shadows};
use crate::picture::{Level, Pyramid};
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

/// A small picture with its plate in the picture's own light, and the shadows in it without any lamp.
#[derive(Debug)]
pub(crate) struct Unlit {
    level: Level,
    pixels: Vec<ReceiverPixel>,
    ambient: Vec<Ambient>,
    no_light: Shading,
}

impl Unlit {
    /// `None` if too little of the receivers is visible, and without a plate.
    pub(crate) fn of(
        (shape, receivers): (&Shape, &[SeenReceiver]),
        pyramid: &Pyramid,
        camera_from_world: &DMat4,
    ) -> Option<Self> {
        let relight = Relight::of(shape, receivers, pyramid, camera_from_world)?;
        let level = relight.level(pyramid.level(pyramid.smallest_for_shadows()));
        let mut raster = Rasterizer::default();
        let shadows = Shadows::new(&mut raster, (shape, receivers), &level, None);
        if shadows.pixels.len() < LEAST_PIXELS {
            return None;
        }
        let no_light = shadows.shading(&mut raster, &[], ROBUST_FAR);
        let Shadows { pixels, ambient, .. } = shadows;
        Some(Self {
            level,
            pixels,
            ambient,
            no_light,
        })
    }
}

/// The loss that given lights leave in a picture; the intensity of each, and the light on the
/// receivers without a toy, are fitted anew. `None` if too little of the shadows that count is visible.
///
/// Measured on six captures and the bundled session, in all their frames: .001 to .019 with exact
/// lights, .010 to .058 with one that is a degree off, .11 to .35 with one that is four.
pub(crate) fn watch(
    (lights, counted): (&[Light], Counted),
    unlit: &Unlit,
    (shape, receivers): (&Shape, &[SeenReceiver]),
    camera_from_world: &DMat4,
) -> Option<Watched> {
    let lamps = lights
        .iter()
        .map(|light| Lamp::new(light, camera_from_world, shape.centre));
    let lamps = lamps.collect::<Option<Vec<_>>>()?;
    let mut raster = Rasterizer::default();
    let no_light = &unlit.no_light;
    let known = (unlit.pixels.clone(), unlit.ambient.clone());
    let mut shadows = Shadows::of((shape, receivers), &unlit.level, known);
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
            let without = shadows.shaded(&[]).loss(no_light, ROBUST_FAR, is_shadowed);
            (without, lit.loss(&with_lights, ROBUST_FAR, is_shadowed))
        }
    };
    Some(Watched {
        shadows: without,
        unexplained: if without > 0.0 { with / without } else { 0.0 },
    })
}
