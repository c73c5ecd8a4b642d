//! Resamples a photograph to a camera beside its own: once, with hardly any loss of detail.
//!
//! The kernel is the cardinal spline of degree 5: the spline interpolates the picture's pixels, so
//! that an unmoved picture stays the same, and up to four fifths of the highest frequency hardly
//! anything is lost. Source: Unser, Aldroubi and Eden, "B-spline signal processing", 1993.

use glam::{DMat3, DVec2};

use super::light::LightPicture;

/// The poles of the filter from pixels to coefficients, for degree 5.
const POLES: [f64; 2] = [-0.430_575_347_099_973_8, -0.043_096_288_203_264_65];
/// The product of (1 - pole) (1 - 1 / pole) over the poles.
const GAIN: f64 = 120.0;
/// Number of coefficients per sample, along each axis.
const N_TAPS: usize = 6;

/// The picture whose pixel (u, v) is the pixel of `picture` at `from_px`, a homography, of (u, v).
/// Places outside of the picture are mirrored.
#[must_use]
pub fn resampled(picture: &LightPicture, from_px: &DMat3) -> LightPicture {
    let coefficients = coefficients(picture);
    let mut rgb = Vec::with_capacity(picture.rgb.len());
    for y in 0..picture.height_px {
        for x in 0..picture.width_px {
            let at = DVec2::new(x as f64, y as f64) + 0.5;
            let from = *from_px * at.extend(1.0);
            let from = if from.z.abs() > f64::EPSILON {
                from.truncate() / from.z
            } else {
                at
            };
            rgb.push(sampled(picture, &coefficients, from - 0.5));
        }
    }
    LightPicture { rgb, ..*picture }
}

/// Weights of the spline around a place `t` beyond the third tap, from 0 to 1.
fn weights(t: f64) -> [f64; N_TAPS] {
    let spline = |x: f64| {
        let term = |edge: f64| (edge - x.abs()).max(0.0).powi(5);
        (term(3.0) - 6.0 * term(2.0) + 15.0 * term(1.0)) / 120.0
    };
    [2.0, 1.0, 0.0, -1.0, -2.0, -3.0].map(|tap: f64| spline(t + tap))
}

/// An index mirrored at the first and the last pixel.
fn mirrored(at: i64, n: usize) -> usize {
    let last = i64::try_from(n.saturating_sub(1)).unwrap_or(0);
    if last == 0 {
        return 0;
    }
    let at = at.rem_euclid(2 * last);
    usize::try_from(at.min(2 * last - at)).unwrap_or(0)
}

/// The spline at a place; (0, 0) is the centre of the first pixel. Not below 0 light.
fn sampled(picture: &LightPicture, coefficients: &[[f64; 3]], at: DVec2) -> [f32; 3] {
    let (width, height) = (picture.width_px, picture.height_px);
    // A place far outside, or NaN, becomes the border's.
    let at = at
        .max(DVec2::splat(-8.0))
        .min(DVec2::new(width as f64, height as f64) + 8.0);
    let first = at.floor();
    let [columns, rows] = (at - first).to_array().map(weights);
    #[allow(
        clippy::cast_possible_truncation,
        reason = "clamped to the picture's size above"
    )]
    let first = first.to_array().map(|corner| corner as i64 - 2);
    let mut sum = [0.0; 3];
    for (y, row_weight) in (first[1]..).zip(rows) {
        let row = mirrored(y, height) * width;
        for (x, weight) in (first[0]..).zip(columns) {
            let value = coefficients[row + mirrored(x, width)];
            for channel in 0..3 {
                sum[channel] += row_weight * weight * value[channel];
            }
        }
    }
    #[allow(clippy::cast_possible_truncation, reason = "light of one picture")]
    let light = sum.map(|sum| sum.max(0.0) as f32);
    light
}

/// The coefficients of the spline that interpolates the pixels.
fn coefficients(picture: &LightPicture) -> Vec<[f64; 3]> {
    let (width, height) = (picture.width_px, picture.height_px);
    let mut values: Vec<[f64; 3]> = picture.rgb.iter().map(|pixel| pixel.map(f64::from)).collect();
    for row in 0..height {
        filter(&mut values, (row * width, 1, width));
    }
    for column in 0..width {
        filter(&mut values, (column, width, height));
    }
    values
}

/// Filters one line, mirrored at both ends: its first index, the step to the next and their number.
fn filter(values: &mut [[f64; 3]], (first, step, n): (usize, usize, usize)) {
    if n < 2 {
        return;
    }
    let mut line = vec![0.0; n];
    for channel in [0, 1, 2] {
        for (k, value) in line.iter_mut().enumerate() {
            *value = GAIN * values[first + k * step][channel];
        }
        POLES.iter().for_each(|pole| filter_line(&mut line, *pole));
        for (k, value) in line.iter().enumerate() {
            values[first + k * step][channel] = *value;
        }
    }
}

/// One pole's causal and anticausal filter, of two values or more.
fn filter_line(line: &mut [f64], pole: f64) {
    // The sum over all mirrored values; higher powers are below rounding.
    let mut power = 1.0;
    let mut start = 0.0;
    for value in line.iter().take(64) {
        start += power * value;
        power *= pole;
    }
    line[0] = start;
    for k in 1..line.len() {
        line[k] += pole * line[k - 1];
    }
    let last = line.len() - 1;
    line[last] = pole / (pole * pole - 1.0) * (line[last] + pole * line[last - 1]);
    for k in (0..last).rev() {
        line[k] = pole * (line[k + 1] - line[k]);
    }
}
