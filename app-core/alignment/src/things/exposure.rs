//! Exposure of the frame over that of the plate.

use glam::IVec2;

use super::codes::Codes;
use crate::lights::Compared;
use crate::median::median;
use crate::picture::{Color, Level, Picture};

/// Largest difference of an exposure from 1 that may be the error of its estimate. Of equal exposures .9967 to
/// .9997 were estimated, and half a code of a mean grey is .9 %.
const SAME_EXPOSURE: f32 = 0.01;

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

/// For each channel, by the median of some pixels of two pictures that were not compared: most of them
/// are in no shadow. `None` if none of them is bright in both.
pub(super) fn gains_at(at: impl Iterator<Item = IVec2>, [frame, plate]: [&Picture; 2]) -> Option<Color> {
    let ratio = |at: IVec2| {
        let [frame, plate] = [frame.get(at)?, plate.get(at)?];
        let ratio = [0, 1, 2].map(|channel| frame[channel] / plate[channel]);
        let is_known = ratio.iter().all(|ratio| ratio.is_finite() && *ratio > 0.0);
        is_known.then_some(ratio)
    };
    let ratios: Vec<Color> = at.filter_map(ratio).collect();
    let of = |channel: usize| median(ratios.iter().map(|ratio| ratio[channel]), f32::total_cmp);
    Some([of(0)?, of(1)?, of(2)?])
}

/// A level's plate at the frame's exposure; `None` without a plate. `of_exposure` is the level in which pixels were
/// compared.
pub(super) fn plate_codes(level: &Level, of_exposure: &Level, compared: &[Compared]) -> Option<Codes> {
    let gains = gains(of_exposure, compared).unwrap_or([1.0; 3]);
    let are_same = gains.iter().all(|gain| (gain - 1.0).abs() <= SAME_EXPOSURE);
    let gains = if are_same { [1.0; 3] } else { gains };
    Some(Codes::exposed(level.plate.as_ref()?, gains))
}
