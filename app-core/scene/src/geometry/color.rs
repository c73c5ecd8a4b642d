//! The transfer function of sRGB.

/// Encodes a linear value in [0, 1]. Source: IEC 61966-2-1.
#[must_use]
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    }
}

/// Decodes an sRGB value in [0, 1]. Source: IEC 61966-2-1.
#[must_use]
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// The code of 8 bits nearest to linear light; light brighter than white becomes white.
#[must_use]
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 0 to 255"
)]
pub fn code_of_linear(linear: f32) -> u8 {
    (255.0 * srgb_from_linear(linear.clamp(0.0, 1.0))).round() as u8
}

/// The codes of linear light by a table: as [`code_of_linear`], for many pixels.
pub struct CodesOfLinear {
    /// The most light of each code but the last.
    ends: [f32; 255],
}

impl CodesOfLinear {
    /// The table.
    #[must_use]
    pub fn new() -> Self {
        // A code covers half the distance to its neighbours.
        let end = |code: usize| linear_from_srgb((code as f32 + 0.5) / 255.0);
        Self {
            ends: std::array::from_fn(end),
        }
    }

    /// The code nearest to light.
    #[must_use]
    pub fn code(&self, linear: f32) -> u8 {
        u8::try_from(self.ends.partition_point(|end| *end < linear)).unwrap_or(u8::MAX)
    }
}

impl Default for CodesOfLinear {
    fn default() -> Self {
        Self::new()
    }
}

/// The derivative of [`linear_from_srgb`] at a linear value in [0, 1]: linear light per unit of the
/// encoded value.
#[must_use]
pub fn linear_per_srgb(linear: f32) -> f32 {
    if linear <= 0.003_130_8 {
        1.0 / 12.92
    } else {
        2.4 / 1.055 * linear.powf(1.4 / 2.4)
    }
}

/// Linear light of each code of 8 bits.
#[must_use]
pub fn linear_of_codes() -> [f32; 256] {
    let mut linear = [0.0; 256];
    for (code, linear) in (0..=u8::MAX).zip(&mut linear) {
        *linear = linear_from_srgb(f32::from(code) / 255.0);
    }
    linear
}
