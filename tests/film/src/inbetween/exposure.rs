//! Exposure of a key's photograph relative to the reference, from the table outside of toy and
//! shadow.

use super::blend::Reference;
use super::keys::median;
use super::light::{LightPicture, smoothed};

/// Distance of usable pixels from toy and shadows, as a fraction of the picture's width: the toy
/// occludes light all around it. The largest distance that leaves enough pixels is used.
const CLEAR_OF: [usize; 3] = [8, 16, 64];
/// The inverse of the share of pixels that is enough.
const ENOUGH: usize = 50;
/// Reach of the compared averages.
const REACH_PX: usize = 1;
/// Light that is neither clipped nor mostly rounding.
const USABLE: std::ops::RangeInclusive<f32> = 0.004..=0.93;
/// Smaller changes are ignored.
const LEAST_CHANGE: f64 = 0.004;

/// Pixels of the table far from everything.
pub(super) struct Clear(Vec<bool>);

impl Clear {
    /// Pixels clear of touched ones in a picture and in the reference.
    #[must_use]
    pub(super) fn new(touched: &[bool], reference: &Reference, [width_px, height_px]: [usize; 2]) -> Self {
        let own = reference.touched.as_deref();
        let is_touched = |pixel: usize| touched[pixel] || own.is_some_and(|own| own[pixel]);
        let values: Vec<[f32; 1]> = (0..touched.len())
            .map(|pixel| [if is_touched(pixel) { 1.0 } else { 0.0 }])
            .collect();
        let mut clear = Vec::new();
        for part in CLEAR_OF {
            let reach_px = width_px / part / 3;
            let near = smoothed(values.clone(), width_px, reach_px);
            clear = near.into_iter().map(|[near]| near < 1e-6).collect();
            let n_clear = clear.iter().filter(|is_clear| **is_clear).count();
            if n_clear * ENOUGH > width_px * height_px {
                break;
            }
        }
        Self(clear)
    }
}

/// Factors per channel that make a picture as bright as another; 1 if nothing can be compared, or
/// if all differences are below the accuracy.
#[must_use]
pub(super) fn gains(picture: &LightPicture, reference: &LightPicture, clear: &Clear) -> [f64; 3] {
    let [ours, theirs] =
        [picture, reference].map(|picture| smoothed(picture.rgb.clone(), picture.width_px, REACH_PX));
    let of_channel = |channel: usize| {
        let pixels = ours
            .iter()
            .zip(&theirs)
            .zip(&clear.0)
            .filter(|(_, is_clear)| **is_clear);
        let lights = pixels.map(|((ours, theirs), _)| [ours[channel], theirs[channel]]);
        let usable = lights.filter(|lights| lights.iter().all(|light| USABLE.contains(light)));
        let ratios: Vec<f64> = usable.map(|[ours, theirs]| f64::from(theirs / ours)).collect();
        if ratios.is_empty() { 1.0 } else { median(ratios) }
    };
    let gains = [0, 1, 2].map(of_channel);
    if gains.iter().all(|gain| (gain - 1.0).abs() < LEAST_CHANGE) {
        [1.0; 3]
    } else {
        gains
    }
}
