//! Depths of a recording as a session has them: without those of low confidence.

use std::io::Cursor;

use app_core::session::Files;
use image::{DynamicImage, ImageFormat, ImageReader, Limits};

use super::error::{ImportError, ImportReason};
use super::imported::ImportedDepth;
use super::pictures::{MAX_FILE_BYTES, read};

/// Confidence of ARKit from which on a depth counts: medium.
const LEAST_CONFIDENCE: u8 = 1;

impl ImportedDepth {
    /// The bytes of its file in a session.
    pub(super) fn png(&self, files: &dyn Files) -> Result<Vec<u8>, ImportError> {
        let bytes = read(files, &self.image)?;
        let Some(confidence) = &self.confidence else {
            return Ok(bytes);
        };
        let wrong = |path: &str| ImportError::new(path, "the file", ImportReason::NotDepths);
        let DynamicImage::ImageLuma16(mut depths) = decoded(bytes).ok_or_else(|| wrong(&self.image))? else {
            return Err(wrong(&self.image));
        };
        let Some(DynamicImage::ImageLuma8(confidences)) = decoded(read(files, confidence)?) else {
            return Err(wrong(confidence));
        };
        if confidences.dimensions() != depths.dimensions() {
            return Err(wrong(confidence));
        }
        for (depth, confidence) in depths.pixels_mut().zip(confidences.pixels()) {
            if confidence.0[0] < LEAST_CONFIDENCE {
                depth.0[0] = 0;
            }
        }
        let mut png = Cursor::new(Vec::new());
        depths
            .write_to(&mut png, ImageFormat::Png)
            .map_err(|_| wrong(&self.image))?;
        Ok(png.into_inner())
    }
}

fn decoded(bytes: Vec<u8>) -> Option<DynamicImage> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_FILE_BYTES);
    reader.limits(limits);
    reader.decode().ok()
}
