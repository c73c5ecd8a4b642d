//! Pictures embedded in the file, decoded.

use std::collections::HashMap;
use std::fmt;
use std::io::Cursor;

use gltf::json::Image;
use image::{ImageFormat, ImageReader};

use crate::picture;

use super::accessor::Source;
use super::base64::{self, Uri};
use super::error::{Flaw, ToyProblem};
use super::limits::{MAX_TEXELS, MAX_TEXTURE_SIDE_PX};
use super::warning::ToyWarning;

/// A texture image.
#[derive(Clone, PartialEq, Eq)]
pub struct Texture {
    /// Columns; at least one.
    pub width_px: u32,
    /// Rows; at least one.
    pub height_px: u32,
    /// `width_px * height_px * 4` bytes, rows from top to bottom; RGB is sRGB-encoded, alpha is not.
    pub rgba8_srgb: Vec<u8>,
}

impl fmt::Debug for Texture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Texture({} x {} px)", self.width_px, self.height_px)
    }
}

/// The warning about an unreadable picture.
fn left_out(field: String, bytes: Option<&[u8]>, image: &Image) -> ToyWarning {
    let outside = match image.uri.as_deref().map(base64::read) {
        Some(Uri::Elsewhere(uri)) if bytes.is_none() => Some(uri),
        _ => None,
    };
    match (bytes.and_then(picture::kind), outside) {
        (Some((format, way_out)), _) => ToyWarning::FormatIgnored {
            field,
            format,
            way_out,
        },
        (None, Some(uri)) => ToyWarning::ImageOutside {
            field,
            name: base64::percent_decoded(uri).unwrap_or_else(|| uri.to_owned()),
        },
        (None, None) => ToyWarning::ImageIgnored { field },
    }
}

/// The pictures decoded so far, each once.
pub(super) struct TextureStore<'a> {
    pub(super) source: &'a Source<'a>,
    pub(super) textures: Vec<Texture>,
    texture_from_image: HashMap<usize, Option<usize>>,
    n_texels: u64,
}

impl<'a> TextureStore<'a> {
    pub(super) fn new(source: &'a Source<'a>) -> Self {
        Self {
            source,
            textures: Vec::new(),
            texture_from_image: HashMap::new(),
            n_texels: 0,
        }
    }

    /// The texture of an image; `None`, with a warning, if the image cannot be read.
    pub(super) fn texture(
        &mut self,
        index: usize,
        image: &Image,
        warnings: &mut Vec<ToyWarning>,
    ) -> Result<Option<usize>, Flaw> {
        if let Some(&texture) = self.texture_from_image.get(&index) {
            return Ok(texture);
        }
        let field = format!("images[{index}]");
        let bytes = match (image.buffer_view, &image.uri) {
            (Some(view), _) => Some(self.source.view(&field, view)?.0.to_vec()),
            (None, Some(uri)) => match base64::read(uri) {
                Uri::Data(bytes) => Some(bytes),
                Uri::Broken | Uri::Elsewhere(_) => None,
            },
            (None, None) => return Err(ToyProblem::Missing.at(format!("{field}.bufferView"))),
        };
        let format = bytes.as_ref().and_then(|bytes| image::guess_format(bytes).ok());
        let texture = match (bytes, format) {
            (Some(bytes), Some(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::WebP))) => {
                let texture = self.decode(&bytes, format).map_err(|problem| problem.at(field))?;
                self.textures.push(texture);
                Some(self.textures.len() - 1)
            }
            (bytes, _) => {
                warnings.push(left_out(field, bytes.as_deref(), image));
                None
            }
        };
        self.texture_from_image.insert(index, texture);
        Ok(texture)
    }

    fn decode(&mut self, bytes: &[u8], format: ImageFormat) -> Result<Texture, ToyProblem> {
        let reader = || ImageReader::with_format(Cursor::new(bytes), format);
        // From the header alone, so that a wrong one cannot make the decoder allocate.
        let (width_px, height_px) = reader().into_dimensions()?;
        let side = width_px.max(height_px);
        if side > MAX_TEXTURE_SIDE_PX {
            let (found, limit) = (u64::from(side), u64::from(MAX_TEXTURE_SIDE_PX));
            return Err(ToyProblem::TooMany {
                what: "pixels on one side",
                found,
                limit,
            });
        }
        self.n_texels += u64::from(width_px) * u64::from(height_px);
        if self.n_texels > MAX_TEXELS {
            return Err(ToyProblem::TooMany {
                what: "texels",
                found: self.n_texels,
                limit: MAX_TEXELS,
            });
        }
        let rgba8_srgb = reader().decode()?.into_rgba8().into_raw();
        Ok(Texture {
            width_px,
            height_px,
            rgba8_srgb,
        })
    }
}
