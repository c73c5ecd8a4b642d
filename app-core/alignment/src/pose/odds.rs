//! The log odds of toy and surroundings for each pixel, by the colours under a first guess of the
//! outline.

use glam::IVec2;

use crate::picture::{Color, Level, index_in, places};
use crate::raster::Coverage;

/// Linear light below which differences are noise.
const FLOOR: f32 = 0.004;
/// Width of a histogram's bin, in natural logarithms of light.
const BIN: f32 = 0.15;
const N_BINS: i32 = 48;
/// Lowest logarithm of a colour: the floor's.
const LOWEST_COLOR: f32 = -5.6;
/// Lowest logarithm of a frame over its plate.
const LOWEST_RATIO: f32 = -4.5;
/// Fraction of all pixels that may have any colour, and its number of bins.
const ANY_COLOR: f32 = 0.02;
const N_LIKELY_BINS: f32 = 2000.0;
/// Largest absolute log odds of a single pixel.
const MOST: f32 = 4.0;

/// Logarithm of the odds that a pixel shows the toy, over a rectangle of the picture.
pub(super) struct Odds {
    origin_px: IVec2,
    size_px: IVec2,
    values: Vec<f32>,
}

impl Odds {
    /// Learns the toy's colours inside the outline, and the surroundings' beside it: as ratios to
    /// the plate if there is one, which are the same on any pattern.
    pub(super) fn learn(level: &Level, coverage: &Coverage, margin_px: i32) -> Self {
        let from = (coverage.origin_px - margin_px).max(IVec2::ZERO);
        let to = (coverage.origin_px + coverage.size_px + margin_px).min(level.frame.size_px);
        let pixels = || places(to - from).map(|place| from + place);
        let mut toy = Histogram::new(LOWEST_COLOR);
        let mut rest = Histogram::new(if level.plate.is_some() {
            LOWEST_RATIO
        } else {
            LOWEST_COLOR
        });
        for at in pixels() {
            let Some((color, ratio)) = logarithms(level, at) else {
                continue;
            };
            if coverage.at(at) > 0.5 {
                toy.add(color);
            } else {
                rest.add(ratio);
            }
        }
        let (toy, rest) = (toy.blurred(), rest.blurred());
        let odds = |at| {
            let (color, ratio) = logarithms(level, at)?;
            let odds = toy.density(color) / rest.density(ratio);
            Some(odds.ln().clamp(-MOST, MOST))
        };
        Self {
            origin_px: from,
            size_px: to - from,
            values: pixels().map(|at| odds(at).unwrap_or(0.0)).collect(),
        }
    }

    /// Log odds of one pixel; 0 if unknown.
    pub(super) fn at(&self, at: IVec2) -> f32 {
        let value = index_in(self.size_px, at - self.origin_px).and_then(|index| self.values.get(index));
        value.copied().unwrap_or(0.0)
    }
}

/// Logarithms of a pixel's colour, and of its ratio to the plate, or again of its colour without a
/// plate.
pub(super) fn logarithms(level: &Level, at: IVec2) -> Option<(Color, Color)> {
    let log = |color: Color| color.map(|value| (value.max(0.0) + FLOOR).ln());
    let color = log(level.frame.get(at)?);
    let Some(plate) = &level.plate else {
        return Some((color, color));
    };
    let plate = log(plate.get(at)?);
    Some((color, [0, 1, 2].map(|channel| color[channel] - plate[channel])))
}

/// A density over three logarithms.
struct Histogram {
    lowest: f32,
    counts: Vec<f32>,
    n: f32,
}

impl Histogram {
    fn new(lowest: f32) -> Self {
        Self {
            lowest,
            counts: vec![0.0; (N_BINS * N_BINS * N_BINS) as usize],
            n: 0.0,
        }
    }

    fn bin(&self, color: Color) -> usize {
        #[allow(clippy::cast_possible_truncation, reason = "clamped to the bins")]
        let [r, g, b] = color.map(|value| (((value - self.lowest) / BIN) as i32).clamp(1, N_BINS - 2));
        ((r * N_BINS + g) * N_BINS + b) as usize
    }

    fn add(&mut self, color: Color) {
        let bin = self.bin(color);
        self.counts[bin] += 1.0;
        self.n += 1.0;
    }

    /// Blurred by a triangle over three bins along each channel.
    fn blurred(mut self) -> Self {
        for stride in [1, N_BINS, N_BINS * N_BINS] {
            let stride = stride as usize;
            let sharp = self.counts.clone();
            for bin in stride..sharp.len() - stride {
                self.counts[bin] = 0.5 * sharp[bin] + 0.25 * (sharp[bin - stride] + sharp[bin + stride]);
            }
        }
        self
    }

    fn density(&self, color: Color) -> f32 {
        let seen = self.counts[self.bin(color)] / self.n.max(1.0);
        (1.0 - ANY_COLOR) * seen + ANY_COLOR / N_LIKELY_BINS
    }
}
