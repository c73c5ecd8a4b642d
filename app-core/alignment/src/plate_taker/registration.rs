//! Registers two pictures from almost the same place, and finds changes between them.
//!
//! Source: Lucas and Kanade 1981; Baker and Matthews 2004 (inverse compositional), with robust
//! weights.

use nalgebra::{SMatrix, SVector};

use super::reduced::Reduced;
use crate::median::{DEVIATION_OF_MEDIAN_32, median};

/// Number of unknowns: shift along both axes, turn, zoom; gain and offset of the codes.
const N_UNKNOWN: usize = 6;
const N_ITERATIONS: usize = 3;
/// Side of a tile, in squares of the reduced picture.
const TILE: usize = 4;
/// Residual per gradient: after a shift, edges fall differently on the squares.
const OF_GRADIENT: f32 = 0.25;
/// Smallest difference in codes that counts as a change, whatever the noise.
const LEAST_CODES: f32 = 4.0;
/// The same for the mean over a tile.
const LEAST_MEAN_CODES: f32 = 2.5;
/// Fraction of a tile that must differ.
const OF_TILE: f32 = 0.4;

/// The registration of two pictures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Registration {
    /// Largest shift of a corner, in pixels of the picture.
    pub(super) moved_px: f64,
    /// Mean code of the second picture over that of the first.
    pub(super) gain: f64,
    /// Fraction of changed tiles.
    pub(super) changed: f64,
}

/// Registers pictures of one size; `None` for two sizes.
pub(super) fn register(one: &Reduced, other: &Reduced) -> Option<Registration> {
    if one.size != other.size {
        return None;
    }
    let fit = Fit::new(one);
    let mut unknown = SVector::<f32, N_UNKNOWN>::zeros();
    let mut residuals = fit.residuals(other, &unknown);
    for _ in 0..N_ITERATIONS {
        unknown += fit.step(&residuals)?;
        residuals = fit.residuals(other, &unknown);
    }
    let corner = |[x, y]: [f32; 2]| {
        let [x, y] = fit.moved(&unknown, [x, y]);
        f64::from(x.hypot(y))
    };
    let moved = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(corner);
    let registration = Registration {
        moved_px: to_px(moved.into_iter().fold(0.0, f64::max), one.factor),
        gain: fit.gain(&unknown),
        changed: fit.changed(&residuals),
    };
    let is_finite = registration.moved_px.is_finite() && registration.gain.is_finite();
    is_finite.then_some(registration)
}

fn to_px(squares: f64, factor: usize) -> f64 {
    squares * factor as f64
}

/// The reference picture.
struct Fit<'a> {
    one: &'a Reduced,
    /// Change per square along rows and columns; zero at the border.
    gradients: Vec<[f32; 2]>,
    middle: [f32; 2],
}

impl<'a> Fit<'a> {
    fn new(one: &'a Reduced) -> Self {
        let [columns, rows] = one.size;
        let mut gradients = vec![[0.0; 2]; columns * rows];
        for y in 1..rows - 1 {
            for x in 1..columns - 1 {
                let at = y * columns + x;
                let across = [one.luma[at - 1], one.luma[at + 1]];
                let down = [one.luma[at - columns], one.luma[at + columns]];
                gradients[at] = [across, down].map(|[before, after]| 0.5 * (after - before));
            }
        }
        Self {
            one,
            gradients,
            middle: one.size.map(|side| 0.5 * (side - 1) as f32),
        }
    }

    /// Place from -1 to 1 along the longer side.
    fn place(&self, at: usize) -> [f32; 2] {
        let columns = self.one.size[0];
        let half = self.middle[0].max(self.middle[1]);
        let [x, y] = [at % columns, at / columns].map(|place| place as f32);
        [(x - self.middle[0]) / half, (y - self.middle[1]) / half]
    }

    /// Shift of a place, in squares.
    fn moved(&self, unknown: &SVector<f32, N_UNKNOWN>, [x, y]: [f32; 2]) -> [f32; 2] {
        [
            unknown[0] - unknown[2] * y + unknown[3] * x,
            unknown[1] + unknown[2] * x + unknown[3] * y,
        ]
    }

    /// With little texture, gain and offset are ambiguous, but their combination is not.
    fn gain(&self, unknown: &SVector<f32, N_UNKNOWN>) -> f64 {
        let sum: f64 = self.one.luma.iter().map(|luma| f64::from(*luma)).sum();
        let mean = sum / self.one.luma.len() as f64;
        let change = f64::from(unknown[4]) * mean + f64::from(unknown[5]);
        // A code is the least that pictures differ by.
        1.0 + change / mean.max(1.0)
    }

    /// Residual of each square; `None` outside of the second picture.
    fn residuals(&self, other: &Reduced, unknown: &SVector<f32, N_UNKNOWN>) -> Vec<Option<f32>> {
        let columns = self.one.size[0];
        let residual = |(at, luma): (usize, &f32)| {
            let moved = self.moved(unknown, self.place(at));
            let seen = sample(
                other,
                [(at % columns) as f32 + moved[0], (at / columns) as f32 + moved[1]],
            )?;
            Some(seen - luma - unknown[4] * luma - unknown[5])
        };
        self.one.luma.iter().enumerate().map(residual).collect()
    }

    /// Spread of the residuals: a median absolute deviation, at least a third of a code.
    fn spread(&self, residuals: &[Option<f32>]) -> f32 {
        let sizes = residuals.iter().flatten().map(|residual| residual.abs());
        let spread = |median: f32| (DEVIATION_OF_MEDIAN_32 * median).max(0.3);
        median(sizes, f32::total_cmp).map_or(1.0, spread)
    }

    /// The step of the unknowns that reduces the residuals.
    fn step(&self, residuals: &[Option<f32>]) -> Option<SVector<f32, N_UNKNOWN>> {
        let spread = self.spread(residuals);
        let mut normal = SMatrix::<f32, N_UNKNOWN, N_UNKNOWN>::zeros();
        let mut right = SVector::<f32, N_UNKNOWN>::zeros();
        for (at, residual) in residuals.iter().enumerate() {
            let Some(residual) = residual else { continue };
            let [across, down] = self.gradients[at];
            let [x, y] = self.place(at);
            // Expected residual of a shift by half a gradient. Beyond three times that, Huber's
            // weight applies.
            let expected = spread + 0.5 * (across * across + down * down).sqrt();
            let weight = (3.0 * expected / residual.abs().max(3.0 * expected)) / (expected * expected);
            // A picture that moved along its gradient is darker there.
            let row = SVector::<f32, N_UNKNOWN>::from([
                -across,
                -down,
                across * y - down * x,
                -(across * x + down * y),
                self.one.luma[at],
                1.0,
            ]);
            // The residual is taken at the moved place, so that a further step reduces it.
            let weighted = weight * row;
            // The lower half, which is all that is read.
            for column in 0..N_UNKNOWN {
                for line in column..N_UNKNOWN {
                    normal[(line, column)] += row[line] * weighted[column];
                }
            }
            right += *residual * weighted;
        }
        // Without texture, movement is unconstrained: the prior is none, give or take two squares;
        // the codes stay within a few percent.
        let priors = [2.0, 2.0, 2.0, 2.0, 0.1, 10.0_f32];
        for (k, prior) in priors.into_iter().enumerate() {
            normal[(k, k)] += 1.0 / (prior * prior);
        }
        normal.cholesky().map(|normal| normal.solve(&right))
    }

    /// Fraction of tiles that differ by more than noise and edges explain.
    fn changed(&self, residuals: &[Option<f32>]) -> f64 {
        let spread = self.spread(residuals);
        let least = LEAST_CODES.max(4.0 * spread);
        let [columns, rows] = self.one.size;
        let (mut n_tiles, mut n_changed) = (0, 0);
        for top in (0..rows).step_by(TILE) {
            for left in (0..columns).step_by(TILE) {
                let (mut n, mut n_far, mut sum, mut edges) = (0.0, 0.0, 0.0, 0.0);
                for y in top..(top + TILE).min(rows) {
                    let squares = y * columns + left..y * columns + (left + TILE).min(columns);
                    for (at, residual) in squares.clone().zip(&residuals[squares]) {
                        let Some(residual) = residual else { continue };
                        let edge = OF_GRADIENT * self.steepest(at);
                        n += 1.0;
                        sum += residual;
                        edges += edge;
                        if residual.abs() > least + edge {
                            n_far += 1.0;
                        }
                    }
                }
                if n > 0.0 {
                    n_tiles += 1;
                    let is_far = n_far > OF_TILE * n;
                    let least_sum = (LEAST_MEAN_CODES * n).max(6.0 * spread * f32::sqrt(n));
                    let is_other = f32::abs(sum) > least_sum + edges;
                    n_changed += usize::from(is_far || is_other);
                }
            }
        }
        n_changed as f64 / f64::from(n_tiles.max(1))
    }

    /// The steepest gradient at a square and beside it.
    fn steepest(&self, at: usize) -> f32 {
        let columns = self.one.size[0];
        let places = [
            Some(at),
            at.checked_sub(1),
            Some(at + 1),
            at.checked_sub(columns),
            Some(at + columns),
        ];
        let gradients = places
            .into_iter()
            .flatten()
            .filter_map(|at| self.gradients.get(at));
        gradients.fold(0.0, |most: f32, [across, down]| most.max(across.hypot(*down)))
    }
}

/// Bilinear; `None` outside of the picture.
#[allow(clippy::cast_possible_truncation, reason = "checked to be within the picture")]
fn sample(picture: &Reduced, [x, y]: [f32; 2]) -> Option<f32> {
    let [columns, rows] = picture.size;
    let is_within = x >= 0.0 && y >= 0.0 && x <= (columns - 1) as f32 && y <= (rows - 1) as f32;
    if !is_within {
        return None;
    }
    let first = [(x as usize).min(columns - 2), (y as usize).min(rows - 2)];
    let part = [x - first[0] as f32, y - first[1] as f32];
    let at = first[1] * columns + first[0];
    let row = |at: usize| picture.luma[at] + part[0] * (picture.luma[at + 1] - picture.luma[at]);
    let (above, below) = (row(at), row(at + columns));
    Some(above + part[1] * (below - above))
}
