//! Pseudo-random numbers over rectangles, which are the same in every run.

use glam::{DVec4, UVec2};
use reference::raster::Raster;

/// A pseudo-random number from 0 to 1, in steps of 2^-16 so that 32 bits represent it. Source: the
/// hash "pcg" of Jarzynski and Olano 2020.
pub(crate) fn number(at: UVec2, seed: u32) -> f64 {
    let state = (at.x + 4096 * at.y + (seed << 24))
        .wrapping_mul(747_796_405)
        .wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    f64::from(((word >> 22) ^ word) >> 16) / 65536.0
}

/// Four such numbers per texel.
pub(crate) fn numbers(size: UVec2, seed: u32) -> Raster<DVec4> {
    Raster::from_fn(size, |at| {
        DVec4::from([0, 1, 2, 3].map(|k| number(at, 4 * seed + k)))
    })
}
