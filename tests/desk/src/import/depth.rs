//! Depths of a recording as a session has them: without those of low confidence.

use std::io::Cursor;

use app_core::depth::millimetres;
use app_core::session::Files;
use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, ImageReader, Limits, Luma};

use super::error::{ImportError, ImportReason};
use super::imported::{DepthEncoding, ImportedDepth};
use super::pictures::{MAX_FILE_BYTES, read};

/// Confidence of ARKit from which on a depth counts: medium.
const LEAST_CONFIDENCE: u8 = 1;

/// Depths in millimetres, 0 if unknown.
type Depths = ImageBuffer<Luma<u16>, Vec<u16>>;

impl ImportedDepth {
    /// Path of its file in a session.
    pub(super) fn path(&self) -> String {
        match self.encoding {
            DepthEncoding::Png => self.file.clone(),
            DepthEncoding::Floats { .. } => format!("{}.png", self.file),
        }
    }

    /// The bytes of its file in a session.
    pub(super) fn png(&self, files: &dyn Files) -> Result<Vec<u8>, ImportError> {
        let bytes = read(files, &self.file)?;
        if self.encoding == DepthEncoding::Png && self.confidence.is_none() {
            return Ok(bytes);
        }
        let wrong = |path: &str| ImportError::new(path, "the file", ImportReason::NotDepths);
        let mut depths = self.depths(bytes).ok_or_else(|| wrong(&self.file))?;
        if let Some(path) = &self.confidence {
            let confidences = self.confidences(read(files, path)?);
            let confidences = confidences.filter(|map| map.dimensions() == depths.dimensions());
            let confidences = confidences.ok_or_else(|| wrong(path))?;
            for (depth, confidence) in depths.pixels_mut().zip(confidences.pixels()) {
                if confidence.0[0] < LEAST_CONFIDENCE {
                    depth.0[0] = 0;
                }
            }
        }
        let mut png = Cursor::new(Vec::new());
        depths
            .write_to(&mut png, ImageFormat::Png)
            .map_err(|_| wrong(&self.file))?;
        Ok(png.into_inner())
    }

    fn depths(&self, bytes: Vec<u8>) -> Option<Depths> {
        match self.encoding {
            DepthEncoding::Png => match decoded(bytes)? {
                DynamicImage::ImageLuma16(depths) => Some(depths),
                _ => None,
            },
            DepthEncoding::Floats {
                size_px: [width, height],
            } => {
                let bytes = unpacked(bytes, u64::from(width) * u64::from(height) * 4)?;
                let (metres, _) = bytes.as_chunks::<4>();
                let metres = metres.iter().map(|bytes| f32::from_le_bytes(*bytes));
                ImageBuffer::from_raw(width, height, metres.map(millimetres).collect())
            }
        }
    }

    fn confidences(&self, bytes: Vec<u8>) -> Option<GrayImage> {
        match self.encoding {
            DepthEncoding::Png => match decoded(bytes)? {
                DynamicImage::ImageLuma8(confidences) => Some(confidences),
                _ => None,
            },
            DepthEncoding::Floats {
                size_px: [width, height],
            } => {
                let bytes = unpacked(bytes, u64::from(width) * u64::from(height))?;
                ImageBuffer::from_raw(width, height, bytes)
            }
        }
    }
}

/// Bytes that are `n_bytes` long, compressed by LZFSE if they are not so yet.
fn unpacked(bytes: Vec<u8>, n_bytes: u64) -> Option<Vec<u8>> {
    if bytes.len() as u64 == n_bytes {
        return Some(bytes);
    }
    // A few bytes may stand for many: the decoder stops at the expected number.
    let mut unpacked = Vec::new();
    let mut source = &bytes[..];
    let mut decoder = lzfse_rust::LzfseRingDecoder::default();
    let mut sink = Bounded {
        bytes: &mut unpacked,
        n_bytes,
    };
    decoder.decode(&mut source, &mut sink).ok()?;
    (unpacked.len() as u64 == n_bytes).then_some(unpacked)
}

/// A sink that refuses more than a number of bytes.
struct Bounded<'a> {
    bytes: &'a mut Vec<u8>,
    n_bytes: u64,
}

impl std::io::Write for Bounded<'_> {
    fn write(&mut self, more: &[u8]) -> std::io::Result<usize> {
        if (self.bytes.len() + more.len()) as u64 > self.n_bytes {
            return Err(std::io::ErrorKind::FileTooLarge.into());
        }
        self.bytes.extend_from_slice(more);
        Ok(more.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn decoded(bytes: Vec<u8>) -> Option<DynamicImage> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_FILE_BYTES);
    reader.limits(limits);
    reader.decode().ok()
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::Bounded;

    #[test]
    fn a_sink_takes_its_number_of_bytes_and_refuses_the_next() {
        let mut bytes = Vec::new();
        let mut sink = Bounded {
            bytes: &mut bytes,
            n_bytes: 4,
        };
        assert!(sink.write_all(&[1, 2, 3]).is_ok());
        assert!(sink.write_all(&[4, 5]).is_err(), "two more do not fit");
        assert!(sink.write_all(&[4]).is_ok());
        assert!(sink.write_all(&[5]).is_err());
        assert_eq!(bytes, [1, 2, 3, 4], "nothing beyond the number is kept");
    }
}
