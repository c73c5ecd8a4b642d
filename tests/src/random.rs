//! Numbers by chance that are the same wherever they are drawn.

use std::f64::consts::TAU;

use glam::DVec3;

/// Draws from one seed, always the same ones.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// From a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// From 0 to 1, without 0. Source: Steele, Lea and Flood 2014 (SplitMix).
    pub fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^= z >> 31;
        #[allow(clippy::cast_precision_loss, reason = "53 bits are kept")]
        let unit = ((z >> 11) + 1) as f64 / (1u64 << 53) as f64;
        unit
    }

    /// Of the normal distribution. Source: Box and Muller 1958.
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
    }

    /// A unit vector in any direction.
    pub fn direction(&mut self) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.normal())).normalize_or(DVec3::Y)
    }
}
