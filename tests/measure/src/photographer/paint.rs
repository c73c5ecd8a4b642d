//! Colours of a receiver's surface.

use std::f64::consts::TAU;

use app_core::scene::Surface;
use glam::{DVec2, DVec3};

/// Reflectance of a receiver, linear, at each of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    /// One colour.
    Even(DVec3),
    /// A smoothly varying colour.
    Waves {
        /// Its mean.
        color: DVec3,
        /// Largest relative change.
        amount: f64,
        /// Length of a wave along both axes.
        wave_m: f64,
    },
    /// A chessboard of two colours.
    Tiles {
        /// The colours.
        colors: [DVec3; 2],
        /// Side of a square.
        side_m: f64,
    },
}

impl Paint {
    /// The colour at (x, z).
    #[must_use]
    pub fn at(&self, in_plane: DVec2) -> DVec3 {
        match *self {
            Self::Even(color) => color,
            Self::Waves {
                color,
                amount,
                wave_m,
            } => {
                let phase = TAU * in_plane / wave_m;
                color * (1.0 + amount * phase.x.sin() * phase.y.cos())
            }
            Self::Tiles { colors, side_m } => {
                let cell = (in_plane / side_m).floor();
                let is_odd = (cell.x + cell.y).rem_euclid(2.0) >= 1.0;
                colors[usize::from(is_odd)]
            }
        }
    }

    /// The surface as a scene describes it.
    #[must_use]
    pub fn surface(&self) -> Surface {
        match self {
            Self::Even(_) => Surface::Uniform,
            Self::Waves { .. } | Self::Tiles { .. } => Surface::Textured,
        }
    }
}
