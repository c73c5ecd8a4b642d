//! The shadows of lamps in one level of the pictures.

use glam::{DVec2, IVec2};

use super::background::{Background, REACH};
use super::cast::{Ambient, Caster};
use super::lamp::{Lamp, disc};
use super::prior::Prior;
use super::receiver_pixels::{ReceiverPixel, receiver_pixels};
use super::shading::{Shaded, Shading};
use crate::picture::Level;
use crate::raster::{Rasterizer, project};
use crate::receivers::SeenReceiver;
use crate::shape::Shape;

/// Scale of robust weights, in standard deviations: while lights may be far off, and later.
pub(super) const ROBUST_FAR: f64 = 30.0;
pub(super) const ROBUST_NEAR: f64 = 8.0;
/// Width of every penumbra, in pixels of a level, above which a larger level adds no information.
pub(super) const WIDE_PENUMBRA_PX: f64 = 5.0;
/// Side of the cells, in pixels of a level, in which a toy's points are merged for a search of directions
/// there: no finer than the level shows it.
pub(super) const CELL_PX: f64 = 0.5;
/// Number of pixels beside the toy that an estimate needs.
pub(super) const LEAST_PIXELS: usize = 100;
/// Width of a penumbra below which the lamp's size is unconstrained, in pixels.
pub(super) const LEAST_PENUMBRA_PX: f64 = 0.6;
/// Number of directions of ambient light.
const N_DIRECTIONS: usize = 128;
/// Margin around the shadows, in pixels of a level.
const AROUND_PX: i32 = 16;
/// Shift of shadows by the last step, in pixels.
const LAST_STEP_PX: f64 = 0.02;
/// Number of points over a lamp, and a smaller one while lamps are counted.
const LEAST_POINTS: f64 = 8.0;
const MOST_POINTS: f64 = 40.0;
const MOST_ROUGH_POINTS: f64 = 16.0;
/// Lower bound of the light on the place without a toy, relative to that at the toy's foot.
const LEAST_UNSHADOWED: f32 = 0.05;
/// Growth of lamps for the region, so that growing shadows stay inside.
const GROWN: f64 = 1.5;

/// The shadows in one level.
pub(super) struct Shadows<'a> {
    pub(super) caster: Caster<'a>,
    pub(super) pixels: Vec<ReceiverPixel>,
    pub(super) ambient: Vec<Ambient>,
    /// Light on the place without a toy, relative to that at the toy's foot.
    unshadowed: Vec<f32>,
    /// Whether a plate shows the receivers without the toy.
    pub(super) has_plate: bool,
    /// Whether lamps are only counted here: with fewer points, and one-sided differences.
    pub(super) is_rough: bool,
    /// Approximate shift of the shadow of the toy's top per radian of a light's turn.
    pub(super) px_per_rad: f64,
}

impl<'a> Shadows<'a> {
    /// All of a level's receiver pixels, or those around the shadows of `lamps`.
    pub(super) fn new(
        raster: &mut Rasterizer,
        (shape, receivers): (&'a Shape, &'a [SeenReceiver]),
        level: &Level,
        lamps: Option<&[Lamp]>,
    ) -> Self {
        let rect = lamps.map(|lamps| Self::around(raster, (shape, receivers), level, lamps));
        Self::within(raster, (shape, receivers), level, rect)
    }

    /// The pixels around the shadows of lamps, as the first and the last; empty if there is no
    /// shadow in the picture.
    pub(super) fn around(
        raster: &mut Rasterizer,
        (shape, receivers): (&Shape, &[SeenReceiver]),
        level: &Level,
        lamps: &[Lamp],
    ) -> [IVec2; 2] {
        let caster = Caster::new(shape, receivers, level.intrinsics, level.frame.size_px);
        shadow_rect(raster, &caster, lamps)
    }

    /// All of a level's receiver pixels, or those within a rectangle.
    pub(super) fn within(
        raster: &mut Rasterizer,
        (shape, receivers): (&'a Shape, &'a [SeenReceiver]),
        level: &Level,
        rect: Option<[IVec2; 2]>,
    ) -> Self {
        let size_px = level.frame.size_px;
        let corners = project(shape.points.iter().copied(), &level.intrinsics);
        let coverage = raster.coverage(&corners, &shape.faces, size_px);
        let is_wanted =
            |at: IVec2| rect.is_none_or(|[low, high]| at.cmpge(low).all() && at.cmple(high).all());
        let around = (shape.centre, REACH * shape.radius_m);
        let has_plate = level.plate.is_some();
        let background = (!has_plate).then(|| Background::of(level, &coverage, receivers, around));
        let pixels = receiver_pixels(
            level,
            (&coverage, background.as_ref()),
            receivers,
            around,
            is_wanted,
        );
        let shadows = Self::of((shape, receivers), level, (pixels, Vec::new()));
        Self {
            ambient: shadows.caster.ambient(raster, &shadows.pixels, N_DIRECTIONS),
            ..shadows
        }
    }

    /// Receiver pixels of a level, with the ambient light that the toy blocks there.
    pub(super) fn of(
        (shape, receivers): (&'a Shape, &'a [SeenReceiver]),
        level: &Level,
        (pixels, ambient): (Vec<ReceiverPixel>, Vec<Ambient>),
    ) -> Self {
        let caster = Caster::new(shape, receivers, level.intrinsics, level.frame.size_px);
        Self {
            ambient,
            caster: caster.softened(level.softened_px),
            has_plate: level.plate.is_some(),
            is_rough: false,
            unshadowed: vec![1.0; pixels.len()],
            pixels,
            px_per_rad: level.intrinsics.fx_px * shape.radius_m / shape.centre.length(),
        }
    }

    /// The fraction of uniform ambient light that the toy blocks at a pixel.
    pub(super) fn ambient_taken(&self, index: usize) -> f32 {
        self.ambient[index][0]
    }

    /// Approximate width of the widest penumbra.
    pub(super) fn penumbra_px(&self, lamp: &Lamp) -> f64 {
        2.0 * lamp.spread * self.px_per_rad
    }

    /// Moves lamps step by step until they converge; `None` if they are unconstrained.
    pub(super) fn rounds(
        &self,
        raster: &mut Rasterizer,
        (lamps, priors): (&mut [Lamp], &[Prior]),
        (n_rounds, robust): (usize, f64),
    ) -> Option<()> {
        for _ in 0..n_rounds {
            let before = lamps.to_vec();
            self.step(raster, lamps, priors, robust)?;
            self.widen(lamps);
            let moved_px = before.iter().zip(&*lamps).map(|(before, lamp)| {
                let nearing =
                    (lamp.inverse_distance - before.inverse_distance).abs() * self.caster.shape.radius_m;
                let turned_rad = lamp.direction.angle_between(before.direction);
                (turned_rad + nearing + (lamp.spread - before.spread).abs()) * self.px_per_rad
            });
            if moved_px.fold(0.0, f64::max) < LAST_STEP_PX {
                break;
            }
        }
        Some(())
    }

    /// Widens lamps whose penumbra is too narrow to measure.
    fn widen(&self, lamps: &mut [Lamp]) {
        for lamp in lamps {
            lamp.spread = lamp.spread.max(0.5 * LEAST_PENUMBRA_PX / self.px_per_rad);
        }
    }

    /// Points over a lamp, whose number grows with its penumbra and with the picture's blur.
    pub(super) fn disc(&self, lamp: &Lamp) -> Vec<DVec2> {
        let most = if self.is_rough {
            MOST_ROUGH_POINTS
        } else {
            MOST_POINTS
        };
        // A disc's deviation along each axis is a quarter of its width.
        let soft_px = self.penumbra_px(lamp).hypot(4.0 * self.caster.softness_px);
        #[allow(clippy::cast_possible_truncation, reason = "clamped")]
        let n_points = soft_px.powi(2).clamp(LEAST_POINTS, most) as usize;
        disc(n_points)
    }

    pub(super) fn taken(&self, raster: &mut Rasterizer, lamp: &Lamp, disc: &[DVec2]) -> Vec<f32> {
        self.taken_by(raster, &self.caster, lamp, disc)
    }

    fn taken_by(
        &self,
        raster: &mut Rasterizer,
        caster: &Caster<'_>,
        lamp: &Lamp,
        disc: &[DVec2],
    ) -> Vec<f32> {
        let mut taken = caster.lamp(raster, &self.pixels, lamp, disc);
        let lit = self.caster.lit(&self.pixels, lamp);
        for ((taken, lit), unshadowed) in taken.iter_mut().zip(lit).zip(&self.unshadowed) {
            *taken *= lit / unshadowed;
        }
        taken
    }

    /// Sets the light on each receiver without a toy to that of lamps with a shading's shares, and
    /// a uniform rest.
    pub(super) fn light(&mut self, lamps: &[Lamp], shading: &Shading) {
        let shares: Vec<Vec<f64>> = (0..shading.factors.len())
            .map(|receiver| {
                (0..lamps.len())
                    .map(|lamp| shading.share(receiver, lamp))
                    .collect()
            })
            .collect();
        let mut unshadowed = vec![1.0; self.pixels.len()];
        for (index, lamp) in lamps.iter().enumerate() {
            let lit = self.caster.lit(&self.pixels, lamp);
            for ((unshadowed, lit), pixel) in unshadowed.iter_mut().zip(lit).zip(&self.pixels) {
                #[allow(clippy::cast_possible_truncation, reason = "a part of one")]
                let share = shares[pixel.receiver][index].clamp(0.0, 1.0) as f32;
                *unshadowed += share * (lit - 1.0);
            }
        }
        for ((ambient, now), before) in self.ambient.iter_mut().zip(&mut unshadowed).zip(&self.unshadowed) {
            *now = now.max(LEAST_UNSHADOWED);
            *ambient = ambient.map(|ambient| ambient * before / *now);
        }
        self.unshadowed = unshadowed;
    }

    /// The fraction of each lamp that a toy of another shape in the same place blocks.
    pub(super) fn taken_of_shape(
        &self,
        raster: &mut Rasterizer,
        shape: &Shape,
        lamps: &[Lamp],
    ) -> Vec<Vec<f32>> {
        let caster = self.caster.of_shape(shape);
        let taken = lamps
            .iter()
            .map(|lamp| self.taken_by(raster, &caster, lamp, &self.disc(lamp)));
        taken.collect()
    }

    /// The blocked fraction of each lamp.
    pub(super) fn taken_of_all(&self, raster: &mut Rasterizer, lamps: &[Lamp]) -> Vec<Vec<f32>> {
        let taken = lamps
            .iter()
            .map(|lamp| self.taken(raster, lamp, &self.disc(lamp)));
        taken.collect()
    }

    pub(super) fn shaded<'b>(&'b self, lamps: &'b [Vec<f32>]) -> Shaded<'b> {
        Shaded {
            pixels: &self.pixels,
            ambient: &self.ambient,
            lamps,
        }
    }

    pub(super) fn shading(&self, raster: &mut Rasterizer, lamps: &[Lamp], robust: f64) -> Shading {
        let taken = self.taken_of_all(raster, lamps);
        self.shaded(&taken).fit(self.caster.receivers.len(), robust)
    }
}

/// The pixels around the shadows of lamps, as the first and the last; empty if there is no shadow
/// in the picture.
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
