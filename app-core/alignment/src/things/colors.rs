//! Likelihoods of the plate's colours as colours of an object, and of the receiver.

use super::codes::Codes;
use crate::median::median;
use crate::picture::Color;

/// Bins along each channel.
const SIDE: usize = 24;
/// Share that is assumed for a colour that never occurred.
const UNSEEN: f32 = 2e-5;

/// Difference in frequency between a place's usual colours and its rare ones, as a logarithm.
const RARE: f32 = 3.0;

/// Histograms of both, blurred by a bin.
#[derive(Clone, Debug, Default)]
pub(super) struct Colors {
    /// Log of a colour's likelihood ratio for an object; empty bins where nothing is known.
    likelier: Vec<f32>,
    /// Shares of the place's colours.
    of_place: Vec<f32>,
    /// The share of its median colour.
    usual: f32,
}

impl Colors {
    /// The model for colours of objects and of the place.
    pub(super) fn of(things: impl Iterator<Item = Color>, place: impl Iterator<Item = Color>) -> Self {
        let [things, receivers] = [histogram(things), histogram(place)];
        let (Some(things), Some(receivers)) = (things, receivers) else {
            return Self::default();
        };
        let both = things.iter().zip(&receivers);
        let mut usual: Vec<f32> = receivers.iter().copied().filter(|part| *part > 0.0).collect();
        usual.sort_unstable_by(f32::total_cmp);
        Self {
            usual: weighted_median(&usual),
            likelier: both
                .map(|(thing, receiver)| ((thing + UNSEEN) / (receiver + UNSEEN)).ln())
                .collect(),
            of_place: receivers,
        }
    }

    /// The share of a colour in the place.
    pub(super) fn part_of_place(&self, color: Color) -> f32 {
        bin(color)
            .and_then(|bin| self.of_place.get(bin).copied())
            .unwrap_or(0.0)
    }

    /// Logarithm by which a colour is rarer than the place's rare ones; 0 for those and for all
    /// more frequent ones.
    pub(super) fn unusual(&self, color: Color) -> f32 {
        ((self.usual / (self.part_of_place(color) + UNSEEN)).ln() - RARE).max(0.0)
    }

    /// Median over pixels of a picture; 0 if none of them is known.
    pub(super) fn median(&self, picture: &Codes, pixels: &[usize]) -> f32 {
        let likelier = pixels
            .iter()
            .filter_map(|index| self.likelier(picture.pixels[*index]));
        median(likelier, f32::total_cmp).unwrap_or(0.0)
    }

    /// `None` if neither the colour nor a similar one is known.
    pub(super) fn likelier(&self, color: Color) -> Option<f32> {
        self.likelier.get(bin(color)?).copied()
    }
}

/// For sorted shares of 1: the share below which half of the total lies.
fn weighted_median(sorted: &[f32]) -> f32 {
    let half = 0.5 * sorted.iter().sum::<f32>();
    let mut sum = 0.0;
    let beyond = sorted.iter().find(|part| {
        sum += **part;
        sum >= half
    });
    beyond.copied().unwrap_or(1.0)
}

fn bin(color: Color) -> Option<usize> {
    if color[0].is_nan() {
        return None;
    }
    let along = color.map(|code| {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the bins"
        )]
        let along = (code / 256.0 * SIDE as f32).clamp(0.0, (SIDE - 1) as f32) as usize;
        along
    });
    Some((along[0] * SIDE + along[1]) * SIDE + along[2])
}

/// Shares of 1; `None` without any colour.
fn histogram(colors: impl Iterator<Item = Color>) -> Option<Vec<f32>> {
    let mut bins = vec![0.0_f32; SIDE * SIDE * SIDE];
    let mut n_pixels = 0.0;
    for bin in colors.filter_map(bin) {
        bins[bin] += 1.0;
        n_pixels += 1.0;
    }
    if n_pixels == 0.0 {
        return None;
    }
    for stride in [1, SIDE, SIDE * SIDE] {
        bins = blurred(&bins, stride);
    }
    Some(bins.into_iter().map(|bin| bin / n_pixels).collect())
}

/// Blur by a binomial of three along one channel.
fn blurred(bins: &[f32], stride: usize) -> Vec<f32> {
    let along = |bin: usize| bin / stride % SIDE;
    let before = |bin: usize| {
        if along(bin) > 0 {
            bins[bin - stride]
        } else {
            bins[bin]
        }
    };
    let after = |bin: usize| {
        if along(bin) + 1 < SIDE {
            bins[bin + stride]
        } else {
            bins[bin]
        }
    };
    (0..bins.len())
        .map(|bin| 0.25 * before(bin) + 0.5 * bins[bin] + 0.25 * after(bin))
        .collect()
}
