//! Resampling of pictures in linear light.

use glam::DVec2;

use crate::geometry::color::{code_of_linear, linear_of_codes};
use crate::scene::Image;

/// Side of the square of pixels in a sample's sum.
const SIDE: usize = 4;
/// Relative change of light above which another surface may be visible.
const ANOTHER_SURFACE: f32 = 0.25;

/// The centre of each pixel of a picture, rows from the top.
fn places(image: &Image) -> impl Iterator<Item = DVec2> {
    let (width, height) = (image.width_px, image.height_px);
    (0..height).flat_map(move |y| (0..width).map(move |x| DVec2::new(f64::from(x), f64::from(y)) + 0.5))
}

/// Resamples the picture at `from` of each pixel, in pixels of the same picture. Border pixels are
/// repeated outside.
pub fn resampled(image: &Image, from: impl Fn(DVec2) -> DVec2) -> Image {
    let linear = linear_of_codes();
    let mut rgba8 = Vec::with_capacity(image.rgba8.len());
    for at_px in places(image) {
        let around = Around::new(image, from(at_px));
        rgba8.extend(around.sum(image, &linear).map(code_of_linear));
        rgba8.push(u8::MAX);
    }
    Image { rgba8, ..*image }
}

/// The picture with each pixel the nearest one at `from`, in pixels of the same picture; all zero
/// outside.
pub(super) fn nearest(image: &Image, from: impl Fn(DVec2) -> DVec2) -> Image {
    let size = DVec2::new(f64::from(image.width_px), f64::from(image.height_px));
    let pixels = places(image).map(|place| {
        let at = from(place).floor();
        if at.cmplt(DVec2::ZERO).any() || at.cmpge(size).any() {
            return [0; 4];
        }
        let at = at.as_uvec2();
        let first = 4 * (at.y as usize * image.width_px as usize + at.x as usize);
        image.rgba8[first..first + 4].try_into().unwrap_or_default()
    });
    let rgba8 = pixels.flatten().collect();
    Image { rgba8, ..*image }
}

/// The photograph with the difference of two pictures, resampled at `from` of each pixel.
pub(super) fn with_changes(
    photograph: &Image,
    [before, after]: [&Image; 2],
    from: impl Fn(DVec2) -> DVec2,
) -> Image {
    let linear = linear_of_codes();
    let mut made = photograph.clone();
    for (texel, at_px) in made.rgba8.chunks_exact_mut(4).zip(places(photograph)) {
        let around = Around::new(after, from(at_px));
        if around.is_outside || around.is_same(before, after) {
            continue;
        }
        let [was, is] = [before, after].map(|image| around.sum(image, &linear));
        let kept = kept(was, is);
        for channel in 0..3 {
            let lost = linear[usize::from(texel[channel])] - was[channel];
            texel[channel] = code_of_linear(is[channel] + kept * lost);
        }
    }
    made
}

/// The share of the resampling loss that is restored, by the change of light in the channels: all
/// of it for unchanged pixels, and nothing if another surface may be visible, on which it would
/// draw the old surface's outline.
fn kept(was: [f32; 3], is: [f32; 3]) -> f32 {
    let change = |channel: usize| {
        let most = was[channel].max(is[channel]);
        if most > 0.0 {
            (is[channel] - was[channel]).abs() / most
        } else {
            0.0
        }
    };
    let most = change(0).max(change(1)).max(change(2));
    (1.0 - most / ANOTHER_SURFACE).max(0.0)
}

/// The pixels around a place and their weights: cubic convolution (Keys 1981, a = -1/2), with
/// repeated border pixels.
struct Around {
    columns: [(usize, f32); SIDE],
    rows: [(usize, f32); SIDE],
    is_outside: bool,
}

impl Around {
    fn new(image: &Image, at_px: DVec2) -> Self {
        let size_px = DVec2::new(f64::from(image.width_px), f64::from(image.height_px));
        Self {
            columns: line(at_px.x, image.width_px),
            rows: line(at_px.y, image.height_px),
            is_outside: at_px.cmplt(DVec2::ZERO).any() || at_px.cmpgt(size_px).any(),
        }
    }

    fn texels(&self, width_px: u32) -> impl Iterator<Item = (usize, f32)> {
        let rows = self.rows.into_iter();
        let columns = self.columns;
        rows.flat_map(move |(y, of_row)| {
            columns.map(|(x, of_column)| (4 * (y * width_px as usize + x), of_row * of_column))
        })
    }

    fn is_same(&self, before: &Image, after: &Image) -> bool {
        self.texels(before.width_px)
            .all(|(at, _)| before.rgba8[at..at + 3] == after.rgba8[at..at + 3])
    }

    fn sum(&self, image: &Image, linear: &[f32; 256]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (at, weight) in self.texels(image.width_px) {
            for (sum, code) in sum.iter_mut().zip(&image.rgba8[at..at + 3]) {
                *sum += weight * linear[usize::from(*code)];
            }
        }
        sum
    }
}

/// Four pixels of a row or column around a place, and their weights, which sum to 1.
fn line(at_px: f64, n_pixels: u32) -> [(usize, f32); SIDE] {
    let last = f64::from(n_pixels) - 1.0;
    let first = (at_px - 0.5).floor();
    #[allow(clippy::cast_possible_truncation, reason = "weights, from -1 to 1")]
    let t = (at_px - 0.5 - first) as f32;
    let weights = [
        ((-0.5 * t + 1.0) * t - 0.5) * t,
        (1.5 * t - 2.5) * t * t + 1.0,
        ((-1.5 * t + 2.0) * t + 0.5) * t,
        (0.5 * t - 0.5) * t * t,
    ];
    let steps = [-1.0, 0.0, 1.0, 2.0];
    #[allow(clippy::cast_possible_truncation, reason = "a pixel's index")]
    let index = |step: f64| (first + step).clamp(0.0, last) as usize;
    [0, 1, 2, 3].map(|i| (index(steps[i]), weights[i]))
}
