//! Grain: the noise of a picture, measured against a plate of the same view.

mod line;
mod reach;

use line::{fitted_without_outliers, narrowed};
use reach::{BLOCK_PX, Reach};

use crate::geometry::color::{linear_from_srgb, linear_of_codes, linear_per_srgb};
use crate::scene::{Camera, Image, InputError, Scene, check};

/// Largest number of blocks: more add no information.
const MAX_BLOCKS: u32 = 6000;
/// Pixels of a block.
const N_PX: usize = (BLOCK_PX * BLOCK_PX) as usize;
const N: f64 = N_PX as f64;
/// Variance of the rounding of codes: synthesised pixels are rounded, too, so that it is not made.
const ROUNDING_CODES2: f64 = 1.0 / 12.0;
/// Codes that are neither clipped nor mostly rounding.
const USABLE_CODES: [f32; 2] = [10.0, 250.0];
/// Classes of brightness, uniform in the square root of light.
const N_CLASSES: usize = 16;
/// Number of blocks that a class needs.
const MIN_BLOCKS: usize = 24;
/// Standard deviation in codes below which a picture counts as clean, and no grain is made.
/// Measured: up to 0.55 for path-traced pictures without a sensor, also after a phone's processing,
/// beside a plate that is 0.4 px off, or blurred by a motion of 5 px; 0.93 for a sensor's noise of
/// one code.
const MIN_CODES: f64 = 0.75;
/// Part of the texture's variance that a plate may lack if both pictures have equal noise: a gain of
/// texture by 1.5 percent is none of noise. Measured on pictures and plates from one phone's
/// processing: 0.02.
const GAIN_OF_TEXTURE: f64 = 0.03;
/// Part of the frame's noise from which on that of a plate may be equal: 0.76 was measured for such
/// pictures, up to 0.3 for the mean of sixteen.
const PART_OF_EQUAL: f64 = 0.5;
/// Standard deviation in pixels of a plate's displacement along either axis, as far as the pictures do
/// not tell it: along a texture of one direction it stays 0. Cameras that return to a pose, and lenses
/// that breathe, are off by a part of a pixel.
const APART_PX: f64 = 0.5;
/// Largest factor of the extrapolation to no texture. Measured: .3 to .85 on pictures of a table; 24 on
/// a fine periodic texture, whose blocks differ by chance.
const MOST_EXTRAPOLATION: f64 = 1.0;

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
    /// Reach of the noise: it is white noise, averaged along rows and columns with these weights of
    /// the pixels one and two away, from 0 to 1, relative to the pixel's own.
    pub weights: [f32; 2],
    /// Correlation of a pixel's channels, from 0 to 1.
    pub channels: f32,
}

/// Statistics of a block's channel, in linear light.
#[derive(Clone, Copy, Default)]
struct Statistics {
    n_blocks: f64,
    light: f64,
    plate_light: f64,
    frame: f64,
    plate: f64,
    texture: f64,
    /// Covariances of the frame's noise of pixels one and two apart along rows and columns.
    apart: [f64; 2],
}

/// Deviations of the pixels of a block from its mean, of the frame, and of the plate at the frame's
/// brightness.
struct Channel {
    frame: [f64; N_PX],
    plate: [f64; N_PX],
    light: f64,
    scale: f64,
    /// Degrees of freedom of the frame's noise: without those of the mean and the displacement.
    n_free: f64,
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
        if !is_noisy(codes2_without_texture(&statistics)) {
            return None;
        }
        let classes = noisy_of(classes(statistics))?;
        let of = |value: fn(&Statistics) -> f64, light: fn(&Statistics) -> f64| {
            let points = classes.iter();
            fitted_without_outliers(points.map(|class| (light(class), value(class), class.n_blocks)))
        };
        let reach =
            Reach::of([0, 1].map(|k| median(classes.iter().map(|class| class.apart[k] / class.frame))));
        let whole = |noise: Noise| noise.times(reach.whole());
        let grain = Self {
            frame: whole(of(|class| class.frame, |class| class.light)?),
            plate: whole(of(|class| class.plate, |class| class.plate_light)?),
            weights: reach.weights(),
            channels: narrowed(common, 1.0),
        };
        let light = median(classes.iter().map(|class| class.light));
        is_noisy(grain.frame.variance(light) / light_per_code(light).powi(2)).then_some(grain)
    }

    /// Checks the values.
    ///
    /// # Errors
    /// When a variance, a weight, or the correlation of channels is not from 0 to 1.
    pub fn check(&self) -> Result<(), InputError> {
        let noises = [("frame", self.frame), ("plate", self.plate)];
        for (picture, noise) in noises {
            for (name, value) in [("floor", noise.floor), ("per_light", noise.per_light)] {
                let checked = check::number(f64::from(value), &(0.0..=1.0));
                InputError::at(&format!("grain.{picture}.{name}"), checked)?;
            }
        }
        for weight in self.weights {
            InputError::at("grain.weights", check::number(f64::from(weight), &(0.0..=1.0)))?;
        }
        InputError::at(
            "grain.channels",
            check::number(f64::from(self.channels), &(0.0..=1.0)),
        )?;
        Ok(())
    }
}

/// Whether a picture is noisy, from the variance of its codes.
fn is_noisy(codes2: f64) -> bool {
    codes2 > MIN_CODES * MIN_CODES
}

/// Variance in codes of the noise where there is no texture, by medians over the quarter of the blocks
/// with the least of it and over the next one: a plate that is less or more sharp differs by a part of
/// the texture, and shadows, things and edges that the plate lacks are in few blocks.
fn codes2_without_texture(blocks: &[Statistics]) -> f64 {
    let in_codes = |block: &Statistics| {
        let per_code2 = light_per_code(block.light).powi(2);
        [block.texture, block.frame].map(|variance| variance / per_code2)
    };
    let mut blocks: Vec<[f64; 2]> = blocks.iter().map(in_codes).collect();
    blocks.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let (less, more) = blocks[..blocks.len() / 2].split_at(blocks.len() / 4);
    let [[texture, noise], [more_texture, more_noise]] =
        [less, more].map(|quarter| [0, 1].map(|value| median(quarter.iter().map(|block| block[value]))));
    let texture = texture.max(0.0);
    if more_texture <= texture {
        return noise;
    }
    let times = (texture / (more_texture - texture)).min(MOST_EXTRAPOLATION);
    noise - times * (more_noise - noise)
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

    fn times(self, factor: f32) -> Self {
        Self {
            floor: factor * self.floor,
            per_light: factor * self.per_light,
        }
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
        let n_displaced = register(&mut plate, &frame);
        Some(Self {
            frame,
            plate,
            light,
            scale,
            n_free: N - 1.0 - n_displaced,
        })
    }

    /// Covariance of the frame's noise in two channels: structure of the plate is texture and
    /// removed.
    fn covariance(&self, other: &Self) -> f64 {
        let pixels = 0..N_PX;
        let sum = pixels
            .map(|k| self.frame[k] * (other.frame[k] - other.plate[k]))
            .sum::<f64>();
        sum / self.n_free
    }

    fn statistics(&self) -> Statistics {
        let shared = self
            .frame
            .iter()
            .zip(&self.plate)
            .map(|(a, b)| a * b)
            .sum::<f64>()
            / self.n_free;
        let plate = self.plate.iter().map(|b| b * b).sum::<f64>() / self.n_free;
        Statistics {
            n_blocks: 1.0,
            light: self.light,
            plate_light: self.light / self.scale,
            frame: self.covariance(self),
            plate: (plate - shared) / self.scale.powi(2),
            texture: shared,
            apart: [1, 2].map(|apart| self.apart(apart)),
        }
    }

    /// Covariance of the noise of pixels this far apart along rows and columns.
    fn apart(&self, apart: usize) -> f64 {
        let (mut sum, mut n) = (0.0, 0.0);
        let side = BLOCK_PX as usize;
        for k in 0..side * side {
            let right = (k % side + apart < side).then_some(k + apart);
            let below = (k + apart * side < side * side).then_some(k + apart * side);
            for other in right.into_iter().chain(below) {
                let texture = self.frame[k] * self.plate[other] + self.frame[other] * self.plate[k];
                sum += self.frame[k] * self.frame[other] - 0.5 * texture;
                n += 1.0;
            }
        }
        sum / n
    }
}

/// Moves a plate's deviations to where they resemble the frame's most, to first order: a plate that
/// is a fraction of a pixel off is no noise. Returns the degrees of freedom of the noise that this
/// removes, from 0 to 2.
///
/// The displacement is that of least squares with a prior of [`APART_PX`], against which the noise is
/// at most what the plate lacks.
fn register(plate: &mut [f64; N_PX], frame: &[f64; N_PX]) -> f64 {
    let slopes = slopes(plate);
    let [mut xx, mut yy, mut xy, mut x, mut y, mut lacking] = [0.0; 6];
    for ([along, down], (plate, frame)) in slopes.iter().zip(plate.iter().zip(frame)) {
        xx += along * along;
        yy += down * down;
        xy += along * down;
        x += along * (frame - plate);
        y += down * (frame - plate);
        lacking += (frame - plate).powi(2);
    }
    let prior = lacking / N / APART_PX.powi(2);
    let [xx, yy] = [xx + prior, yy + prior];
    let determinant = xx * yy - xy * xy;
    // Equal pictures, or a plate without texture.
    if determinant <= f64::EPSILON * xx * yy {
        return 0.0;
    }
    let [dx, dy] = [x * yy - y * xy, y * xx - x * xy].map(|apart| apart / determinant);
    for (plate, [along, down]) in plate.iter_mut().zip(slopes) {
        *plate += dx * along + dy * down;
    }
    2.0 - prior * (xx + yy) / determinant
}

/// Differences per pixel along rows and down columns of a block, less their means.
fn slopes(block: &[f64; N_PX]) -> [[f64; 2]; N_PX] {
    let side = BLOCK_PX as usize;
    let mut slopes = [[0.0; 2]; N_PX];
    for (k, slope) in slopes.iter_mut().enumerate() {
        for (slope, (at, step)) in slope.iter_mut().zip([(k % side, 1), (k / side, side)]) {
            let [before, after] = [at.min(1), (side - 1 - at).min(1)];
            *slope = (block[k + after * step] - block[k - before * step]) / (before + after) as f64;
        }
    }
    for axis in [0, 1] {
        let mean = slopes.iter().map(|slope| slope[axis]).sum::<f64>() / N;
        slopes.iter_mut().for_each(|slope| slope[axis] -= mean);
    }
    slopes
}

impl Statistics {
    /// With the same noise in both pictures, if a gain of the texture explains what the plate lacks.
    fn with_equal_noise_if_alike(self) -> Self {
        let to_frame = (self.light / self.plate_light).powi(2);
        let plate = self.plate * to_frame;
        let lacking = self.frame - plate;
        let is_gain = lacking <= GAIN_OF_TEXTURE * self.texture && plate >= PART_OF_EQUAL * self.frame;
        if lacking <= 0.0 || !is_gain {
            return self;
        }
        let both = 0.5 * (self.frame + plate);
        Self {
            frame: both,
            plate: both / to_frame,
            ..self
        }
    }

    /// Without the frame's rounding.
    fn without_rounding(self) -> Self {
        Self {
            frame: self.frame - self.rounding(),
            ..self
        }
    }

    fn rounding(&self) -> f64 {
        ROUNDING_CODES2 * light_per_code(self.light).powi(2)
    }

    /// Whether a frame without its rounding has no noise. A plate that is sharper than the frame has more
    /// texture, which counts against the frame's noise.
    fn is_clean(&self) -> bool {
        self.frame <= 0.0 && self.frame > -2.0 * self.rounding()
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
            n_blocks: class.len() as f64,
            light: of(|statistics| statistics.light),
            plate_light: of(|statistics| statistics.plate_light),
            frame: of(|statistics| statistics.frame),
            plate: of(|statistics| statistics.plate),
            texture: of(|statistics| statistics.texture),
            apart: [
                of(|statistics| statistics.apart[0]),
                of(|statistics| statistics.apart[1]),
            ],
        }
    })
    .map(|class| class.with_equal_noise_if_alike().without_rounding())
    .collect()
}

/// The classes in which the frame has noise; `None` if more blocks are of classes that have none: what
/// is left are rims of shadows and things. Measured: a path-traced picture equal to its plate but for the
/// toy had 3.7 codes of noise in the plate by one class alone.
fn noisy_of(classes: Vec<Statistics>) -> Option<Vec<Statistics>> {
    let (noisy, others): (Vec<_>, Vec<_>) = classes.into_iter().partition(|class| class.frame > 0.0);
    let n_clean: f64 = others
        .iter()
        .filter(|class| class.is_clean())
        .map(|class| class.n_blocks)
        .sum();
    let n_noisy: f64 = noisy.iter().map(|class| class.n_blocks).sum();
    (n_noisy > 0.0 && n_noisy >= n_clean).then_some(noisy)
}

/// 0 for an empty list.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}
