//! The difference of two pictures, in sRGB codes over the three colours.

use app_core::scene::Image;

/// Differences of two pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gap {
    /// Root of the mean square.
    pub rms: f64,
    /// The difference that one in a thousand pixels exceeds, by its worst colour.
    pub p999: f64,
    /// The largest.
    pub max: f64,
    /// Number of bytes that are not equal.
    pub n_bytes: f64,
}

impl Gap {
    /// Compares pictures of one size; the difference of other pictures is infinite.
    #[must_use]
    pub fn between(a: &Image, b: &Image) -> Self {
        if a.rgba8.len() != b.rgba8.len() || a.width_px != b.width_px {
            let none = f64::INFINITY;
            return Self {
                rms: none,
                p999: none,
                max: none,
                n_bytes: none,
            };
        }
        let pixels = a.rgba8.chunks_exact(4).zip(b.rgba8.chunks_exact(4));
        let mut worst = Vec::with_capacity(a.rgba8.len() / 4);
        let mut squares = 0.0;
        let mut n_bytes = 0;
        for (a, b) in pixels {
            let codes = [0, 1, 2].map(|channel| a[channel].abs_diff(b[channel]));
            worst.push(codes.into_iter().max().unwrap_or(0));
            squares += codes.iter().map(|code| f64::from(*code).powi(2)).sum::<f64>();
            n_bytes += (0..4).filter(|byte| a[*byte] != b[*byte]).count();
        }
        worst.sort_unstable();
        let rank = worst.len() - worst.len().div_ceil(1000);
        let (n_values, n_bytes) = (3.0 * worst.len() as f64, n_bytes as f64);
        Self {
            rms: (squares / n_values).sqrt(),
            p999: worst.get(rank).copied().map_or(0.0, f64::from),
            max: worst.last().copied().map_or(0.0, f64::from),
            n_bytes,
        }
    }
}
