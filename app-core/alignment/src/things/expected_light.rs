//! The light that the table beside a thing is expected to have, with the toy's shadow in it.

use glam::IVec2;

use super::groups::{in_level, most_around};
use crate::lights::Compared;
use crate::picture::{Level, brightness, index_in};

/// Light over the expected one, with the toy's shadow, from which on a pixel is not in the shadow of a
/// hand, or is in the outer half of its penumbra. With .5, .65 and .8 of a pixel of the level of the
/// search the shadow's RMS error is 11.50, 11.53 and 11.60 codes beside a hand around a llama's legs, and
/// 3.26, 3.26 and 3.24 beside one around a figure's; with .65 of a pixel of the largest level 11.50 and
/// 3.26, and with all beside a hand as its shadow 12.60 and 4.94.
const LIT: f32 = 0.65;

/// The light of a level's pixels, beside the largest level.
pub(super) struct ExpectedLight<'a> {
    largest: &'a Level,
    size_px: IVec2,
    /// Pixels of the level per pixel of the largest one.
    per_px: f64,
    /// Brightness of the frame over the plate; NaN where it is unknown.
    ratio: Vec<f32>,
}

impl<'a> ExpectedLight<'a> {
    /// `gain` is the exposure of the frame over that of the plate.
    pub(super) fn new(
        largest: &'a Level,
        (level, per_px): (&Level, f64),
        (compared, gain): (&[Compared], f32),
    ) -> Self {
        let size_px = level.frame.size_px;
        let ratio = |pixel: &Compared| gain * brightness(&pixel.model);
        Self {
            largest,
            size_px,
            per_px,
            ratio: in_level(size_px, compared, f32::NAN, ratio),
        }
    }

    /// Whether most pixels around one have about that light.
    pub(super) fn is_about_at(&self, at: IVec2) -> bool {
        most_around(at, |at| self.is_reached(at))
    }

    fn is_reached(&self, at: IVec2) -> bool {
        let there = ((at.as_dvec2() + 0.5) * self.per_px).floor().as_ivec2();
        let ratio = index_in(self.size_px, there).map(|index| self.ratio[index]);
        let frame = self.largest.frame.get(at);
        let plate = self.largest.plate.as_ref().and_then(|plate| plate.get(at));
        let light = ratio.zip(frame.zip(plate));
        light.is_some_and(|(ratio, (frame, plate))| brightness(&frame) > LIT * ratio * brightness(&plate))
    }
}
