//! Lights that are tracked while other parameters are varied, on the same pixels in each try.

use glam::{DMat4, IVec2};

use super::lamp::Lamp;
use super::prior::Prior;
use super::shadows::{CELL_PX, LEAST_PIXELS, ROBUST_FAR, ROBUST_NEAR, Shadows};
use crate::picture::Pyramid;
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;
use crate::shape::Shape;
use app_scene::scene::{Light, LightUncertainty, MAX_LIGHTS};

/// Gauss-Newton rounds of lamps that were just turned to the best direction.
const N_FIRST: usize = 4;

/// A toy's place, the receivers and the pictures.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    /// The toy.
    pub(crate) shape: &'a Shape,
    /// The receivers of its shadows.
    pub(crate) receivers: &'a [SeenReceiver],
    /// The pictures.
    pub(crate) pyramid: &'a Pyramid,
}

/// Lamps relative to the toy, which hardly change with the toy's place.
#[derive(Clone)]
pub(crate) struct Followed {
    lamps: Vec<Lamp>,
    priors: Vec<Prior>,
    robust: f64,
}

impl Followed {
    /// Lights near the listed ones; `None` if there are none or too many, one is at the toy's
    /// centre, or too little of their shadows is visible.
    pub(crate) fn new(lights: &[Light], view: View<'_>, camera_from_world: &DMat4) -> Option<Self> {
        if lights.is_empty() || lights.len() > MAX_LIGHTS {
            return None;
        }
        let lamps = lights
            .iter()
            .map(|light| Lamp::new(light, camera_from_world, view.shape.centre));
        let mut lamps: Vec<Lamp> = lamps.collect::<Option<_>>()?;
        let known = LightUncertainty::default();
        let priors = lamps.iter().map(|lamp| Prior::given(lamp, &known)).collect();
        let mut raster = Rasterizer::default();
        let level = view.pyramid.level(Pyramid::SMALLEST);
        let coarse = view.shape.merged_in_px(CELL_PX, level);
        let smallest = Shadows::new(&mut raster, (&coarse, view.receivers), level, None);
        if smallest.pixels.len() < LEAST_PIXELS {
            return None;
        }
        smallest.search(&mut raster, &mut lamps, &known);
        let mut followed = Self {
            lamps,
            priors,
            robust: ROBUST_FAR,
        };
        let around = followed.around(view, Pyramid::SMALLEST);
        followed.next(view, &around, N_FIRST)?;
        followed.robust = ROBUST_NEAR;
        Some(followed)
    }

    /// The pixels of a level around the lamps' shadows.
    pub(crate) fn around(&self, view: View<'_>, level: usize) -> Around {
        let mut raster = Rasterizer::default();
        let picture = view.pyramid.level(level);
        let rect = Shadows::around(&mut raster, (view.shape, view.receivers), picture, &self.lamps);
        Around { level, rect }
    }

    /// Moves the lamps to the best fit of those pixels; returns the mean remaining loss. `None` if
    /// the pixels do not constrain them, or if a lamp would have to be negative.
    pub(crate) fn next(&mut self, view: View<'_>, around: &Around, n_rounds: usize) -> Option<f64> {
        let mut raster = Rasterizer::default();
        let posed = (view.shape, view.receivers);
        let picture = view.pyramid.level(around.level);
        let mut shadows = Shadows::within(&mut raster, posed, picture, Some(around.rect));
        if shadows.pixels.len() < LEAST_PIXELS {
            return None;
        }
        let shading = shadows.shading(&mut raster, &self.lamps, self.robust);
        shadows.light(&self.lamps, &shading);
        for _ in 0..n_rounds {
            shadows.step(&mut raster, &mut self.lamps, &self.priors, self.robust)?;
        }
        let taken = shadows.taken_of_all(&mut raster, &self.lamps);
        let shaded = shadows.shaded(&taken);
        let shading = shaded.fit(view.receivers.len(), self.robust);
        shaded.has_light_of_all(&shading).then_some(shading.loss)
    }
}

/// Pixels of a level: the first and the last.
#[derive(Clone, Copy)]
pub(crate) struct Around {
    level: usize,
    rect: [IVec2; 2],
}
