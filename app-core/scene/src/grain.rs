//! Grain: the noise of a picture, measured against a plate of the same view.

use crate::geometry::color::{linear_from_srgb, linear_of_codes, linear_per_srgb};
use crate::scene::{Camera, Image, InputError, Scene, check};

/// Side of a block of pixels in which noise is separated from texture.
const BLOCK_PX: u32 = 8;
/// Largest number of blocks: more add no information.
const MAX_BLOCKS: u32 = 6000;
/// Pixels of a block.
const N_PX: usize = (BLOCK_PX * BLOCK_PX) as usize;
const N: f64 = N_PX as f64;
/// Codes that are neither clipped nor mostly rounding.
const USABLE_CODES: [f32; 2] = [10.0, 250.0];
/// Classes of brightness, uniform in the square root of light.
const N_CLASSES: usize = 16;
/// Number of blocks that a class needs.
const MIN_BLOCKS: usize = 24;
/// Standard deviation in codes below which a picture counts as clean, and no grain is made. Chosen
/// on path-traced pictures without a sensor, which measured up to 2.5.
const MIN_CODES: f64 = 4.0;
/// The same, of the part that the plate lacks. A compressed picture is cleaner, but so is the mean
/// of several that is its plate. Measured: up to 1.7 for pictures and plates from one phone's
/// processing, from 2.9 on for a dim room's pictures after JPEG, and a plate of sixteen of them.
const MIN_MISSING_CODES: f64 = 2.5;
/// Variance of a class over the line through all of them from which it is none of noise alone: few
/// blocks in the dark show an even shadow, and most others its rim or the toy. Measured on pictures
/// of a dim room after JPEG on a uniform table, the fitted variance in the shadow over the true one:
/// 1.30 to 1.46 with all classes, 1.14 to 1.21 without these; on textured tables it stays.
const MOST_OVER_LINE: f64 = 1.5;
const N_FITS: usize = 4;
/// Largest correlation of neighbours that can be made.
const MAX_CORRELATION: f64 = 0.625;

/// Variance of a channel of linear light: `floor + per_light * light`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Variance in the dark.
    pub floor: f32,
    /// Variance per unit of light.
    pub per_light: f32,
}

/// The noise of a camera's picture, which synthesised pixels should have, and that of its plate,
/// which they have already.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Noise of the camera's picture.
    pub frame: Noise,
    /// Noise of the plate from the same camera pose.
    pub plate: Noise,
    /// Correlation of adjacent pixels, from 0 to 0.625.
    pub beside: f32,
    /// Correlation of a pixel's channels, from 0 to 1.
    pub channels: f32,
}

/// Statistics of a block's channel, in linear light.
#[derive(Clone, Copy, Default)]
struct Statistics {
    light: f64,
    plate_light: f64,
    frame: f64,
    plate: f64,
    beside: f64,
}

/// Deviations of the pixels of a block from its mean, of the frame, and of the plate at the frame's
/// brightness.
struct Channel {
    frame: [f64; N_PX],
    plate: [f64; N_PX],
    light: f64,
    scale: f64,
}

impl Grain {
    /// The grain of a frame, against the first plate with the same camera; `None` if there is no
    /// such plate, or if [`Grain::measured`] finds none.
    #[must_use]
    pub fn of(scene: &Scene, image: &Image, camera: &Camera) -> Option<Self> {
        let plate = scene.plates.iter().find(|plate| plate.camera == *camera)?;
        Self::measured(image, &plate.image)
    }

    /// Measures a picture against a plate of the same view and size: common structure is no noise.
    /// `None` if the picture is clean, or if hardly any pixels can be compared.
    #[must_use]
    pub fn measured(frame: &Image, plate: &Image) -> Option<Self> {
        let size_px = [frame.width_px, frame.height_px];
        if !(frame.is_of_size(size_px) && plate.is_of_size(size_px)) {
            return None;
        }
        let light_of = linear_of_codes();
        let pixel = |image: &Image, index: usize| {
            let codes = image.rgba8.get(4 * index..4 * index + 3)?;
            Some([0, 1, 2].map(|channel| light_of[usize::from(codes[channel])]))
        };
        Self::between(size_px, |index| pixel(frame, index), |index| pixel(plate, index))
    }

    /// The same for two pictures in linear light, each a function from a pixel's index, rows from
    /// the top, to its channels; `None` for a pixel that is unknown.
    #[must_use]
    pub fn between(
        size_px: [u32; 2],
        frame: impl Fn(usize) -> Option<[f32; 3]>,
        plate: impl Fn(usize) -> Option<[f32; 3]>,
    ) -> Option<Self> {
        let (statistics, common) = statistics(size_px, [&frame, &plate]);
        // Medians over blocks: shadows, things and edges that the plate lacks are no noise.
        let typical_codes2 = |value: fn(&Statistics) -> f64| {
            median(
                statistics
                    .iter()
                    .map(|block| value(block) / light_per_code(block.light).powi(2)),
            )
        };
        let plate = |block: &Statistics| block.plate * (block.light / block.plate_light).powi(2);
        if !is_noisy([typical_codes2(|block| block.frame), typical_codes2(plate)]) {
            return None;
        }
        let classes = classes(statistics);
        let of = |value: fn(&Statistics) -> f64, light: fn(&Statistics) -> f64| {
            fitted_without_outliers(classes.iter().map(|class| (light(class), value(class))))
        };
        let grain = Self {
            frame: of(|class| class.frame, |class| class.light)?,
            plate: of(|class| class.plate, |class| class.plate_light)?,
            beside: narrowed(
                median(classes.iter().map(|class| class.beside / class.frame)),
                MAX_CORRELATION,
            ),
            channels: narrowed(common, 1.0),
        };
        let typical = |light: fn(&Statistics) -> f64| median(classes.iter().map(light));
        grain
            .is_seen(typical(|class| class.light), typical(|class| class.plate_light))
            .then_some(grain)
    }

    /// Whether the picture is noisy at a light, which is another one in the plate if that has
    /// another exposure.
    fn is_seen(&self, light: f64, plate_light: f64) -> bool {
        let plate = self.plate.variance(plate_light) * (light / plate_light).powi(2);
        is_noisy([self.frame.variance(light), plate].map(|variance| variance / light_per_code(light).powi(2)))
    }

    /// Checks the values.
    ///
    /// # Errors
    /// When a variance is not from 0 to 1, or a correlation is out of range.
    pub fn check(&self) -> Result<(), InputError> {
        let noises = [("frame", self.frame), ("plate", self.plate)];
        for (picture, noise) in noises {
            for (name, value) in [("floor", noise.floor), ("per_light", noise.per_light)] {
                let checked = check::number(f64::from(value), &(0.0..=1.0));
                InputError::at(&format!("grain.{picture}.{name}"), checked)?;
            }
        }
        InputError::at(
            "grain.beside",
            check::number(f64::from(self.beside), &(0.0..=MAX_CORRELATION)),
        )?;
        InputError::at(
            "grain.channels",
            check::number(f64::from(self.channels), &(0.0..=1.0)),
        )?;
        Ok(())
    }
}

/// Whether a picture is noisy, from the variances of its codes and of its plate's.
fn is_noisy([frame, plate]: [f64; 2]) -> bool {
    frame > MIN_CODES * MIN_CODES || frame - plate > MIN_MISSING_CODES * MIN_MISSING_CODES
}

/// Light per code, at a light.
fn light_per_code(light: f64) -> f64 {
    #[allow(clippy::cast_possible_truncation, reason = "of a light of one picture")]
    let per_code = f64::from(linear_per_srgb(light as f32)) / 255.0;
    per_code
}

impl Noise {
    /// Variance of a channel at a light.
    #[must_use]
    pub fn variance(&self, light: f64) -> f64 {
        f64::from(self.floor) + f64::from(self.per_light) * light
    }
}

/// Light of a pixel by its index; `None` if it is unknown.
type Lights<'a> = &'a dyn Fn(usize) -> Option<[f32; 3]>;

/// Statistics of blocks all over two pictures, the frame and its plate, channel by channel, and the
/// correlation between channels.
fn statistics(size_px: [u32; 2], pictures: [Lights<'_>; 2]) -> (Vec<Statistics>, f64) {
    let usable = USABLE_CODES.map(|code| linear_from_srgb(code / 255.0));
    let [columns, rows] = size_px.map(|side| side / BLOCK_PX);
    let step = (columns * rows).div_ceil(MAX_BLOCKS).max(1) as usize;
    let (mut statistics, mut common) = (Vec::new(), Vec::new());
    for block in (0..columns * rows).step_by(step) {
        let corner = [block % columns, block / columns].map(|at| at * BLOCK_PX);
        let Some(blocks) = blocks(size_px[0], corner, pictures) else {
            continue;
        };
        let channels = [0, 1, 2].map(|channel| Channel::new(&blocks, channel, usable));
        let tell = |pair: [usize; 2]| {
            let [a, b] = pair.map(|index| channels[index].as_ref());
            Some(a?.covariance(b?))
        };
        if let [Some(red), Some(green), Some(both)] = [[0, 0], [1, 1], [0, 1]].map(tell)
            && red.min(green) > 0.0
        {
            common.push(both / (red * green).sqrt());
        }
        statistics.extend(channels.iter().flatten().map(Channel::statistics));
    }
    (statistics, median(common.into_iter()))
}

/// The pixels of a block.
type Block = [[f32; 3]; N_PX];

/// The block at a corner in either picture; `None` if one of its pixels is unknown.
fn blocks(width_px: u32, [left, top]: [u32; 2], pictures: [Lights<'_>; 2]) -> Option<[Block; 2]> {
    let mut blocks = [[[0.0; 3]; N_PX]; 2];
    for (picture, block) in pictures.into_iter().zip(&mut blocks) {
        for (index, pixel) in (0..).zip(block.iter_mut()) {
            let [x, y] = [left + index % BLOCK_PX, top + index / BLOCK_PX];
            *pixel = picture((y * width_px + x) as usize)?;
        }
    }
    Some(blocks)
}

impl Channel {
    /// `None` if a pixel of either picture is darker or brighter than usable.
    fn new(blocks: &[Block; 2], channel: usize, [darkest, brightest]: [f32; 2]) -> Option<Self> {
        let [mut frame, mut plate] = [[0.0; N_PX]; 2];
        for (block, values) in blocks.iter().zip([&mut frame, &mut plate]) {
            for (pixel, value) in block.iter().zip(values.iter_mut()) {
                let light = pixel[channel];
                if !(darkest..=brightest).contains(&light) {
                    return None;
                }
                *value = f64::from(light);
            }
        }
        let [light, plate_light] = [&frame, &plate].map(|values| values.iter().sum::<f64>() / N);
        let scale = light / plate_light;
        frame.iter_mut().for_each(|value| *value -= light);
        plate
            .iter_mut()
            .for_each(|value| *value = scale * (*value - plate_light));
        Some(Self {
            frame,
            plate,
            light,
            scale,
        })
    }

    /// Covariance of the frame's noise in two channels: structure of the plate is texture and
    /// removed.
    fn covariance(&self, other: &Self) -> f64 {
        let pixels = 0..N_PX;
        let sum = pixels
            .map(|k| self.frame[k] * (other.frame[k] - other.plate[k]))
            .sum::<f64>();
        sum / (N - 1.0)
    }

    fn statistics(&self) -> Statistics {
        let shared = self
            .frame
            .iter()
            .zip(&self.plate)
            .map(|(a, b)| a * b)
            .sum::<f64>()
            / (N - 1.0);
        let plate = self.plate.iter().map(|b| b * b).sum::<f64>() / (N - 1.0);
        Statistics {
            light: self.light,
            plate_light: self.light / self.scale,
            frame: self.covariance(self),
            plate: (plate - shared) / self.scale.powi(2),
            beside: self.beside(),
        }
    }

    /// Covariance of the noise of adjacent pixels.
    fn beside(&self) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        let side = BLOCK_PX as usize;
        for k in 0..side * side {
            let right = (k % side + 1 < side).then_some(k + 1);
            let below = (k + side < side * side).then_some(k + side);
            for other in right.into_iter().chain(below) {
                let texture = self.frame[k] * self.plate[other] + self.frame[other] * self.plate[k];
                sum += self.frame[k] * self.frame[other] - 0.5 * texture;
                n += 1.0;
            }
        }
        // The subtracted mean of the block contains a share of each pixel's noise.
        sum / n + self.covariance(self) / N
    }
}

/// Medians of the classes of brightness that have enough blocks: things in only one picture are
/// outvoted.
fn classes(statistics: Vec<Statistics>) -> Vec<Statistics> {
    let mut classes = vec![Vec::new(); N_CLASSES];
    for statistics in statistics {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "light is from 0 to 1"
        )]
        let class = (statistics.light.sqrt() * N_CLASSES as f64) as usize;
        classes[class.min(N_CLASSES - 1)].push(statistics);
    }
    let many = classes.into_iter().filter(|class| class.len() >= MIN_BLOCKS);
    many.map(|class| {
        let of = |value: fn(&Statistics) -> f64| median(class.iter().map(value));
        Statistics {
            light: of(|statistics| statistics.light),
            plate_light: of(|statistics| statistics.plate_light),
            frame: of(|statistics| statistics.frame),
            plate: of(|statistics| statistics.plate),
            beside: of(|statistics| statistics.beside),
        }
    })
    .filter(|class| class.frame > 0.0)
    .collect()
}

/// 0 for an empty list.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

/// The line through the points (light, variance), without those that are far above it.
fn fitted_without_outliers(points: impl Iterator<Item = (f64, f64)>) -> Option<Noise> {
    let mut points: Vec<(f64, f64)> = points.collect();
    let mut noise = fitted(points.iter().copied())?;
    for _ in 1..N_FITS {
        points.retain(|(light, variance)| *variance <= MOST_OVER_LINE * noise.variance(*light));
        noise = fitted(points.iter().copied()).unwrap_or(noise);
    }
    Some(noise)
}

/// The line through (light, variance) of least relative error with two non-negative coefficients.
fn fitted(points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<Noise> {
    let largest = points.clone().map(|(_, variance)| variance).fold(0.0, f64::max);
    let (mut n, mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (light, variance) in points {
        let weight = 1.0 / variance.max(0.01 * largest).max(1e-12).powi(2);
        n += weight;
        x += weight * light;
        y += weight * variance;
        xx += weight * light * light;
        xy += weight * light * variance;
    }
    if n == 0.0 {
        return None;
    }
    let spread = n * xx - x * x;
    let slope = if spread > 1e-9 * n * xx {
        (n * xy - x * y) / spread
    } else {
        0.0
    };
    let floor = (y - slope * x) / n;
    let (floor, slope) = if slope < 0.0 {
        (y / n, 0.0)
    } else if floor < 0.0 {
        (0.0, xy / xx)
    } else {
        (floor, slope)
    };
    Some(Noise {
        floor: narrowed(floor, 1.0),
        per_light: narrowed(slope, 1.0),
    })
}

/// Clamped to 0 to `most`; 0 for NaN.
#[allow(clippy::cast_possible_truncation, reason = "of the range of a single")]
fn narrowed(value: f64, most: f64) -> f32 {
    if value.is_finite() {
        value.clamp(0.0, most) as f32
    } else {
        0.0
    }
}
