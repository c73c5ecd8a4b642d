//! CPU reference of `common/grain`, the noise of synthesised pixels, and of the plate that
//! `common/made_grain` smooths.

use glam::{DVec3, DVec4, IVec2, UVec2};

use crate::raster::Raster;

/// Four pseudo-random numbers from four counters. Source: Jarzynski and Olano 2020 (pcg4d).
fn hashed(seed: [u32; 4]) -> [u32; 4] {
    let mut v = seed.map(|number| number.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let stir = |v: &mut [u32; 4]| {
        for [to, a, b] in [[0, 1, 3], [1, 2, 0], [2, 0, 1], [3, 1, 2]] {
            v[to] = v[to].wrapping_add(v[a].wrapping_mul(v[b]));
        }
    };
    stir(&mut v);
    v = v.map(|number| number ^ (number >> 16));
    stir(&mut v);
    v
}

/// Four numbers of mean 0 and variance 1.
fn white(at: [i32; 2], picture: u32) -> [f64; 4] {
    let seed = [at[0].cast_unsigned(), at[1].cast_unsigned(), picture, 0];
    // The sum of two uniform numbers below 1 has a variance of 1 / 6.
    hashed(seed)
        .map(|bits| (f64::from(bits % 65536) + f64::from(bits / 65536) - 65535.0) / 65536.0 * 6.0_f64.sqrt())
}

/// Noise of a pixel's channels, of variance 1: the mean of white noise along rows and columns, with
/// these weights of the pixels one and two away, relative to the pixel's own; channels have the
/// correlation `channels`.
#[must_use]
pub fn grain_at(at: [i32; 2], picture: u32, [near, far]: [f64; 2], channels: f64) -> [f64; 3] {
    let weights = [(-2, far), (-1, near), (0, 1.0), (1, near), (2, far)];
    let squares: f64 = weights.iter().map(|(_, weight)| weight * weight).sum();
    let mut sum = [0.0; 4];
    for (dy, along_y) in weights {
        for (dx, along_x) in weights {
            let noise = white([at[0] + dx, at[1] + dy], picture);
            for (sum, noise) in sum.iter_mut().zip(noise) {
                *sum += along_x * along_y * noise / squares;
            }
        }
    }
    [0, 1, 2].map(|channel| (1.0 - channels).sqrt() * sum[channel] + channels.sqrt() * sum[3])
}

/// Variance of nine pixels over that of their noise below which they have no structure.
const STRUCTURE: f64 = 1.0;
/// Correlation of neighbours from which on the next but one pixels are taken.
const CORRELATED: f64 = 0.5;

/// A plate's pixel as eight around it smooth it, and the part of its noise's variance that is left;
/// `noise` is the variance at a light, and alpha is 1 where the plate was photographed.
#[must_use]
pub fn smoothed(
    plate: &Raster<DVec4>,
    at: UVec2,
    weights: [f64; 2],
    noise: impl Fn(f64) -> f64,
) -> (DVec3, f64) {
    let last = plate.size() - 1;
    let place = |offset: IVec2| {
        (at.as_ivec2() + offset)
            .clamp(IVec2::ZERO, last.as_ivec2())
            .as_uvec2()
    };
    let step = if correlation(IVec2::X, weights) > CORRELATED {
        2
    } else {
        1
    };
    let offsets: Vec<IVec2> = (0..9).map(|k| step * (IVec2::new(k % 3, k / 3) - 1)).collect();
    let pixels: Vec<DVec4> = offsets.iter().map(|offset| plate.at(place(*offset))).collect();
    let own = plate.at(at).truncate();
    if pixels.iter().any(|pixel| pixel.w != 1.0) {
        return (own, 1.0);
    }
    let mean = pixels.iter().map(|pixel| pixel.truncate()).sum::<DVec3>() / 9.0;
    let apart = |pixel: &DVec4| (pixel.truncate() - mean).length_squared();
    let seen = pixels.iter().map(apart).sum::<f64>() / 8.0;
    let mean_over = |of: &dyn Fn(IVec2) -> f64| offsets.iter().map(|offset| of(*offset)).sum::<f64>() / 9.0;
    let with_mean = mean_over(&|a| correlation(a, weights));
    let of_mean = mean_over(&|a| mean_over(&|b| correlation(a - b, weights)));
    let expected = mean.to_array().map(noise).iter().sum::<f64>() * (1.0 - of_mean) * 9.0 / 8.0;
    let kept = if seen > 0.0 {
        (1.0 - STRUCTURE * expected / seen).max(0.0)
    } else {
        0.0
    };
    let left = kept * kept + 2.0 * kept * (1.0 - kept) * with_mean + (1.0 - kept).powi(2) * of_mean;
    (kept * own + (1.0 - kept) * mean, left)
}

/// Correlation of two pixels of the noise, by the positions that both average.
fn correlation(apart: IVec2, [near, far]: [f64; 2]) -> f64 {
    let weight = |place: i32| match place.abs() {
        0 => 1.0,
        1 => near,
        2 => far,
        _ => 0.0,
    };
    let along = |apart: i32| {
        (-2..=2)
            .map(|place| weight(place) * weight(place + apart))
            .sum::<f64>()
    };
    apart
        .to_array()
        .map(|apart| along(apart) / along(0))
        .iter()
        .product()
}
