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
