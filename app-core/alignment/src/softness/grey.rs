//! A picture with one number per pixel, and its blurs.

use glam::{DVec2, IVec2};

use crate::picture::taps_of;
use app_scene::sharpness::Spread;

/// Initial blur of both pictures, in pixels, so that noise of single pixels counts little.
pub(super) const SMOOTHED_PX: f64 = 1.0;
/// Blur of pictures whose ratio is taken, in pixels.
pub(super) const RATIO_PX: f64 = 3.0;
/// Squared correlation of photograph and plate that a measurement must reach.
pub(super) const CORRELATION: f64 = 0.8;
/// Largest variance, in square pixels.
pub(super) const MOST_PX2: f64 = 16.0;

/// A blur with these variances along the axes of another.
pub(super) fn with_variances(spread: Spread, [wide, narrow]: [f64; 2]) -> Spread {
    let apart = spread.xx_px2 - spread.yy_px2;
    let along = DVec2::from_angle(0.5 * (2.0 * spread.xy_px2).atan2(apart));
    let (xx, xy, yy) = (along.x * along.x, along.x * along.y, along.y * along.y);
    Spread {
        xx_px2: wide * xx + narrow * yy,
        xy_px2: (wide - narrow) * xy,
        yy_px2: wide * yy + narrow * xx,
    }
}

/// A picture with one number per pixel.
#[derive(Clone)]
pub(super) struct Grey {
    pub(super) size_px: IVec2,
    pub(super) values: Vec<f32>,
}

impl Grey {
    pub(super) fn width(&self) -> usize {
        self.size_px.x as usize
    }

    /// The nearest row.
    fn row(&self, y: i32) -> &[f32] {
        let from = y.clamp(0, self.size_px.y - 1) as usize * self.width();
        &self.values[from..from + self.width()]
    }

    /// The weighted sum of the pixels at these offsets from each, or of the nearest ones beyond the
    /// border. Row by row, since most of the time of a measurement is spent here.
    pub(super) fn taking(&self, taps: &[(IVec2, f32)]) -> Self {
        let mut values = vec![0.0; self.values.len()];
        for (offset, weight) in taps {
            for (y, sums) in (0..).zip(values.chunks_exact_mut(self.width())) {
                add_row(sums, self.row(y + offset.y), offset.x, *weight);
            }
        }
        Self {
            size_px: self.size_px,
            values,
        }
    }

    pub(super) fn difference(&self, direction: IVec2) -> Self {
        self.taking(&[(direction, 1.0), (-direction, -1.0)])
    }

    /// Blurs along one axis, then along the other.
    pub(super) fn spread(&self, spread: Spread) -> Self {
        let [first, second] = taps_of(spread);
        self.taking(&first).taking(&second)
    }
}

/// Adds the pixels of a row to those `offset` before them, and the last one at that end beyond it.
fn add_row(sums: &mut [f32], from: &[f32], offset: i32, weight: f32) {
    let n_beyond = (offset.unsigned_abs() as usize).min(from.len());
    let n_within = from.len() - n_beyond;
    let (within, beyond, taken, nearest) = if offset >= 0 {
        let (within, beyond) = sums.split_at_mut(n_within);
        (within, beyond, &from[n_beyond..], from.last())
    } else {
        let (beyond, within) = sums.split_at_mut(n_beyond);
        (within, beyond, &from[..n_within], from.first())
    };
    for (sum, value) in within.iter_mut().zip(taken) {
        *sum += weight * value;
    }
    if let Some(nearest) = nearest {
        beyond.iter_mut().for_each(|sum| *sum += weight * nearest);
    }
}
