//! Numbers by chance that are the same wherever they are drawn.

use std::f64::consts::TAU;

use app_core::card::SplitMix;
use glam::DVec3;

/// Draws from one seed, always the same ones.
#[derive(Clone, Debug)]
pub struct Random {
    mix: SplitMix,
}

impl Random {
    /// From a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            mix: SplitMix::new(seed),
        }
    }

    /// From 0 to 1, without 0.
    pub fn uniform(&mut self) -> f64 {
        self.mix.uniform()
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
