//! Measures how much softer a photograph is than its plate, from their common texture.
//!
//! A Gaussian removes the more of a texture the finer it is: the right blur leaves as much of the
//! plate's texture, along each of four directions, as the photograph has. Four directions determine
//! a covariance, and so distinguish motion from defocus. Shadows, things and the toy itself are
//! excluded by their ratio to the plate. Noise, which photograph and plate do not share, cancels if
//! both have the same amount.

use glam::{DVec2, IVec2};
use nalgebra::{Matrix3, Vector3};

use super::median::median;
use super::picture::{Level, Mask, brightness, places, taps_along};
use super::raster::Coverage;
use app_scene::sharpness::{Sharpness, Spread};

/// Margin around the toy, over its larger side.
const AROUND: f64 = 0.75;
/// Limit for the region's sides, in pixels.
const MOST_SIDE_PX: i32 = 640;
/// Number of pixels that a measurement needs.
const LEAST_PIXELS: usize = 4000;
/// Initial blur of both, in pixels, so that noise of single pixels counts little.
const SMOOTHED_PX: f64 = 1.0;
/// Blur of pictures whose ratio is taken, in pixels.
const RATIO_PX: f64 = 3.0;
/// Largest deviation of the ratio from its median; beyond it, the photograph shows something else
/// than the plate in the same light.
const SAME_LIGHT: f32 = 0.04;
/// Range of square roots of light: too dark to divide by, and too bright to exclude clipping.
const DARKEST: f32 = 0.1;
const BRIGHTEST: f32 = 0.97;
/// Margin of excluded pixels: wider than the support of blurred derivatives; wider still around the
/// toy.
const GROWN_PX: i32 = 6;
const TOY_GROWN_PX: i32 = 12;
/// Squared correlation of photograph and plate below which a direction shows noise, and which the
/// used directions must reach together.
const LEAST_CORRELATION: f64 = 0.5;
const CORRELATION: f64 = 0.8;
/// Weight of an isotropic blur against the measurements.
const ROUND: f64 = 0.02;
/// Difference of deviations, in pixels, below which a blur counts as isotropic.
const ALIKE_PX: f64 = 0.3;
/// Largest change of variance in one step, size of the last step, and largest variance, in square
/// pixels.
const MOST_STEP_PX2: f64 = 1.5;
const LAST_STEP_PX2: f64 = 0.02;
const MOST_PX2: f64 = 16.0;
const N_STEPS: usize = 10;
/// A smaller blur of the outline, in pixels, is that of a sharp lens: compression and the like
/// cause as much.
const LEAST_OUTLINE_PX: f64 = 0.7;
/// Difference of an outline's deviations along its axes from which it is blurred by a motion, in
/// pixels. Measured: up to .34 out of focus, .86 to 1.3 for motions of 5 px.
const MOTION_PX: f64 = 0.5;

/// Directions of the derivatives.
const DIRECTIONS: [IVec2; 4] = [IVec2::X, IVec2::Y, IVec2::ONE, IVec2::new(1, -1)];

/// The softness of a photograph, from its texture relative to the plate's and from the blur of its
/// outline: in pixels of the level, `None` for one that was not measured; and by direction, which is
/// measured only if the outline has more blur than the plate lacks.
pub(super) fn sharpness(
    level: &Level,
    coverage: &Coverage,
    (outline_px, directed): (Option<f64>, &dyn Fn() -> Option<Spread>),
) -> Sharpness {
    let plate_spread = over_plate(level, coverage).unwrap_or(Spread::NONE);
    // A photograph's own blur is at least its blur relative to the plate.
    let of_outline = outline_px.filter(|px| *px >= LEAST_OUTLINE_PX).unwrap_or(0.0);
    let over_plate_px2 = 0.5 * (plate_spread.xx_px2 + plate_spread.yy_px2);
    let of_plate_px2 = of_outline * of_outline - over_plate_px2;
    let motion = (of_plate_px2 > 0.0).then(directed).flatten().filter(is_motion);
    let of_plate = match motion {
        Some(motion) => positive(motion.and(plate_spread.times(-1.0))),
        None => Spread::round(of_plate_px2.max(0.0).sqrt()),
    };
    Sharpness {
        plate_spread,
        outline_spread: plate_spread.and(of_plate),
    }
}

/// Whether a blur of the outline is a motion's.
fn is_motion(outline: &Spread) -> bool {
    let [wide, narrow] = outline.variances_px2().map(|variance| variance.max(0.0).sqrt());
    wide - narrow >= MOTION_PX
}

/// The blur that makes the plate as soft as the photograph; `None` if it is unconstrained, or if
/// the plate is as soft already.
fn over_plate(level: &Level, coverage: &Coverage) -> Option<Spread> {
    let (frame, plate, unlike) = textures(level, coverage)?;
    let is_used: Vec<bool> = places(frame.size_px).map(|at| !unlike.has(at)).collect();
    if is_used.iter().filter(|is_used| **is_used).count() < LEAST_PIXELS {
        return None;
    }
    let frame = frame.spread(Spread::round(SMOOTHED_PX));
    let plate = plate.spread(Spread::round(SMOOTHED_PX));
    let mut spread = Spread::NONE;
    for _ in 0..N_STEPS {
        let measurements = measurements(&frame, &plate.spread(spread), &is_used);
        let step_px2 = step(&measurements, spread)?;
        let most_px2 = step_px2.amax();
        let step_px2 = step_px2 * (MOST_STEP_PX2 / most_px2.max(MOST_STEP_PX2));
        spread = steadied(spread.and(Spread {
            xx_px2: step_px2.x,
            xy_px2: step_px2.y,
            yy_px2: step_px2.z,
        }));
        if most_px2 < LAST_STEP_PX2 {
            break;
        }
    }
    let measurements = measurements(&frame, &plate.spread(spread), &is_used);
    let is_met = measurements
        .iter()
        .all(|one| one.correlation < LEAST_CORRELATION || one.correlation >= CORRELATION);
    is_met.then_some(spread)
}

/// The measurement in one direction.
struct Measurement {
    /// Logarithm of the photograph's energy over the plate's.
    excess: f64,
    /// Derivative of the plate's energy by each of (xx, xy, yy).
    falls: Vector3<f64>,
    /// Squared correlation.
    correlation: f64,
}

fn measurements(frame: &Grey, plate: &Grey, is_used: &[bool]) -> [Measurement; DIRECTIONS.len()] {
    DIRECTIONS.map(|direction| {
        let (frame, plate) = (frame.difference(direction), plate.difference(direction));
        let [across, down] = [IVec2::X, IVec2::Y].map(|axis| plate.difference(axis));
        let mut sums = [0.0; 6];
        let used = is_used.iter().enumerate().filter(|(_, is_used)| **is_used);
        for (index, _) in used {
            let at = |grey: &Grey| f64::from(grey.values[index]);
            // Differences over two pixels.
            let (f, b, x, y) = (at(&frame), at(&plate), 0.5 * at(&across), 0.5 * at(&down));
            let terms = [f * f, b * b, f * b, x * x, x * y, y * y];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        let [ff, bb, fb, xx, xy, yy] = sums;
        // A picture without any texture has no energy and no information.
        let (frame_energy, plate_energy) = (ff.max(f64::MIN_POSITIVE), bb.max(f64::MIN_POSITIVE));
        Measurement {
            excess: (frame_energy / plate_energy).ln(),
            falls: Vector3::new(xx, 2.0 * xy, yy) / plate_energy,
            correlation: (fb / frame_energy) * (fb / plate_energy),
        }
    })
}

/// Change of (xx, xy, yy) that makes the plate's energies equal to the photograph's; `None` if no
/// direction has information.
fn step(measurements: &[Measurement], spread: Spread) -> Option<Vector3<f64>> {
    let is_heard = |one: &&Measurement| one.correlation >= LEAST_CORRELATION;
    measurements.iter().find(is_heard)?;
    let mut normal = Matrix3::identity() * f64::EPSILON;
    let mut right = Vector3::zeros();
    let mut add = |row: Vector3<f64>, value: f64| {
        normal += row * row.transpose();
        right += row * value;
    };
    for one in measurements.iter().filter(is_heard) {
        add(one.falls, -one.excess);
    }
    add(
        Vector3::new(ROUND, 0.0, -ROUND),
        ROUND * (spread.yy_px2 - spread.xx_px2),
    );
    add(Vector3::new(0.0, 2.0 * ROUND, 0.0), -2.0 * ROUND * spread.xy_px2);
    let step = normal.cholesky()?.solve(&right);
    step.iter().all(|value| value.is_finite()).then_some(step)
}

/// A valid covariance: positive semidefinite, and isotropic if it is nearly so.
fn steadied(spread: Spread) -> Spread {
    let [wide, narrow] = spread
        .variances_px2()
        .map(|variance| variance.clamp(0.0, MOST_PX2));
    if wide.sqrt() - narrow.sqrt() < ALIKE_PX {
        return Spread::round((0.5 * (wide + narrow)).sqrt());
    }
    with_variances(spread, [wide, narrow])
}

/// The part of a difference of two blurs by which the first is wider.
fn positive(spread: Spread) -> Spread {
    with_variances(spread, spread.variances_px2().map(|variance| variance.max(0.0)))
}

/// A blur with these variances along the axes of another.
fn with_variances(spread: Spread, [wide, narrow]: [f64; 2]) -> Spread {
    let apart = spread.xx_px2 - spread.yy_px2;
    let along = DVec2::from_angle(0.5 * (2.0 * spread.xy_px2).atan2(apart));
    let (xx, xy, yy) = (along.x * along.x, along.x * along.y, along.y * along.y);
    Spread {
        xx_px2: wide * xx + narrow * yy,
        xy_px2: (wide - narrow) * xy,
        yy_px2: wide * yy + narrow * xx,
    }
}

/// Square roots of light around the toy, of the photograph at the plate's exposure and of the
/// plate; and marks on excluded pixels.
fn textures(level: &Level, coverage: &Coverage) -> Option<(Grey, Grey, Mask)> {
    let plate = level.plate.as_ref()?;
    let (origin_px, size_px) = window(coverage, level.frame.size_px)?;
    let read = |picture: &super::picture::Picture| {
        let roots = places(size_px).map(|at| {
            let color = picture.get(origin_px + at)?;
            Some(brightness(&color).max(0.0).sqrt())
        });
        roots.collect::<Vec<Option<f32>>>()
    };
    let (frame, plate) = (read(&level.frame), read(plate));
    let mut unlike = Mask::new(size_px);
    let mut toy = Mask::new(size_px);
    for (index, at) in places(size_px).enumerate() {
        let is_usable =
            |value: Option<f32>| value.is_some_and(|value| (DARKEST..=BRIGHTEST).contains(&value));
        if !is_usable(frame[index]) || !is_usable(plate[index]) || is_at_border(at, size_px) {
            unlike.mark(at);
        }
        if coverage.at(origin_px + at) > 0.0 {
            toy.mark(at);
        }
    }
    let grey = |values: Vec<Option<f32>>| Grey {
        size_px,
        values: values.into_iter().map(|value| value.unwrap_or(0.0)).collect(),
    };
    let (mut frame, plate) = (grey(frame), grey(plate));
    let [of_frame, of_plate] = [&frame, &plate].map(|grey| grey.spread(Spread::round(RATIO_PX)));
    let ratios = of_frame.values.iter().zip(&of_plate.values);
    let ratios: Vec<f32> = ratios.map(|(f, b)| f / b.max(DARKEST)).collect();
    let measurements = places(size_px).zip(&ratios).filter(|(at, _)| !unlike.has(*at));
    let exposure = median(measurements.map(|(_, ratio)| *ratio), f32::total_cmp)?.max(f32::MIN_POSITIVE);
    for (at, ratio) in places(size_px).zip(&ratios) {
        if (ratio / exposure - 1.0).abs() > SAME_LIGHT {
            unlike.mark(at);
        }
    }
    let mut unlike = unlike.grown(GROWN_PX);
    let toy = toy.grown(TOY_GROWN_PX);
    places(size_px)
        .filter(|at| toy.has(*at))
        .for_each(|at| unlike.mark(at));
    frame.values.iter_mut().for_each(|value| *value /= exposure);
    Some((frame, plate, unlike))
}

fn is_at_border(at: IVec2, size_px: IVec2) -> bool {
    at.min_element() < TOY_GROWN_PX || (size_px - 1 - at).min_element() < TOY_GROWN_PX
}

/// Corner and size of the region around the toy, within the picture; `None` if the toy is not
/// visible.
fn window(coverage: &Coverage, picture_px: IVec2) -> Option<(IVec2, IVec2)> {
    if coverage.size_px.min_element() <= 0 {
        return None;
    }
    #[allow(clippy::cast_possible_truncation, reason = "pixels of a picture")]
    let around_px = (AROUND * f64::from(coverage.size_px.max_element())) as i32;
    let middle = coverage.origin_px + coverage.size_px / 2;
    let half = (coverage.size_px / 2 + around_px).min(IVec2::splat(MOST_SIDE_PX / 2));
    let low = (middle - half).max(IVec2::ZERO);
    let size_px = (middle + half).min(picture_px) - low;
    (size_px.min_element() > 0).then_some((low, size_px))
}

/// A picture with one number per pixel.
#[derive(Clone)]
struct Grey {
    size_px: IVec2,
    values: Vec<f32>,
}

impl Grey {
    fn width(&self) -> usize {
        self.size_px.x as usize
    }

    /// The nearest row.
    fn row(&self, y: i32) -> &[f32] {
        let from = y.clamp(0, self.size_px.y - 1) as usize * self.width();
        &self.values[from..from + self.width()]
    }

    /// The weighted sum of the pixels at these offsets from each, or of the nearest ones beyond the
    /// border. Row by row, since most of the time of a measurement is spent here.
    fn taking(&self, taps: &[(IVec2, f32)]) -> Self {
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

    fn difference(&self, direction: IVec2) -> Self {
        self.taking(&[(direction, 1.0), (-direction, -1.0)])
    }

    /// Blurs along one axis, then along the other.
    fn spread(&self, spread: Spread) -> Self {
        let [first, second] = spread.axes_px().map(taps_along);
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
