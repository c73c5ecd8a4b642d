//! Measures a motion during the exposure, by the blur of the plate that predicts the photograph.
//!
//! Energies along four directions tell a motion from defocus, but not its length across a texture
//! of one direction, and each has the noise of both pictures. The differences of the pixels tell
//! more: blur changes a picture by its second derivatives, so that least squares find the change
//! of the covariance, and how well it is known (Gauss-Newton, Levenberg 1944). The predicted blur
//! is uniform along a line, since a Gaussian of the same deviation removes less of a fine texture.

use glam::{DVec2, IVec2};
use nalgebra::{SMatrix, SVector};

use super::grey::{CORRELATION, Grey, MOST_PX2, RATIO_PX, SMOOTHED_PX, with_variances};
use crate::picture::{gaussian, line};
use app_scene::sharpness::Spread;

/// Number of unknowns: the covariance, and the displacement of the photograph.
const N: usize = 5;
const N_STEPS: usize = 6;
/// The first blur, in pixels.
const START_PX: f64 = 1.0;
/// Largest step of a variance, and that of the last one, in square pixels.
const MOST_STEP_PX2: f64 = 2.0;
const LAST_STEP_PX2: f64 = 0.01;
/// Square of the covariance's error over that of independent residuals. Measured: up to 26 times
/// as large in front of six tables, since the noise of both pictures is smoothed, too.
const RELATED: f64 = 676.0;
/// Error of the outline's covariance, in square pixels. Measured: up to .21 for motions of 5 px in
/// front of six tables.
const OUTLINE_PX2: f64 = 0.3;
/// Largest error of a variance that is known.
const KNOWN_PX2: f64 = 0.5;
/// What is left without a blur over what a motion leaves, at least. A blur removes the plate's own
/// noise, at most half of what is left of two pictures with the same noise.
const BEYOND_NOISE: f64 = 4.0;
/// Variance up to which three taps blur.
const THREE_TAPS_PX2: f64 = 0.5;

/// The blur of the plate (second of the pictures, in light) that predicts the photograph (first of
/// them) at the used pixels; beside what the outline tells, if a direction has no texture. `None` if it
/// explains too little, or if a direction stays open. Pixels at the border are not used.
pub(super) fn measured(pictures: [&Grey; 2], is_used: &[bool], outline: Option<Spread>) -> Option<Spread> {
    let pictures = pictures.map(texture);
    let alone = of_texture(&pictures, is_used, None);
    alone.or_else(|| of_texture(&pictures, is_used, Some(outline?)))
}

/// The same, beside what the outline tells if that is given.
fn of_texture([frame, plate]: &[Grey; 2], is_used: &[bool], outline: Option<Spread>) -> Option<Spread> {
    let mut spread = Spread::round(START_PX);
    for k in 0..N_STEPS {
        let kernel = Kernel::new(spread);
        let sums = Sums::new(frame, &kernel.of(plate), is_used);
        let (change, is_known) = sums.step(kernel.spread, outline)?;
        let most_px2 = [change.xx_px2, change.xy_px2, change.yy_px2]
            .into_iter()
            .fold(0.0, |most: f64, change| most.max(change.abs()));
        let part = MOST_STEP_PX2 / most_px2.max(MOST_STEP_PX2);
        spread = valid(kernel.spread.and(change.times(part)));
        if most_px2 < LAST_STEP_PX2 || k + 1 == N_STEPS {
            let unblurred = Sums::new(frame, plate, is_used).residual2;
            let is_noise = unblurred < BEYOND_NOISE * sums.residual2;
            return (is_known && !is_noise).then_some(spread);
        }
    }
    None
}

/// Light without noise of single pixels, and without what is coarser than a blur. What differs in the
/// light of both pictures is coarse.
fn texture(light: &Grey) -> Grey {
    let mut fine = light.spread(Spread::round(SMOOTHED_PX));
    let coarse = fine.spread(Spread::round(RATIO_PX));
    for (fine, coarse) in fine.values.iter_mut().zip(coarse.values) {
        *fine -= coarse;
    }
    fine
}

/// The nearest covariance.
fn valid(spread: Spread) -> Spread {
    with_variances(
        spread,
        spread
            .variances_px2()
            .map(|variance| variance.clamp(0.0, MOST_PX2)),
    )
}

/// A uniform blur along a line, and a round one; by taps, whose variances are exact.
struct Kernel {
    line: Vec<(IVec2, f32)>,
    round: [Vec<(IVec2, f32)>; 2],
    spread: Spread,
}

impl Kernel {
    fn new(wanted: Spread) -> Self {
        let [wide, narrow] = wanted.variances_px2();
        let apart_px2 = (wide - narrow).max(0.0);
        let along = wanted.axes_px()[0].normalize_or(DVec2::X);
        let mut taps = line((12.0 * apart_px2).sqrt() * along);
        // Taps between pixels blur as well, up to twice as much along the line as across.
        let [wide, narrow] = moment(&taps).variances_px2();
        let surplus_px2 = wide - narrow - apart_px2;
        taps = line((12.0 * (apart_px2 - surplus_px2).max(0.0)).sqrt() * along);
        let (line, of_line) = (taps.clone(), moment(&taps));
        let [_, left_px2] = wanted.and(of_line.times(-1.0)).variances_px2();
        let along = round(left_px2.max(0.0));
        let round = [IVec2::X, IVec2::Y].map(|axis| {
            let taps = along.iter().map(|(step, weight)| (*step * axis, *weight));
            taps.collect::<Vec<_>>()
        });
        let spread = of_line.and(moment(&round[0])).and(moment(&round[1]));
        Self { line, round, spread }
    }

    fn of(&self, picture: &Grey) -> Grey {
        let [across, down] = &self.round;
        picture.taking(&self.line).taking(across).taking(down)
    }
}

/// Taps along an axis with this variance.
fn round(variance_px2: f64) -> Vec<(i32, f32)> {
    if variance_px2 > THREE_TAPS_PX2 {
        return gaussian(variance_px2.sqrt());
    }
    #[allow(clippy::cast_possible_truncation, reason = "a weight")]
    let beside = 0.5 * variance_px2 as f32;
    vec![(-1, beside), (0, 1.0 - 2.0 * beside), (1, beside)]
}

/// The covariance of taps around the centre.
fn moment(taps: &[(IVec2, f32)]) -> Spread {
    taps.iter().fold(Spread::NONE, |sum, (offset, weight)| {
        let DVec2 { x, y } = offset.as_dvec2();
        let of_tap = Spread {
            xx_px2: x * x,
            xy_px2: x * y,
            yy_px2: y * y,
        };
        sum.and(of_tap.times(f64::from(*weight)))
    })
}

/// Sums of a least-squares problem.
struct Sums {
    normal: SMatrix<f64, N, N>,
    right: SVector<f64, N>,
    residual2: f64,
    light: f64,
    light2: f64,
    n: f64,
}

impl Sums {
    fn new(frame: &Grey, predicted: &Grey, is_used: &[bool]) -> Self {
        let mut sums = Self {
            normal: SMatrix::zeros(),
            right: SVector::zeros(),
            residual2: 0.0,
            light: 0.0,
            light2: 0.0,
            n: 0.0,
        };
        let width = predicted.width();
        for (index, _) in is_used.iter().enumerate().filter(|(_, is_used)| **is_used) {
            let seen = f64::from(frame.values[index]);
            let residual = seen - f64::from(predicted.values[index]);
            let row = derivatives(&predicted.values, index, width);
            sums.normal += row * row.transpose();
            sums.right += row * residual;
            sums.residual2 += residual * residual;
            sums.light += seen;
            sums.light2 += seen * seen;
            sums.n += 1.0;
        }
        sums
    }

    /// The change of the covariance, and whether it is known after it.
    fn step(&self, spread: Spread, outline: Option<Spread>) -> Option<(Spread, bool)> {
        // Variance of a sum of related residuals.
        let noise = (RELATED * self.residual2 / self.n).max(f64::MIN_POSITIVE);
        let (mut normal, mut right) = (self.normal / noise, self.right / noise);
        if let Some(outline) = outline {
            let apart = outline.and(spread.times(-1.0));
            for (k, apart) in [apart.xx_px2, apart.xy_px2, apart.yy_px2].into_iter().enumerate() {
                normal[(k, k)] += OUTLINE_PX2.powi(-2);
                right[k] += apart * OUTLINE_PX2.powi(-2);
            }
        }
        let errors = normal.cholesky()?.inverse();
        let change = errors * right;
        let worst_px2 = errors
            .fixed_view::<3, 3>(0, 0)
            .symmetric_eigenvalues()
            .max()
            .sqrt();
        let texture = self.light2 - self.light * self.light / self.n;
        let is_known = worst_px2 <= KNOWN_PX2 && self.residual2 <= (1.0 - CORRELATION) * texture;
        let is_finite = change.iter().all(|change| change.is_finite());
        let change = Spread {
            xx_px2: change[0],
            xy_px2: change[1],
            yy_px2: change[2],
        };
        is_finite.then_some((change, is_known))
    }
}

/// Derivatives of a blurred pixel by (xx, xy, yy) of the blur, and by a displacement. The pixel is
/// not at the border.
fn derivatives(values: &[f32], index: usize, width: usize) -> SVector<f64, N> {
    let at = |index: usize| f64::from(values[index]);
    let (above, below) = (index - width, index + width);
    let twice = 2.0 * at(index);
    SVector::from([
        0.5 * (at(index - 1) + at(index + 1) - twice),
        0.25 * (at(above - 1) + at(below + 1) - at(above + 1) - at(below - 1)),
        0.5 * (at(above) + at(below) - twice),
        0.5 * (at(index + 1) - at(index - 1)),
        0.5 * (at(below) - at(above)),
    ])
}
