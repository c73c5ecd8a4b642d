//! Encoding of camera pictures as files.

use std::fmt;

use glam::UVec2;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::error::WriteError;
use crate::tags::{JPEG_MAGIC, PNG_MAGIC};
use app_scene::camera_frame::CameraImage;
use app_scene::depth::Depth;
use app_scene::people::People;
use app_scene::scene::Image;

/// A platform's own encoder: from a camera picture to the bytes of a PNG or JPEG file, or `None` if
/// it fails.
pub type PlatformEncoder = Box<dyn FnMut(&CameraImage) -> Option<Vec<u8>> + Send>;

/// Quality of JPEG files that are written on a phone.
const PHONE_QUALITY: u8 = 95;

/// Encoding of camera pictures as files.
#[derive(Default)]
pub enum PictureCodec {
    /// PNG: lossless.
    #[default]
    Lossless,
    /// JPEG.
    Jpeg {
        /// From 1 to 100; the page on recordings lists the error of each.
        quality: u8,
    },
    /// The platform's encoder, for example in hardware; pictures that it cannot encode are written
    /// as by [`PictureCodec::PHONE`].
    Platform(PlatformEncoder),
}

impl PictureCodec {
    /// For phones, on which lossless files would be too slow to write.
    pub const PHONE: Self = Self::Jpeg {
        quality: PHONE_QUALITY,
    };

    /// Encodes a picture as a file.
    pub(super) fn encode(&mut self, image: &CameraImage) -> Result<Vec<u8>, WriteError> {
        match self {
            Self::Lossless => png(image.rgba()),
            Self::Jpeg { quality } => jpeg(image.rgba(), *quality),
            Self::Platform(encode) => match encode(image).filter(|file| is_picture(file)) {
                Some(file) => Ok(file),
                None => jpeg(image.rgba(), PHONE_QUALITY),
            },
        }
    }
}

impl fmt::Debug for PictureCodec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lossless => f.write_str("Lossless"),
            Self::Jpeg { quality } => write!(f, "Jpeg({quality})"),
            Self::Platform(_) => f.write_str("Platform"),
        }
    }
}

/// Whether the file begins like a picture of a supported format.
fn is_picture(file: &[u8]) -> bool {
    file.starts_with(JPEG_MAGIC) || file.starts_with(PNG_MAGIC)
}

/// A photograph as PNG without alpha.
pub(super) fn png(image: &Image) -> Result<Vec<u8>, WriteError> {
    let mut file = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive);
    write(encoder, image)?;
    Ok(file)
}

/// Depths as a grey PNG of 16 bit, in millimetres.
pub(super) fn depth_png(depth: &Depth) -> Result<Vec<u8>, WriteError> {
    // The encoder takes the processor's order of bytes.
    let bytes: Vec<u8> = depth
        .depths_mm()
        .iter()
        .flat_map(|depth_mm| depth_mm.to_ne_bytes())
        .collect();
    grey_png(depth.size_px(), &bytes, ExtendedColorType::L16)
}

/// A mask of people as a grey PNG of 8 bit.
pub(super) fn people_png(people: &People) -> Result<Vec<u8>, WriteError> {
    grey_png(people.size_px(), people.codes(), ExtendedColorType::L8)
}

fn grey_png(size_px: UVec2, bytes: &[u8], kind: ExtendedColorType) -> Result<Vec<u8>, WriteError> {
    let mut file = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive);
    encoder
        .write_image(bytes, size_px.x, size_px.y, kind)
        .map_err(|error| WriteError::Picture(error.to_string()))?;
    Ok(file)
}

fn jpeg(image: &Image, quality: u8) -> Result<Vec<u8>, WriteError> {
    let mut file = Vec::new();
    write(
        JpegEncoder::new_with_quality(&mut file, quality.clamp(1, 100)),
        image,
    )?;
    Ok(file)
}

fn write(encoder: impl ImageEncoder, image: &Image) -> Result<(), WriteError> {
    let texels = image.rgba8.chunks_exact(4);
    let rgb8: Vec<u8> = texels.flat_map(|texel| [texel[0], texel[1], texel[2]]).collect();
    let n_bytes = 3 * u64::from(image.width_px) * u64::from(image.height_px);
    // The encoders panic for a buffer of another size.
    if rgb8.len() as u64 != n_bytes {
        let reason = format!("{} bytes, not {n_bytes}", rgb8.len());
        return Err(WriteError::Picture(reason));
    }
    encoder
        .write_image(&rgb8, image.width_px, image.height_px, ExtendedColorType::Rgb8)
        .map_err(|error| WriteError::Picture(error.to_string()))
}
