//! Measures how much softer a photograph is than its plate, from their common texture.
//!
//! A blur removes more of a fine texture than of a coarse one: the right blur leaves as much of the
//! plate's texture, along each of four directions, as the photograph has. Four directions determine
//! a covariance, and so distinguish motion from defocus. Shadows, things and the toy itself are
//! excluded by their ratio to the plate. Noise, which photograph and plate do not share, cancels if
//! both have the same amount.

use glam::IVec2;
use nalgebra::{Matrix3, Vector3};

mod grey;
mod motion;

use self::grey::{CORRELATION, Grey, MOST_PX2, RATIO_PX, SMOOTHED_PX, with_variances};
use super::median::median;
use super::picture::{Level, Mask, brightness, places};
use super::pose::{Directed, SOFT_PX};
use super::raster::Coverage;
use app_scene::sharpness::{Sharpness, Spread};

/// Margin around the toy, over its larger side.
const AROUND: f64 = 0.75;
/// Limit for the region's sides, in pixels.
const MOST_SIDE_PX: i32 = 640;
/// Number of pixels that a measurement needs.
const LEAST_PIXELS: usize = 4000;
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
/// Squared correlation of photograph and plate below which a direction shows noise.
const LEAST_CORRELATION: f64 = 0.5;
/// Weight of an isotropic blur against the measurements.
const ROUND: f64 = 0.02;
/// Smallest blur of either that may be a motion's, in pixels. Sharp pictures have up to .38.
const LEAST_PX: f64 = 0.5;
/// Difference of deviations, in pixels, below which a blur counts as isotropic.
const ALIKE_PX: f64 = 0.3;
/// Largest change of variance in one step, and size of the last step, in square pixels.
const MOST_STEP_PX2: f64 = 1.5;
const LAST_STEP_PX2: f64 = 0.02;
const N_STEPS: usize = 10;
/// Difference of the deviations along the axes of a blur, of an outline or a texture, from which it is a motion's, in
/// pixels. Measured at outlines: up to .34 out of focus, .86 to 1.3 for motions of 5 px.
const MOTION_PX: f64 = 0.5;

/// Directions of the derivatives.
const DIRECTIONS: [IVec2; 4] = [IVec2::X, IVec2::Y, IVec2::ONE, IVec2::new(1, -1)];

/// Measurements of the outline's blur, in pixels of the level.
pub(super) struct Outline<'a> {
    /// Its standard deviation; `None` if it was not measured.
    pub(super) px: Option<f64>,
    /// By direction; `None` if too few directions tell.
    pub(super) directed: &'a dyn Fn() -> Option<Directed>,
    /// That of a round blur beside a known one.
    pub(super) beyond_px: &'a dyn Fn(Spread) -> f64,
}

/// The softness of a photograph, from its texture relative to the plate's and from the blur of its
/// outline. Only a soft picture is tested for a motion. If the toy fills the region around it in the largest level,
/// `levels`, each half as large as the one before, are measured as far as needed.
pub(super) fn sharpness<'a>(
    levels: impl Iterator<Item = (&'a Level, Coverage)>,
    outline: &Outline<'_>,
) -> Sharpness {
    let mut measured = levels.enumerate();
    let textures = measured.find_map(|(index, (level, coverage))| {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_possible_wrap,
            reason = "a handful of levels"
        )]
        let level_px = 2.0_f64.powi(index as i32);
        Textures::new(level, &coverage, level_px)
    });
    let plate_spread = textures.as_ref().and_then(Textures::over_plate);
    let of_outline = outline.px.unwrap_or(0.0);
    let widest_px = plate_spread.map_or(0.0, Spread::widest_px);
    let is_soft = of_outline.max(widest_px) >= LEAST_PX;
    let told = is_soft.then(outline.directed).flatten();
    let is_visible = |px: &f64| *px >= SOFT_PX;
    let blurred = match told {
        Some(Directed::Blurred(blurred)) => Some(blurred),
        _ => None,
    };
    let motion = textures
        .filter(|_| is_soft)
        .and_then(|textures| textures.motion(blurred));
    if let Some(motion) = motion.filter(is_motion) {
        let of_plate = Some((outline.beyond_px)(motion)).filter(is_visible);
        return Sharpness {
            plate_spread: motion,
            outline_spread: motion.and(Spread::round(of_plate.unwrap_or(0.0))),
        };
    }
    let plate_spread = within(plate_spread.unwrap_or(Spread::NONE), of_outline);
    let over_plate_px2 = plate_spread.mean_px().powi(2);
    let of_plate_px2 = if is_visible(&of_outline) {
        of_outline * of_outline - over_plate_px2
    } else {
        0.0
    };
    let of_plate = match told {
        Some(Directed::Unexplained) => Spread::NONE,
        // No motion of the camera blurs the toy and not the texture beside it.
        Some(Directed::Blurred(told)) if is_motion(&told) && motion.is_some() => Spread::NONE,
        Some(Directed::Blurred(told)) if is_motion(&told) => positive(told.and(plate_spread.times(-1.0))),
        _ => Spread::round(of_plate_px2.max(0.0).sqrt()),
    };
    Sharpness {
        plate_spread,
        outline_spread: plate_spread.and(of_plate),
    }
}

/// A blur relative to the plate, within the photograph's own at the outline; 0 if none was measured. On an even
/// table a few edges of a thing in changed light look like another blur.
fn within(over_plate: Spread, outline_px: f64) -> Spread {
    let mean_px = over_plate.mean_px();
    if outline_px == 0.0 || outline_px >= mean_px {
        return over_plate;
    }
    over_plate.times((outline_px / mean_px).powi(2))
}

/// Whether a blur is a motion's.
pub(super) fn is_motion(spread: &Spread) -> bool {
    let [wide, narrow] = spread.variances_px2().map(|variance| variance.max(0.0).sqrt());
    wide - narrow >= MOTION_PX
}

/// Square roots of light around the toy.
struct Textures {
    /// The photograph, at the plate's exposure.
    frame: Grey,
    plate: Grey,
    is_used: Vec<bool>,
    /// Their pixels, in those of the largest level.
    level_px: f64,
}

impl Textures {
    /// `None` if too few pixels show the plate in the same light.
    fn new(level: &Level, coverage: &Coverage, level_px: f64) -> Option<Self> {
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
        let is_used: Vec<bool> = places(size_px).map(|at| !unlike.has(at)).collect();
        let n_used = is_used.iter().filter(|is_used| **is_used).count();
        (n_used >= LEAST_PIXELS).then_some(Self {
            frame,
            plate,
            is_used,
            level_px,
        })
    }

    /// The blur that makes the plate as soft as the photograph; `None` if it is unconstrained, or if
    /// the plate is as soft already.
    fn over_plate(&self) -> Option<Spread> {
        let frame = self.frame.spread(Spread::round(SMOOTHED_PX));
        let frame = DIRECTIONS.map(|direction| frame.difference(direction));
        let plate = self.plate.spread(Spread::round(SMOOTHED_PX));
        let mut spread = Spread::NONE;
        for _ in 0..N_STEPS {
            let measurements = measurements(&frame, &plate.spread(spread), &self.is_used);
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
        let measurements = measurements(&frame, &plate.spread(spread), &self.is_used);
        let is_met = measurements
            .iter()
            .all(|one| one.correlation < LEAST_CORRELATION || one.correlation >= CORRELATION);
        is_met.then(|| spread.times(self.level_px.powi(2)))
    }

    /// The same as a motion, beside what the outline tells.
    fn motion(&self, outline: Option<Spread>) -> Option<Spread> {
        let light = |roots: &Grey| Grey {
            size_px: roots.size_px,
            values: roots.values.iter().map(|root| root * root).collect(),
        };
        let pictures = [&light(&self.frame), &light(&self.plate)];
        let outline = outline.map(|outline| outline.times(self.level_px.powi(-2)));
        let motion = motion::measured(pictures, &self.is_used, outline);
        motion.map(|motion| motion.times(self.level_px.powi(2)))
    }
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

/// Measurements of a plate beside the photograph's differences in each direction.
fn measurements(
    frame: &[Grey; DIRECTIONS.len()],
    plate: &Grey,
    is_used: &[bool],
) -> [Measurement; DIRECTIONS.len()] {
    std::array::from_fn(|index| {
        let (frame, plate) = (&frame[index], plate.difference(DIRECTIONS[index]));
        let [across, down] = [IVec2::X, IVec2::Y].map(|axis| plate.difference(axis));
        let mut sums = [0.0; 6];
        let used = is_used.iter().enumerate().filter(|(_, is_used)| **is_used);
        for (index, _) in used {
            let at = |grey: &Grey| f64::from(grey.values[index]);
            // Differences over two pixels.
            let (f, b, x, y) = (at(frame), at(&plate), 0.5 * at(&across), 0.5 * at(&down));
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

#[cfg(test)]
mod tests {
    use app_scene::sharpness::Spread;

    use super::within;

    #[test]
    fn no_blur_beside_the_toy_is_larger_than_that_of_its_outline() {
        // What edges of a thing on an even table looked like, in a sharp picture.
        let over_plate = Spread {
            xx_px2: 0.43,
            ..Spread::NONE
        };
        assert!(within(over_plate, 0.35).mean_px() < 0.3501);
        assert!(within(over_plate, 0.35).yy_px2 == 0.0);
        for unlimited_px in [0.0, 0.5, 2.0] {
            assert_eq!(within(over_plate, unlimited_px), over_plate);
        }
    }
}
