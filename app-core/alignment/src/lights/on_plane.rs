//! Predicts the shadow on an unlisted plane in the estimated light of a receiver.

use glam::{DVec2, DVec3, IVec2};

use super::background::QUADRATIC;
use super::cast::{Caster, irradiance};
use super::classes::Comparison;
use super::lamp::{Lamp, disc};
use super::receiver_pixels::ReceiverPixel;
use super::shading::{FIRST_LAMP, Factors, PRIOR};
use crate::picture::{Color, Level};
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;
use crate::shape::Shape;
use app_scene::scene::Intrinsics;

/// Samples of a lamp and directions of ambient light. Few suffice: the shadow's place matters.
const N_POINTS: usize = 12;
const N_DIRECTIONS: usize = 16;
/// Least light on a plane without a toy, over the receiver's.
const LEAST_UNSHADOWED: f64 = 0.05;

/// The light on a receiver, and a toy in it.
#[derive(Clone)]
pub(crate) struct OnPlane<'a> {
    shape: &'a Shape,
    lamps: &'a [Lamp],
    intrinsics: Intrinsics,
    size_px: IVec2,
    /// Factors of each channel, relative to the light at the foot of the toy.
    factors: [Factors; 3],
    /// Irradiance of each lamp at the foot, up to a factor.
    at_foot: Vec<f64>,
}

impl<'a> OnPlane<'a> {
    /// The light on one of the compared receivers.
    pub(crate) fn new(
        comparison: &'a Comparison,
        (shape, receivers): (&'a Shape, &[SeenReceiver]),
        receiver: usize,
        level: &Level,
    ) -> Self {
        let table = &receivers[receiver];
        let foot = table.plane_from_camera.transform_point3(shape.centre) * DVec3::new(1.0, 0.0, 1.0);
        let at_foot = comparison
            .lamps
            .iter()
            .map(|lamp| irradiance(lamp.middle(&table.plane_from_camera, shape.centre), foot));
        let factors = comparison.shading.factors[receiver].map(|factors| factors / factors[0].max(PRIOR));
        Self {
            shape,
            lamps: &comparison.lamps,
            intrinsics: level.intrinsics,
            size_px: level.frame.size_px,
            factors,
            at_foot: at_foot.collect(),
        }
    }

    /// Ratio of frame to plate, pixel by pixel, row by row, if they show a plane; `None` for other
    /// pixels.
    pub(crate) fn ratios(
        &self,
        raster: &mut Rasterizer,
        plane: &SeenReceiver,
        pixels: &[IVec2],
    ) -> Vec<Option<Color>> {
        let planes = std::slice::from_ref(plane);
        let caster = Caster::new(self.shape, planes, self.intrinsics, self.size_px);
        let points: Vec<Option<DVec3>> = pixels
            .iter()
            .map(|at| plane.point_at(&self.intrinsics, *at))
            .collect();
        let pixels_of_receiver: Vec<ReceiverPixel> = pixels
            .iter()
            .zip(&points)
            .map(|(at, point)| ReceiverPixel::bare(*at, point.unwrap_or(DVec3::ZERO)))
            .collect();
        let points_of_lamp: Vec<DVec2> = disc(N_POINTS);
        let taken: Vec<Vec<f32>> = self
            .lamps
            .iter()
            .map(|lamp| caster.lamp(raster, &pixels_of_receiver, lamp, &points_of_lamp))
            .collect();
        let ambient = caster.ambient(raster, &pixels_of_receiver, N_DIRECTIONS);
        let lit: Vec<Vec<f64>> = self
            .lamps
            .iter()
            .zip(&self.at_foot)
            .map(|(lamp, at_foot)| {
                let middle = lamp.middle(&plane.plane_from_camera, self.shape.centre);
                let over_foot = |point: &DVec3| {
                    let at = plane.plane_from_camera.transform_point3(*point);
                    irradiance(middle, at) / at_foot.max(f64::MIN_POSITIVE)
                };
                points
                    .iter()
                    .map(|point| point.as_ref().map_or(0.0, over_foot))
                    .collect()
            })
            .collect();
        let ratio = |index: usize| {
            points[index].is_some().then(|| {
                self.factors.map(|factors| {
                    let mut unshadowed = 1.0;
                    let mut lost = 0.0;
                    for (part, taken) in ambient[index].iter().enumerate() {
                        lost += factors[QUADRATIC + part] * f64::from(*taken);
                    }
                    for (lamp, (taken, lit)) in taken.iter().zip(&lit).enumerate() {
                        let share = factors[FIRST_LAMP + lamp];
                        unshadowed += share * (lit[index] - 1.0);
                        lost += share * lit[index] * f64::from(taken[index]);
                    }
                    #[allow(clippy::cast_possible_truncation, reason = "a ratio, to 7 digits")]
                    let ratio = (1.0 - lost / unshadowed.max(LEAST_UNSHADOWED)) as f32;
                    ratio
                })
            })
        };
        (0..pixels.len()).map(ratio).collect()
    }
}
