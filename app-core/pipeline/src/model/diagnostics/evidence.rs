//! Comparison of the latest view's pictures with the session: the real toy, its shadow, the order
//! of the colour channels.

use crate::geometry::rect::PixelRect;
use crate::gpu::{Mirrors, mirrors};
use app_scene::geometry::color::linear_of_codes;
use app_scene::scene::Image;

/// WGSL part of the bounds of usable codes.
pub(crate) const PIXEL: Mirrors = mirrors!("common/pixel", constants: [DARKEST_USABLE, BRIGHTEST_USABLE]);

/// Codes that are a measure of brightness, in linear light.
const USABLE: std::ops::RangeInclusive<f32> = DARKEST_USABLE..=BRIGHTEST_USABLE;
const DARKEST_USABLE: f32 = 0.003_035_27;
const BRIGHTEST_USABLE: f32 = 0.955_973_3;
/// Visibility below which a pixel lies in the shadow of a light, and above which it does not.
const SHADOW: f32 = 0.5;
const LIT: f32 = 0.99;
/// Difference, relative to the plate, up to which a pixel shows just the plate: above the noise of
/// one pixel.
const SAME_AS_PLATE: f32 = 0.1;
/// Minimum number of pixels for a share.
const FEWEST_PIXELS: usize = 16;
/// Maximum number of pixels that are read.
const MOST_PIXELS: usize = 1 << 16;

/// The values of one pixel of the region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelEvidence {
    /// The camera's picture, linear.
    pub frame: [f32; 3],
    /// The plate, linear; alpha is 1 where it was photographed.
    pub plate: [f32; 4],
    /// Marks of `validity`.
    pub validity: [f32; 4],
    /// The lowest of the lights' visibilities.
    pub visibility: f32,
}

/// Sums over the pixels of a view.
#[derive(Clone, Debug, Default)]
pub(crate) struct Evidence {
    /// Number of pixels that each sampled one represents.
    step: usize,
    /// Sum of the lights' hidden shares.
    hidden: f64,
    receiver: Share,
    shadow: Share,
    toy: Share,
    /// Light of the toy's pixels, and the plate's light there.
    toy_light: [f64; 3],
    plate_light: [f64; 3],
    straight: Spread,
    swapped: Spread,
}

impl Evidence {
    /// Sums over at most some 65,536 of the pixels; `gain` is the gain from plate to picture.
    #[must_use]
    pub(crate) fn of(pixels: impl ExactSizeIterator<Item = PixelEvidence>, gain: &[f32; 4]) -> Self {
        let step = pixels.len().div_ceil(MOST_PIXELS).max(1);
        let mut sums = Self {
            step,
            ..Self::default()
        };
        pixels.step_by(step).for_each(|pixel| sums.add(&pixel, gain));
        sums
    }

    fn add(&mut self, pixel: &PixelEvidence, gain: &[f32; 4]) {
        let [seen, of_toy, _, kept] = pixel.validity;
        let [r, g, b, alpha] = pixel.plate;
        // Also if the shadow is withheld from all but the first fit; things have no such mark.
        if seen > 0.0 || is_withheld(kept) {
            self.hidden += f64::from(1.0 - pixel.visibility);
        }
        if alpha < 1.0 {
            return;
        }
        let (frame, plate) = (pixel.frame, [r, g, b]);
        if of_toy > 0.0 {
            let lit = [r * gain[0], g * gain[1], b * gain[2]];
            self.toy.add(is_same(frame, lit));
            for channel in 0..3 {
                self.toy_light[channel] += f64::from(frame[channel]);
                self.plate_light[channel] += f64::from(lit[channel]);
            }
        }
        if seen == 0.0 {
            return;
        }
        self.receiver.add(!is_readable(plate));
        if is_readable(plate) && pixel.visibility < SHADOW {
            self.shadow.add(!is_readable(frame));
        }
        let is_usable = frame.iter().chain(&plate).all(|value| USABLE.contains(value));
        if is_usable && pixel.visibility > LIT {
            self.straight.add(frame, plate);
            self.swapped.add(frame, [b, g, r]);
        }
    }

    /// Number of receiver pixels in the real shadow, each weighted by the hidden share of a light.
    #[must_use]
    pub(crate) fn n_shadow_pixels(&self) -> f64 {
        let step = self.step as f64;
        step * self.hidden
    }

    /// Share of the receivers' pixels where the plate is too dark or too bright in every channel.
    #[must_use]
    pub(crate) fn unreadable_plate(&self) -> Option<f64> {
        self.receiver.value()
    }

    /// The same share in the picture, within the real shadow, for usable pixels of the plate.
    #[must_use]
    pub(crate) fn unreadable_shadow(&self) -> Option<f64> {
        self.shadow.value()
    }

    /// Share of the real toy's pixels that show just the plate.
    #[must_use]
    pub(crate) fn toy_as_plate(&self) -> Option<f64> {
        self.toy.value()
    }

    /// Light of the toy relative to that of the plate behind it, by channel.
    #[must_use]
    pub(crate) fn toy_over_plate(&self) -> Option<[f64; 3]> {
        let is_known = self.toy.value().is_some() && self.plate_light.iter().all(|light| *light > 0.0);
        is_known.then(|| [0, 1, 2].map(|channel| self.toy_light[channel] / self.plate_light[channel]))
    }

    /// Difference in colour of lit pixels between picture and plate: the standard deviation of
    /// ln(frame / plate) over pixels and channels, unchanged and with red and blue of the plate
    /// swapped. It does not depend on exposure.
    #[must_use]
    pub(crate) fn color_spreads(&self) -> Option<[f64; 2]> {
        Some([self.straight.value()?, self.swapped.value()?])
    }
}

/// Share of a number of pixels that have a property.
#[derive(Clone, Debug, Default)]
struct Share {
    n: usize,
    n_of_kind: usize,
}

impl Share {
    fn add(&mut self, is_of_kind: bool) {
        self.n += 1;
        self.n_of_kind += usize::from(is_of_kind);
    }

    fn value(&self) -> Option<f64> {
        (self.n >= FEWEST_PIXELS).then(|| self.n_of_kind as f64 / self.n as f64)
    }
}

/// Standard deviation of logarithms of ratios.
#[derive(Clone, Debug, Default)]
struct Spread {
    n: usize,
    sum: f64,
    sum_of_squares: f64,
}

impl Spread {
    fn add(&mut self, frame: [f32; 3], plate: [f32; 3]) {
        for (frame, plate) in frame.into_iter().zip(plate) {
            let ratio = f64::from(frame / plate).ln();
            self.n += 1;
            self.sum += ratio;
            self.sum_of_squares += ratio * ratio;
        }
    }

    fn value(&self) -> Option<f64> {
        let n = (self.n >= 3 * FEWEST_PIXELS).then_some(self.n as f64)?;
        let mean = self.sum / n;
        Some((self.sum_of_squares / n - mean * mean).max(0.0).sqrt())
    }
}

/// Whether alpha of `validity` is that of a pixel that `withhold` took out: 0, or a half beside the
/// toy, which is a whole code.
fn is_withheld(alpha: f32) -> bool {
    const HALF_A_CODE: f32 = 0.5 / 255.0;
    alpha < HALF_A_CODE || (alpha - 0.5).abs() < 1.5 * HALF_A_CODE
}

fn is_readable(color: [f32; 3]) -> bool {
    color.iter().any(|value| USABLE.contains(value))
}

fn is_same(frame: [f32; 3], plate: [f32; 3]) -> bool {
    let mut channels = frame.iter().zip(plate);
    channels.all(|(frame, plate)| (frame - plate).abs() <= SAME_AS_PLATE * plate.max(DARKEST_USABLE))
}

/// Linear colours of a rectangle of a picture, row by row.
pub(crate) fn linear_colors(image: &Image, rect: &PixelRect) -> Vec<[f32; 3]> {
    let (min, max) = (rect.origin_px, rect.origin_px + rect.size_px);
    let linear_of_code = linear_of_codes();
    let texels = (min.y..max.y).flat_map(|y| (min.x..max.x).map(move |x| (x, y)));
    let color = |(x, y): (u32, u32)| {
        let first = 4 * (y as usize * image.width_px as usize + x as usize);
        [0, 1, 2].map(|channel| linear_of_code[usize::from(image.rgba8[first + channel])])
    };
    texels.map(color).collect()
}
