//! Readback of intermediate maps, for reports and tests.

pub(crate) mod decoding;
pub mod inject;
pub mod layers;

use wgpu::TextureFormat;

use crate::gpu::{Gpu, GpuError};
use app_scene::geometry::color::linear_from_srgb;

/// An intermediate map of the pipeline over the work region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Map {
    /// r is 1 where the frame shows the receiver alone, g where it shows a single surface of the
    /// toy, b where it shows the receiver far enough from the toy.
    Validity,
    /// Base colour of the physical toy, linear; alpha is the part of its surface's view above the horizon.
    GbufferBase,
    /// Cosine to each light times its visibility, on the physical toy, light 0 in r.
    GbufferReceived,
    /// The toy's own colours, linear, extrapolated beyond its outline; alpha is 1 where there is
    /// one.
    Appearance,
    /// Visibility of each light with the physical toy, light 0 in r.
    PhysicalVisibility,
    /// Visibility of the ambient light with the physical toy, in r, at a fraction of the region's size.
    PhysicalAmbient,
    /// Visibility of each light with the shown toy, light 0 in r.
    Visibility,
    /// Visibility of the ambient light with the shown toy, in r, at a fraction of the region's size.
    Ambient,
    /// Fraction of each pixel that the shown toy covers, in r.
    Coverage,
    /// The plate as this camera would have taken it, linear; alpha is 1 where it was photographed, 0 where there is
    /// none.
    Plate,
    /// The filled grid of residuals on the first receiver in rgb, in units of the plate; alpha is
    /// 1.
    Residual,
    /// Direct fraction f of the plate's radiance, of all lights together, in rgb, at the ambient
    /// maps' size; 0 outside the receiver.
    DirectFraction,
    /// The paper's mask 3a, the physical toy, in r.
    Masks,
    /// The paper's masks: r labels the shadow that is sampled (3c), g is 1 in the real shadow (3b).
    /// A label is 16 times the receiver plus the set of hidden lights, bit i for light i; 0 where
    /// nothing is sampled.
    Eligible,
    /// The paper's warp: the sampled position, in region pixels, and the occluder's height in
    /// metres; alpha is coverage. The maps of several lights follow one another from top to bottom.
    Warp,
    /// Shadow terms before filtering; alpha is the label of their shadow, 0 where there is none.
    Terms,
    /// Sums of shadow terms over the box; alpha is their number. The maps of several sets of
    /// lights, from set 1 on, follow one another from top to bottom.
    FilteredTerms,
    /// Number of candidates that the ring search tested, in r; 0 where it was not needed.
    SearchTaps,
}

impl Map {
    /// All maps.
    pub const ALL: &[Self] = &[
        Self::Validity,
        Self::GbufferBase,
        Self::GbufferReceived,
        Self::Appearance,
        Self::PhysicalVisibility,
        Self::PhysicalAmbient,
        Self::Visibility,
        Self::Ambient,
        Self::Coverage,
        Self::Plate,
        Self::Residual,
        Self::DirectFraction,
        Self::Masks,
        Self::Eligible,
        Self::Warp,
        Self::Terms,
        Self::FilteredTerms,
        Self::SearchTaps,
    ];
}

/// Numbers over a rectangle, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatMap {
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` texels; channels that the map does not have are 0, alpha 1.
    pub texels: Vec<[f32; 4]>,
}

/// Waits for the device and returns a texture as numbers.
pub(crate) fn read_texture(gpu: &Gpu, texture: Option<&wgpu::Texture>) -> Result<FloatMap, GpuError> {
    let texture = texture.ok_or_else(GpuError::no_device)?;
    let bytes = gpu.read_texture(Some(texture))?;
    let format = texture.format();
    let n_channels = usize::from(format.components());
    let values: Vec<f32> = match format {
        TextureFormat::R16Float | TextureFormat::Rg16Float | TextureFormat::Rgba16Float => bytes
            .chunks_exact(2)
            .map(|b| f32_from_f16(u16::from_le_bytes([b[0], b[1]])))
            .collect(),
        TextureFormat::Rgba32Float => bytes
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect(),
        TextureFormat::Rgba8UnormSrgb => bytes
            .iter()
            .enumerate()
            .map(|(i, code)| {
                let encoded = f32::from(*code) / 255.0;
                if i % 4 == 3 {
                    encoded
                } else {
                    linear_from_srgb(encoded)
                }
            })
            .collect(),
        TextureFormat::Rg8Uint => bytes.iter().map(|number| f32::from(*number)).collect(),
        _ => bytes.iter().map(|code| f32::from(*code) / 255.0).collect(),
    };
    let texels = values
        .chunks_exact(n_channels)
        .map(|channels| {
            let mut texel = [0.0, 0.0, 0.0, 1.0];
            texel[..n_channels].copy_from_slice(channels);
            texel
        })
        .collect();
    Ok(FloatMap {
        width: texture.width(),
        height: texture.height() * texture.depth_or_array_layers(),
        texels,
    })
}

/// Converts an IEEE 754 half to f32.
fn f32_from_f16(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let exponent = i32::from((bits >> 10) & 0x1f);
    let fraction = f32::from(bits & 0x3ff) / 1024.0;
    sign * match exponent {
        0 => fraction * 2f32.powi(-14),
        31 if fraction == 0.0 => f32::INFINITY,
        31 => f32::NAN,
        _ => (1.0 + fraction) * 2f32.powi(exponent - 15),
    }
}
