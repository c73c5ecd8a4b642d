//! The structure of picture files: the chunks of a PNG, a JPEG's end, and EXIF's orientation.

use std::io::Cursor;

use image::ImageDecoder;
use image::codecs::jpeg::JpegDecoder;
use image::metadata::Orientation;

pub(crate) const PNG_MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
pub(crate) const JPEG_MAGIC: &[u8] = b"\xff\xd8\xff";

/// Name and data of each chunk of a PNG, in order, up to the file's end. Empty for other files.
///
/// Source: PNG specification (W3C, third edition), section 5.3.
pub fn png_chunks(bytes: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = bytes.strip_prefix(PNG_MAGIC).unwrap_or_default();
    std::iter::from_fn(move || {
        let (length, named) = rest.split_first_chunk::<4>()?;
        let (name, data) = named.split_first_chunk::<4>()?;
        let (data, checksum) = data.split_at_checked(usize::try_from(u32::from_be_bytes(*length)).ok()?)?;
        rest = checksum.get(4..)?;
        Some((*name, data))
    })
}

/// EXIF's orientation of the picture, 1 to 8; 1, which means as stored, if there is no readable
/// tag.
///
/// A PNG may have its tag after the pixels, where decoders do not look.
#[must_use]
pub fn exif_orientation(bytes: &[u8]) -> u8 {
    let orientation = if bytes.starts_with(JPEG_MAGIC) {
        JpegDecoder::new(Cursor::new(bytes))
            .and_then(|mut decoder| decoder.orientation())
            .ok()
    } else {
        png_chunks(bytes)
            .find(|(name, _)| name == b"eXIf")
            .and_then(|(_, data)| Orientation::from_exif_chunk(data))
    };
    orientation.map_or(1, Orientation::to_exif)
}

/// Whether a JPEG has its end; decoders fill what is cut off with grey. Walks the segments: previews
/// in its metadata have their own end markers, so a search for the marker's bytes would not do.
#[must_use]
pub fn jpeg_has_end(bytes: &[u8]) -> bool {
    const STUFFED: u8 = 0x00;
    const FILL: u8 = 0xff;
    const END: u8 = 0xd9;
    let mut at = 2;
    while let Some(&[first, code]) = bytes.get(at..at + 2) {
        at += match (first, code) {
            (0xff, END) => return true,
            (0xff, STUFFED | 0xd0..=0xd7) => 2,
            (0xff, FILL) => 1,
            (0xff, _) => match bytes.get(at + 2..at + 4) {
                Some(&[high, low]) => 2 + usize::from(u16::from_be_bytes([high, low])),
                _ => return false,
            },
            // A byte of compressed data.
            _ => 1,
        };
    }
    false
}
