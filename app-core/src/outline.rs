//! What bounds a toy over a whole clip, from whatever camera or light: its farthest points by direction.

use glam::{DVec2, DVec3};

/// Bins along each side of each of the six faces of the cube of directions.
const N_SIDE_BINS: usize = 8;
const N_BINS: usize = 6 * N_SIDE_BINS * N_SIDE_BINS;
/// What a point that its bin has no room for can lie outside of the points that are kept, relative to their distance from
/// the middle: 1 - cos of half a bin's diagonal, rounded up.
const SLACK: f64 = 0.02;

/// A few hundred points whose hull holds all that were included.
#[derive(Clone, Debug)]
pub struct Outline {
    middle: DVec3,
    /// Offset from the middle of the farthest point of each bin; zero where there is none.
    farthest: Vec<DVec3>,
}

impl Outline {
    /// Starts empty; `middle` is somewhere in the toy.
    #[must_use]
    pub fn new(middle: DVec3) -> Self {
        Self {
            middle,
            farthest: vec![DVec3::ZERO; N_BINS],
        }
    }

    /// Takes in a point.
    pub fn include(&mut self, point: DVec3) {
        let offset = point - self.middle;
        let slot = &mut self.farthest[bin(offset)];
        if offset.length_squared() > slot.length_squared() {
            *slot = offset;
        }
    }

    /// The points that bound it.
    pub fn points(&self) -> impl Iterator<Item = DVec3> + '_ {
        let offsets = self.farthest.iter().filter(|offset| **offset != DVec3::ZERO);
        offsets.map(|offset| self.middle + (1.0 + SLACK) * *offset)
    }
}

/// The bin of a direction: the face that it goes through, and where.
fn bin(offset: DVec3) -> usize {
    let size = offset.abs();
    let (axis, along, across) = if size.x >= size.y && size.x >= size.z {
        (0, offset.x, DVec2::new(offset.y, offset.z))
    } else if size.y >= size.z {
        (1, offset.y, DVec2::new(offset.z, offset.x))
    } else {
        (2, offset.z, DVec2::new(offset.x, offset.y))
    };
    if along == 0.0 {
        return 0;
    }
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "from 0 to a handful; what is not a number becomes 0"
    )]
    let cell = |at: f64| ((0.5 * (at / along + 1.0) * N_SIDE_BINS as f64) as usize).min(N_SIDE_BINS - 1);
    let face = 2 * axis + usize::from(along < 0.0);
    (face * N_SIDE_BINS + cell(across.x)) * N_SIDE_BINS + cell(across.y)
}
