//! Videos without an encoder of the platform: Motion JPEG, each picture repeated for as long as it
//! is shown.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use app_core::scene::Image;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

use crate::avi::Avi;
use crate::encoder::{HZ, VideoEncoder};

/// JPEG quality of the pictures, up to 100: above this value files grow faster than visible
/// quality.
const QUALITY: u8 = 92;

/// A file, and the picture that is shown at present.
struct MotionJpeg {
    avi: Avi<BufWriter<File>>,
    shown: Option<Vec<u8>>,
}

/// Begins a file.
pub(crate) fn begin(path: &Path, size_px: [u32; 2]) -> io::Result<Box<dyn VideoEncoder>> {
    let avi = Avi::begin(BufWriter::new(File::create(path)?), size_px, HZ)?;
    Ok(Box::new(MotionJpeg { avi, shown: None }))
}

impl MotionJpeg {
    /// Shows the picture until a time. If there are two in one period, the later one is shown.
    fn show_until(&mut self, since_s: f64) -> io::Result<()> {
        let Some(shown) = &self.shown else { return Ok(()) };
        while self.avi.n_pictures() < n_pictures_until(since_s) && self.avi.has_room(shown) {
            self.avi.add(shown)?;
        }
        Ok(())
    }
}

impl VideoEncoder for MotionJpeg {
    fn add(&mut self, picture: &Image, since_s: f64) -> io::Result<bool> {
        self.show_until(since_s)?;
        let next = jpeg(picture)?;
        let has_room = self.avi.has_room(&next);
        self.shown = Some(next).filter(|_| has_room);
        Ok(has_room)
    }

    fn finish(mut self: Box<Self>, until_s: f64) -> io::Result<()> {
        self.show_until(until_s)?;
        self.avi.finish().map(drop)
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "the conversion saturates, and what is no number becomes 0"
)]
fn n_pictures_until(since_s: f64) -> usize {
    (since_s * f64::from(HZ)).round() as usize
}

fn jpeg(picture: &Image) -> io::Result<Vec<u8>> {
    let rgb: Vec<u8> = picture
        .rgba8
        .chunks_exact(4)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, QUALITY)
        .encode(&rgb, picture.width_px, picture.height_px, ExtendedColorType::Rgb8)
        .map_err(io::Error::other)?;
    Ok(jpeg)
}
