//! CPU reference of `common/grain`: the noise of synthesised pixels.

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
