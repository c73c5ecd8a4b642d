//! How camera pictures become files.

use std::fmt;

use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

use super::error::WriteError;
use crate::tags::{JPEG_MAGIC, PNG_MAGIC};
use app_scene::camera_frame::CameraImage;
use app_scene::scene::Image;

/// A platform's own encoder: a camera picture in, the bytes of a PNG or JPEG file out, or none where it cannot.
pub type PlatformEncoder = Box<dyn FnMut(&CameraImage) -> Option<Vec<u8>> + Send>;

/// Of JPEG files that are written on a phone.
const PHONE_QUALITY: u8 = 95;

/// How camera pictures become files.
#[derive(Default)]
pub enum PictureCodec {
    /// PNG: the codes come back as they were.
    #[default]
    Lossless,
    /// JPEG.
    Jpeg {
        /// From 1 to 100; the page on recordings tells what each costs.
        quality: u8,
    },
    /// As the platform does it, such as by its hardware; what it cannot encode is written as [`PictureCodec::PHONE`] does.
    Platform(PlatformEncoder),
}

impl PictureCodec {
    /// On a phone, where files that are not lossy would be too slow to write.
    pub const PHONE: Self = Self::Jpeg {
        quality: PHONE_QUALITY,
    };

    /// The file.
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

/// Whether it begins as a picture that can be read back.
fn is_picture(file: &[u8]) -> bool {
    file.starts_with(JPEG_MAGIC) || file.starts_with(PNG_MAGIC)
}

/// A photograph as PNG, without its alpha, which photographs have not.
pub(super) fn png(image: &Image) -> Result<Vec<u8>, WriteError> {
    let mut file = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive);
    write(encoder, image)?;
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
    // The encoders panic at a buffer of another size.
    if rgb8.len() as u64 != n_bytes {
        let reason = format!("{} bytes, not {n_bytes}", rgb8.len());
        return Err(WriteError::Picture(reason));
    }
    encoder
        .write_image(&rgb8, image.width_px, image.height_px, ExtendedColorType::Rgb8)
        .map_err(|error| WriteError::Picture(error.to_string()))
}
