//! The pixels that things certainly show.

use glam::IVec2;

use super::groups::cross;
use super::grown::Grown;
use crate::lights::{Compared, Comparison};
use app_scene::scene::MAX_RECEIVERS;

/// Least pixels of a thing, in the level, for a search of its plane.
const LEAST_PIXELS: usize = 300;
/// Largest noise of a pixel that counts, in plates.
const NOISIEST: f32 = 0.2;

/// Pixels with little noise.
pub(super) fn certain(comparison: &Comparison) -> impl Iterator<Item = &Compared> {
    comparison.pixels.iter().filter(|pixel| pixel.noise() < NOISIEST)
}

/// The inner pixels of a thing, row by row.
pub(super) fn pixels<'a>(comparison: &'a Comparison, grown: &Grown, thing: usize) -> Vec<&'a Compared> {
    let is_within = |at: IVec2| cross(at, 1).all(|at| grown.of_pixel(at) == Some(thing));
    certain(comparison).filter(|pixel| is_within(pixel.at)).collect()
}

/// The receiver behind most of the pixels; `None` for too few pixels.
pub(super) fn most_on(pixels: &[&Compared]) -> Option<usize> {
    if pixels.len() < LEAST_PIXELS {
        return None;
    }
    let mut counts = [0; MAX_RECEIVERS];
    for pixel in pixels {
        if let Some(count) = counts.get_mut(pixel.on) {
            *count += 1;
        }
    }
    (0..counts.len()).max_by_key(|on| counts[*on])
}
