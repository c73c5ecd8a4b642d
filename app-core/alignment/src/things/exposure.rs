//! Exposure of the frame over that of the plate.

use crate::lights::Compared;
use crate::median::median;
use crate::picture::{Color, Level};

/// Exposure of the frame over that of the plate, for each channel.
pub(super) fn gains(level: &Level, compared: &[Compared]) -> Option<Color> {
    let of = |channel: usize| gain(level, compared, |color| color[channel]);
    Some([of(0)?, of(1)?, of(2)?])
}

/// The same for one value of their colours.
pub(super) fn gain(level: &Level, compared: &[Compared], value: impl Fn(&Color) -> f32) -> Option<f32> {
    let of = |pixel: &Compared| {
        let frame = value(&level.frame.get(pixel.at)?);
        let plate = value(&level.plate.as_ref()?.get(pixel.at)?);
        let gain = frame / (plate * value(&pixel.ratio));
        gain.is_finite().then_some(gain)
    };
    median(compared.iter().filter_map(of), f32::total_cmp)
}
