//! Reads a photograph of a camera or a phone: upright, in sRGB, and in a size that a session may
//! have.

use std::fs;
use std::io::{BufReader, Cursor};
use std::path::{Path, PathBuf};

use app_core::scene::Image;
use app_core::scene::check::MAX_PICTURE_PIXELS;
use app_core::session::tags::{exif_orientation, jpeg_has_end, png_chunks};
use app_scene::geometry::color::{code_of_linear, linear_of_codes};
use exif::{In, Tag, Value};
use image::codecs::{jpeg::JpegDecoder, png::PngDecoder};
use image::imageops::FilterType;
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, Limits, Rgb, Rgb32FImage};
use moxcms::{ColorProfile, Layout, TransformOptions};
use thiserror::Error;

/// Limit for a file's size, and for memory to decode it.
const MOST_FILE_BYTES: u64 = 256 << 20;
const MOST_DECODED_BYTES: u64 = 2 << 30;
/// Diagonal of a frame of 35 mm film, in millimetres: focal lengths "in 35 mm film" have its angle of view along the diagonal.
///
/// Source: CIPA DC-008 (Exif 2.32), FocalLengthIn35mmFilm.
const FILM_DIAGONAL_MM: f64 = 43.266_6;
/// `cICP` colour primaries of Display P3. Source: ITU-T H.273, table 2.
const DISPLAY_P3_PRIMARIES: u8 = 12;
/// The transfer function of sRGB, which Display P3 has, too. Source: the same, table 3.
const SRGB_TRANSFER: u8 = 13;

/// A photograph that cannot be used.
#[derive(Debug, Error)]
#[error("{}: {reason}", path.display())]
pub struct PhotographError {
    /// The file.
    pub path: PathBuf,
    /// The reason.
    pub reason: PhotographReason,
}

/// The reason why a photograph cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PhotographReason {
    /// The file cannot be read.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// The file is larger than any photograph.
    #[error("is larger than {} MiB, the limit: export it smaller", MOST_FILE_BYTES >> 20)]
    TooLarge,
    /// A format of phones and cameras that is not supported.
    #[error("is {format}, which is not read: {export}")]
    Foreign {
        /// Name of the format.
        format: &'static str,
        /// The way to convert it.
        export: &'static str,
    },
    /// The format is unknown.
    #[error("is neither PNG nor JPEG: export the photograph as one of them")]
    Unknown,
    /// The file is damaged.
    #[error("cannot be decoded: {0}")]
    Damaged(#[from] image::ImageError),
    /// The end of the file is missing; decoders would fill the rest with grey.
    #[error("is cut short: copy it again")]
    CutShort,
    /// The colour profile cannot be converted to sRGB.
    #[error("its colour profile cannot be converted ({0}): export it in sRGB")]
    Profile(String),
}

/// A photograph that can be a picture of a session.
#[derive(Clone, Debug)]
pub struct Photograph {
    /// The file.
    pub path: PathBuf,
    /// Upright, in sRGB.
    pub image: Image,
    /// Focal length in pixels of `image`; `None` if the file does not state it.
    pub focal_px: Option<f64>,
    /// Conversions, as sentences.
    pub notes: Vec<String>,
}

/// Focal length in pixels of a picture with the angle of view of a lens's equivalent on 35 mm film.
#[must_use]
pub fn focal_px(focal_35mm: f64, image: &Image) -> f64 {
    let diagonal_px = f64::from(image.width_px).hypot(f64::from(image.height_px));
    focal_35mm / FILM_DIAGONAL_MM * diagonal_px
}

impl Photograph {
    /// Reads a photograph.
    ///
    /// # Errors
    /// When it cannot be read, or is of another format.
    pub fn read(path: &Path) -> Result<Self, PhotographError> {
        read(path).map_err(|reason| PhotographError {
            path: path.to_owned(),
            reason,
        })
    }
}

fn read(path: &Path) -> Result<Photograph, PhotographReason> {
    if fs::metadata(path)?.len() > MOST_FILE_BYTES {
        return Err(PhotographReason::TooLarge);
    }
    let bytes = fs::read(path)?;
    let mut notes = Vec::new();
    let Decoded { mut picture, profile } = decode(&bytes)?;
    if picture.color().bytes_per_pixel() > picture.color().channel_count() {
        notes.push("its 16 bits a channel are rounded to 8".to_owned());
    }
    if let Some(orientation) = Orientation::from_exif(exif_orientation(&bytes))
        && orientation != Orientation::NoTransforms
    {
        picture.apply_orientation(orientation);
        notes.push("it is turned upright, as its EXIF says".to_owned());
    }
    let mut rgba8 = picture.into_rgba8();
    if let Some(profile) = profile {
        let name = to_srgb(&mut rgba8, &profile)?;
        notes.push(format!("its colours are converted from {name} to sRGB"));
    }
    let (width_px, height_px) = rgba8.dimensions();
    let rgba8 = match smaller_px([width_px, height_px]) {
        None => rgba8,
        Some([width, height]) => {
            notes.push(format!(
                "its {width_px} x {height_px} pixels are more than the {MAX_PICTURE_PIXELS} of a session and are resampled to {width} x {height}"
            ));
            resized(&rgba8, [width, height])
        }
    };
    let (width_px, height_px) = rgba8.dimensions();
    let mut rgba8 = rgba8.into_raw();
    for pixel in rgba8.chunks_exact_mut(4) {
        pixel[3] = u8::MAX;
    }
    let image = Image {
        width_px,
        height_px,
        rgba8,
    };
    Ok(Photograph {
        path: path.to_owned(),
        focal_px: focal_35mm(&bytes).map(|focal_35mm| focal_px(focal_35mm, &image)),
        image,
        notes,
    })
}

struct Decoded {
    picture: DynamicImage,
    /// `None` for sRGB, and for pictures without a statement.
    profile: Option<ColorProfile>,
}

fn decode(bytes: &[u8]) -> Result<Decoded, PhotographReason> {
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_DECODED_BYTES);
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        decoded(PngDecoder::with_limits(Cursor::new(bytes), limits)?, bytes)
    } else if bytes.starts_with(b"\xff\xd8\xff") {
        let mut decoder = JpegDecoder::new(Cursor::new(bytes))?;
        decoder.set_limits(limits)?;
        if !jpeg_has_end(bytes) {
            return Err(PhotographReason::CutShort);
        }
        decoded(decoder, bytes)
    } else {
        Err(
            app_scene::picture::kind(bytes).map_or(PhotographReason::Unknown, |(format, export)| {
                PhotographReason::Foreign { format, export }
            }),
        )
    }
}

fn decoded(mut decoder: impl ImageDecoder, bytes: &[u8]) -> Result<Decoded, PhotographReason> {
    let profile = decoder.icc_profile()?;
    Ok(Decoded {
        picture: DynamicImage::from_decoder(decoder)?,
        profile: profile_of(bytes, profile.as_deref())?,
    })
}

/// The profile of a picture in other colours than sRGB.
fn profile_of(bytes: &[u8], profile: Option<&[u8]>) -> Result<Option<ColorProfile>, PhotographReason> {
    let Some(what) = desk::check::foreign_colours(bytes, profile) else {
        return Ok(None);
    };
    // A PNG's `cICP` has priority over its profile.
    let cicp = png_chunks(bytes).find(|(name, _)| name == b"cICP");
    match (cicp, profile) {
        (Some((_, [DISPLAY_P3_PRIMARIES, SRGB_TRANSFER, ..])), _) => Ok(Some(ColorProfile::new_display_p3())),
        (None, Some(profile)) => ColorProfile::new_from_slice(profile)
            .map(Some)
            .map_err(|error| PhotographReason::Profile(format!("{what}: {error}"))),
        _ => Err(PhotographReason::Profile(what)),
    }
}

/// Converts codes of another profile to sRGB; returns the profile's name.
fn to_srgb(picture: &mut image::RgbaImage, profile: &ColorProfile) -> Result<String, PhotographReason> {
    let failed = |error: moxcms::CmsError| PhotographReason::Profile(error.to_string());
    let srgb = ColorProfile::new_srgb();
    let options = TransformOptions::default();
    let transform = profile
        .create_transform_8bit(Layout::Rgba, &srgb, Layout::Rgba, options)
        .map_err(failed)?;
    let foreign = picture.as_raw().clone();
    transform.transform(&foreign, picture).map_err(failed)?;
    Ok(desk::check::profile_name(profile).unwrap_or_else(|| "Display P3".to_owned()))
}

/// The reduced size of a picture that is too large; `None` if it may stay.
fn smaller_px([width_px, height_px]: [u32; 2]) -> Option<[u32; 2]> {
    let n_pixels = u64::from(width_px) * u64::from(height_px);
    #[allow(clippy::cast_precision_loss, reason = "a ratio of pixels")]
    let ratio = (MAX_PICTURE_PIXELS as f64 / n_pixels as f64).sqrt();
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "smaller than it was"
    )]
    let smaller = |side: u32| ((f64::from(side) * ratio).floor() as u32).max(1);
    (ratio < 1.0).then(|| [smaller(width_px), smaller(height_px)])
}

/// Resamples in linear light.
fn resized(picture: &image::RgbaImage, [width, height]: [u32; 2]) -> image::RgbaImage {
    let linear = linear_of_codes();
    let light = Rgb32FImage::from_fn(picture.width(), picture.height(), |x, y| {
        let [r, g, b, _] = picture.get_pixel(x, y).0;
        Rgb([r, g, b].map(|code| linear[usize::from(code)]))
    });
    let light = image::imageops::resize(&light, width, height, FilterType::Lanczos3);
    image::RgbaImage::from_fn(width, height, |x, y| {
        let [r, g, b] = light.get_pixel(x, y).0.map(code_of_linear);
        image::Rgba([r, g, b, u8::MAX])
    })
}

/// The focal length in EXIF, as on 35 mm film.
fn focal_35mm(bytes: &[u8]) -> Option<f64> {
    let mut reader = BufReader::new(Cursor::new(bytes));
    let exif = exif::Reader::new().read_from_container(&mut reader).ok()?;
    let field = exif.get_field(Tag::FocalLengthIn35mmFilm, In::PRIMARY)?;
    let focal_mm = match &field.value {
        Value::Rational(values) => values.first()?.to_f64(),
        value => f64::from(value.get_uint(0)?),
    };
    // 0 means unknown.
    (focal_mm.is_finite() && focal_mm > 0.0).then_some(focal_mm)
}
