//! Injected visibilities, which replace those that the passes compute.

use crate::gpu::{Gpu, Texture};
use crate::readback::FloatMap;

/// Maps of the work region with the visibility of each light, light 0 in r, each in [0, 1].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InjectedVisibility {
    /// Visibility with the physical toy; `None` keeps that of the passes.
    pub physical: Option<FloatMap>,
    /// Visibility with the shown toy; `None` keeps that of the passes.
    pub shown: Option<FloatMap>,
}

/// The same, on the device.
#[derive(Debug, Default)]
pub(crate) struct Injected {
    pub(crate) physical: Option<Texture>,
    pub(crate) shown: Option<Texture>,
}

/// A texture of the size and format of `like`, in f16 or in fractions of 8 bits, with the values of `map`.
pub(crate) fn upload(gpu: &Gpu, map: &FloatMap, like: &Texture) -> Texture {
    let format = like.format();
    let size_px = like.size_px();
    let texture = Texture::target(gpu, "injected visibility", size_px, format);
    let n_channels = usize::from(format.components());
    let values = map.texels.iter().flat_map(|texel| &texel[..n_channels]);
    let values = values.map(|value| value.clamp(0.0, 1.0));
    let is_half = format.block_copy_size(None) == Some(2 * u32::from(format.components()));
    #[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
    let texels: Vec<u8> = if is_half {
        values
            .flat_map(|value| f16_from_f32(value).to_le_bytes())
            .collect()
    } else {
        values.map(|value| (255.0 * value).round() as u8).collect()
    };
    texture.write(gpu, &texels);
    texture
}

/// The IEEE 754 half nearest to a number in [0, 1].
fn f16_from_f32(value: f32) -> u16 {
    const SMALLEST_NORMAL: f32 = 1.0 / 16384.0;
    #[allow(clippy::cast_possible_truncation, reason = "at most 0x3c00")]
    if value < SMALLEST_NORMAL {
        (value * 16_777_216.0).round() as u16
    } else {
        // Exponents are biased by 127 and 15; half of the last place rounds.
        ((value.to_bits() + 0x1000 - (112 << 23)) >> 13) as u16
    }
}
