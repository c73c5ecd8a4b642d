//! A deterministic random number generator.

use std::f64::consts::TAU;

use app_core::card::SplitMix;
use glam::DVec3;

/// Random numbers from a seed.
#[derive(Clone, Debug)]
pub struct Random {
    mix: SplitMix,
}

impl Random {
    /// A generator with a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self {
            mix: SplitMix::new(seed),
        }
    }

    /// A number from 0 to 1, without 0.
    pub fn uniform(&mut self) -> f64 {
        self.mix.uniform()
    }

    /// A number of the normal distribution. Source: Box and Muller 1958.
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
    }

    /// A unit vector in a random direction.
    pub fn direction(&mut self) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.normal())).normalize_or(DVec3::Y)
    }
}
