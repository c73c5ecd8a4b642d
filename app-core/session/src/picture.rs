//! Decodes the pictures of a session: PNG or JPEG, of exactly the size the session states.

use std::io::Cursor;

use image::codecs::{jpeg::JpegDecoder, png::PngDecoder};
use image::{ColorType, DynamicImage, ImageDecoder, Limits};

use super::error::PictureError;
use super::tags::{JPEG_MAGIC, PNG_MAGIC, jpeg_has_end};
use app_scene::depth::Depth;
use app_scene::people::People;
use app_scene::scene::{Image, check};
use glam::UVec2;

/// Room for data of a picture file besides pixels: colour profiles, previews, text.
const EXTRA_BYTES: u64 = 16 << 20;

/// Memory for the decoder of a picture of the largest size with 16 bits per pixel.
const MAX_GREY_BYTES: u64 = 2 * check::MAX_PICTURE_PIXELS + EXTRA_BYTES;

/// The size of all pictures of a session.
#[derive(Clone, Copy)]
pub(super) struct PictureSize {
    pub(super) width_px: u32,
    pub(super) height_px: u32,
}

impl PictureSize {
    pub(super) fn n_pixels(self) -> u64 {
        u64::from(self.width_px) * u64::from(self.height_px)
    }

    /// Largest file of this size: incompressible 16-bit RGBA.
    pub(super) fn max_file_bytes(self) -> u64 {
        self.n_pixels() * 8 + EXTRA_BYTES
    }
}

/// Decodes a photograph. Its alpha, if any, is dropped.
pub(super) fn decode_photo(bytes: &[u8], size: PictureSize) -> Result<Image, PictureError> {
    let mut image = decode(bytes, size)?.into_rgba8().into_raw();
    for pixel in image.chunks_exact_mut(4) {
        pixel[3] = u8::MAX;
    }
    Ok(with_size(image, size))
}

/// Decodes a mask, whose four channels are independent numbers.
pub(super) fn decode_mask(bytes: &[u8], size: PictureSize) -> Result<Image, PictureError> {
    match decode(bytes, size)? {
        DynamicImage::ImageRgba8(image) => Ok(with_size(image.into_raw(), size)),
        _ => Err(PictureError::NotAMask),
    }
}

/// A kind of map of a frame: a grey PNG, which may be of another size than the pictures but not of
/// another shape.
struct MapKind {
    /// Its name with its article.
    name: &'static str,
    n_bits: u8,
    color: ColorType,
}

const DEPTHS: MapKind = MapKind {
    name: "a map of depths in millimetres",
    n_bits: 16,
    color: ColorType::L16,
};
const PEOPLE: MapKind = MapKind {
    name: "a mask of people",
    n_bits: 8,
    color: ColorType::L8,
};

impl MapKind {
    fn refusal(&self) -> PictureError {
        PictureError::NotAMap {
            map: self.name,
            n_bits: self.n_bits,
        }
    }

    /// The decoder of a map whose format and size are checked.
    fn decoder<'a>(
        &self,
        bytes: &'a [u8],
        size: PictureSize,
    ) -> Result<PngDecoder<Cursor<&'a [u8]>>, PictureError> {
        if !bytes.starts_with(PNG_MAGIC) {
            return Err(self.refusal());
        }
        let mut limits = Limits::default();
        limits.max_alloc = Some(MAX_GREY_BYTES);
        let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits)?;
        if decoder.color_type() != self.color {
            return Err(self.refusal());
        }
        if is_alike(&decoder, size) {
            return Ok(decoder);
        }
        let (width_px, height_px) = decoder.dimensions();
        Err(PictureError::MapSize {
            map: self.name,
            width_px,
            height_px,
            picture_width_px: size.width_px,
            picture_height_px: size.height_px,
        })
    }

    /// A decoded map, of the texels that `of` finds in a picture.
    fn decoded<T>(
        &self,
        (bytes, size): (&[u8], PictureSize),
        of: impl FnOnce(UVec2, DynamicImage) -> Option<T>,
    ) -> Result<T, PictureError> {
        let image = DynamicImage::from_decoder(self.decoder(bytes, size)?)?;
        let size_px = UVec2::new(image.width(), image.height());
        of(size_px, image).ok_or_else(|| self.refusal())
    }
}

/// Decodes depths.
pub(super) fn decode_depth(bytes: &[u8], size: PictureSize) -> Result<Depth, PictureError> {
    DEPTHS.decoded((bytes, size), |size_px, image| match image {
        DynamicImage::ImageLuma16(image) => Depth::new(size_px, image.into_raw()),
        _ => None,
    })
}

/// Decodes a mask of people.
pub(super) fn decode_people(bytes: &[u8], size: PictureSize) -> Result<People, PictureError> {
    PEOPLE.decoded((bytes, size), |size_px, image| match image {
        DynamicImage::ImageLuma8(image) => People::new(size_px, image.into_raw()),
        _ => None,
    })
}

/// Checks format and size of depths without decoding them.
pub(super) fn check_depth(bytes: &[u8], size: PictureSize) -> Result<(), PictureError> {
    DEPTHS.decoder(bytes, size).map(|_| ())
}

/// Checks format and size of a mask of people without decoding it.
pub(super) fn check_people(bytes: &[u8], size: PictureSize) -> Result<(), PictureError> {
    PEOPLE.decoder(bytes, size).map(|_| ())
}

/// Whether a picture has the shape of a session's pictures and a size within the limits.
fn is_alike(decoder: &impl ImageDecoder, size: PictureSize) -> bool {
    let (width_px, height_px) = decoder.dimensions();
    check::map_size([width_px, height_px], [size.width_px, size.height_px]).is_ok()
}

/// Checks format and size of a photograph or a mask, and a JPEG's end, without decoding it.
pub(super) fn check_head(bytes: &[u8], size: PictureSize, is_mask: bool) -> Result<(), PictureError> {
    let mut limits = Limits::default();
    limits.max_alloc = Some(size.max_file_bytes());
    let kind = if bytes.starts_with(PNG_MAGIC) {
        let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits)?;
        check_size(&decoder, size)?;
        decoder.color_type()
    } else if bytes.starts_with(JPEG_MAGIC) {
        let decoder = JpegDecoder::new(Cursor::new(bytes))?;
        if !jpeg_has_end(bytes) {
            return Err(PictureError::Truncated);
        }
        check_size(&decoder, size)?;
        decoder.color_type()
    } else {
        return Err(other_kind(bytes));
    };
    if is_mask && kind != ColorType::Rgba8 {
        return Err(PictureError::NotAMask);
    }
    Ok(())
}

fn with_size(rgba8: Vec<u8>, size: PictureSize) -> Image {
    Image {
        width_px: size.width_px,
        height_px: size.height_px,
        rgba8,
    }
}

fn decode(bytes: &[u8], size: PictureSize) -> Result<DynamicImage, PictureError> {
    let mut limits = Limits::default();
    limits.max_alloc = Some(size.max_file_bytes());
    if bytes.starts_with(PNG_MAGIC) {
        decode_sized(PngDecoder::with_limits(Cursor::new(bytes), limits)?, size)
    } else if bytes.starts_with(JPEG_MAGIC) {
        let mut decoder = JpegDecoder::new(Cursor::new(bytes))?;
        decoder.set_limits(limits)?;
        if !jpeg_has_end(bytes) {
            return Err(PictureError::Truncated);
        }
        decode_sized(decoder, size)
    } else {
        Err(other_kind(bytes))
    }
}

/// The error for bytes that are neither PNG nor JPEG.
fn other_kind(bytes: &[u8]) -> PictureError {
    match app_scene::picture::kind(bytes) {
        Some((format, way_out)) => PictureError::OtherFormat { format, way_out },
        None => PictureError::Format,
    }
}

/// Compares the size in the header before any decoding or allocation.
fn decode_sized(decoder: impl ImageDecoder, size: PictureSize) -> Result<DynamicImage, PictureError> {
    check_size(&decoder, size)?;
    Ok(DynamicImage::from_decoder(decoder)?)
}

fn check_size(decoder: &impl ImageDecoder, size: PictureSize) -> Result<(), PictureError> {
    let (width_px, height_px) = decoder.dimensions();
    if (width_px, height_px) != (size.width_px, size.height_px) {
        return Err(PictureError::Size {
            width_px,
            height_px,
            expected_width_px: size.width_px,
            expected_height_px: size.height_px,
        });
    }
    Ok(())
}
