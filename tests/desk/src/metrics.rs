//! Scores a picture against the truth: RMSE and SSIM over the regions that matter, and flicker from frame to frame.
//!
//! RMSE is in 8-bit sRGB units over the three colours, SSIM is taken of encoded luma.

pub mod flicker;
mod ssim;

use app_core::scene::Image;
use app_core::session::Truth;
use serde::Serialize;
use thiserror::Error;

/// Luma of encoded RGB, with the weights of ITU-R BT.709.
const LUMA: [f64; 3] = [0.2126, 0.7152, 0.0722];
/// Reach of a shadow beyond the mask, for filtering and noise.
const SHADOW_MARGIN_PX: usize = 6;
/// Width of the toy's rim outside and inside of its outline.
const RIM_OUTSIDE_PX: usize = 2;
const RIM_INSIDE_PX: usize = 1;
/// Largest code of the renderer's noise in a mask.
const MASK_NOISE: u8 = 2;

const N_REGIONS: usize = 4;

/// Pictures that cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "the {name} is {width_px} x {height_px} px, but the truth's mask is {mask_width_px} x {mask_height_px} px"
)]
pub struct SizeError {
    /// The picture's name.
    pub name: &'static str,
    /// Its width.
    pub width_px: u32,
    /// Its height.
    pub height_px: u32,
    /// Width of the mask.
    pub mask_width_px: u32,
    /// Height of the mask.
    pub mask_height_px: u32,
}

/// Error over one region.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Root of the mean squared difference, in 8-bit sRGB units; 0 for an empty region.
    pub rmse: f64,
    /// Mean structural similarity, at most 1; 1 for an empty region.
    pub ssim: f64,
}

/// Error of one picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scores {
    /// Pixels of a former or present shadow outside of the moved toy.
    pub shadow: Score,
    /// Pixels inside the moved toy.
    pub toy: Score,
    /// The rim of the moved toy, where old pixels would show.
    pub edge: Score,
    /// The whole picture.
    pub frame: Score,
}

/// The regions of each pixel.
#[derive(Clone, Debug)]
pub struct Regions {
    width_px: u32,
    height_px: u32,
    /// One bit per region and pixel, rows from the top.
    members: Vec<u8>,
}

impl Regions {
    const SHADOW: u8 = 1;
    const TOY: u8 = 2;
    const EDGE: u8 = 4;
    const FRAME: u8 = 8;

    /// Finds the regions from a truth's mask: the moved toy in R, the real toy in G, shadow with
    /// the moved toy in B and with the real toy in A.
    #[must_use]
    pub fn from_mask(mask: &Image) -> Self {
        let width = mask.width_px as usize;
        let select =
            |test: fn(&[u8]) -> bool| -> Vec<bool> { mask.rgba8.chunks_exact(4).map(test).collect() };
        let moved_toy = select(|pixel| pixel[0] > 0);
        let changed = select(|pixel| pixel[1] > 0 || pixel[2] > MASK_NOISE || pixel[3] > MASK_NOISE);
        let outside = moved_toy.iter().map(|&toy| !toy).collect::<Vec<_>>();

        let near_change = dilate(&changed, width, SHADOW_MARGIN_PX);
        let near_toy = dilate(&moved_toy, width, RIM_OUTSIDE_PX);
        let near_outside = dilate(&outside, width, RIM_INSIDE_PX);
        let members = near_change
            .iter()
            .zip(&near_toy)
            .zip(&near_outside)
            .map(|((&near_change, &near_toy), &near_outside)| {
                let shadow = if near_change && !near_toy { Self::SHADOW } else { 0 };
                let toy = if near_outside { 0 } else { Self::TOY };
                let edge = if near_toy && near_outside { Self::EDGE } else { 0 };
                shadow | toy | edge | Self::FRAME
            })
            .collect();
        Self {
            width_px: mask.width_px,
            height_px: mask.height_px,
            members,
        }
    }

    /// Number of pixels in each region, in the order shadow, toy, edge, frame.
    #[must_use]
    pub fn n_pixels(&self) -> [usize; 4] {
        [Self::SHADOW, Self::TOY, Self::EDGE, Self::FRAME].map(|region| {
            self.members
                .iter()
                .filter(|&&members| members & region != 0)
                .count()
        })
    }

    fn check_size(&self, name: &'static str, image: &Image) -> Result<(), SizeError> {
        let n_bytes = self.members.len() * 4;
        let same_size = (image.width_px, image.height_px) == (self.width_px, self.height_px);
        if same_size && image.rgba8.len() == n_bytes {
            return Ok(());
        }
        Err(SizeError {
            name,
            width_px: image.width_px,
            height_px: image.height_px,
            mask_width_px: self.width_px,
            mask_height_px: self.height_px,
        })
    }
}

/// Compares a picture with the truth over the regions of its mask. Alpha is ignored.
///
/// # Errors
/// When the size of picture or truth differs from the mask's.
pub fn score(picture: &Image, truth: &Truth) -> Result<Scores, SizeError> {
    measure(picture, &truth.image, &Regions::from_mask(&truth.mask))
}

/// Compares a picture with the truth, region by region. Alpha is ignored.
///
/// # Errors
/// When the size of a picture differs from the mask's.
pub fn measure(actual: &Image, truth: &Image, regions: &Regions) -> Result<Scores, SizeError> {
    regions.check_size("picture", actual)?;
    regions.check_size("truth", truth)?;
    let mut sums = [RegionSum::default(); N_REGIONS];
    let ssim = ssim::map(&luma(actual), &luma(truth), regions.width_px as usize);
    let pixels = actual.rgba8.chunks_exact(4).zip(truth.rgba8.chunks_exact(4));
    for (((actual, truth), ssim), &members) in pixels.zip(ssim).zip(&regions.members) {
        let squared_error = squared_error(actual, truth);
        for (i, sum) in sums.iter_mut().enumerate() {
            if members & (1 << i) != 0 {
                sum.add(squared_error, ssim);
            }
        }
    }
    let [shadow, toy, edge, frame] = sums.map(RegionSum::score);
    Ok(Scores {
        shadow,
        toy,
        edge,
        frame,
    })
}

/// RMSE of a camera frame against the truth outside of shadows and toy, where they show the same:
/// the noise of both and their rounding. `None` if the picture has no such pixel.
///
/// # Errors
/// When the size of frame or truth differs from the mask's.
pub fn floor(frame: &Image, truth: &Truth) -> Result<Option<f64>, SizeError> {
    let regions = Regions::from_mask(&truth.mask);
    regions.check_size("frame", frame)?;
    regions.check_size("truth", &truth.image)?;
    let pixels = frame
        .rgba8
        .as_chunks::<4>()
        .0
        .iter()
        .zip(truth.image.rgba8.as_chunks::<4>().0);
    let mut sum = RegionSum::default();
    for ((frame, truth), _) in pixels
        .zip(&regions.members)
        .filter(|(_, members)| **members == Regions::FRAME)
    {
        sum.add(squared_error(frame, truth), 1.0);
    }
    Ok((sum.n_pixels > 0).then(|| sum.score().rmse))
}

/// Mean squared difference over red, green and blue.
fn squared_error(actual: &[u8], truth: &[u8]) -> f64 {
    let channels = actual.iter().zip(truth).take(3);
    channels
        .map(|(actual, truth)| f64::from(actual.abs_diff(*truth)).powi(2))
        .sum::<f64>()
        / 3.0
}

#[derive(Clone, Copy, Default)]
struct RegionSum {
    n_pixels: u32,
    squared_error: f64,
    ssim: f64,
}

impl RegionSum {
    fn add(&mut self, squared_error: f64, ssim: f64) {
        self.n_pixels += 1;
        self.squared_error += squared_error;
        self.ssim += ssim;
    }

    fn score(self) -> Score {
        if self.n_pixels == 0 {
            return Score { rmse: 0.0, ssim: 1.0 };
        }
        let n = f64::from(self.n_pixels);
        Score {
            rmse: (self.squared_error / n).sqrt(),
            ssim: self.ssim / n,
        }
    }
}

fn luma(image: &Image) -> Vec<f64> {
    let pixels = image.rgba8.chunks_exact(4);
    pixels
        .map(|pixel| (0..3).map(|i| LUMA[i] * f64::from(pixel[i])).sum())
        .collect()
}

/// Sets each pixel that has a set one within a square of `radius` around it. Nothing is set outside
/// of the picture.
fn dilate(set: &[bool], width: usize, radius: usize) -> Vec<bool> {
    let mut rows = vec![false; set.len()];
    for (row, out) in set.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        dilate_line(row.iter().copied(), radius, |x| out[x] = true);
    }
    let mut both = vec![false; set.len()];
    for x in 0..width {
        let column = rows.iter().skip(x).step_by(width).copied();
        dilate_line(column, radius, |y| both[y * width + x] = true);
    }
    both
}

/// Marks all elements within `radius` of a set element, each at most once.
fn dilate_line(line: impl ExactSizeIterator<Item = bool>, radius: usize, mut mark: impl FnMut(usize)) {
    let n = line.len();
    let mut next = 0;
    for (i, _) in line.enumerate().filter(|&(_, set)| set) {
        let end = (i + radius + 1).min(n);
        (next.max(i.saturating_sub(radius))..end).for_each(&mut mark);
        next = end;
    }
}
