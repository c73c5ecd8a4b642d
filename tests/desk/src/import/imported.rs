//! The common result of all formats.

use glam::{DMat4, DVec3};

use super::lens::Lens;

/// Limit for the size of a list of frames.
pub(super) const MAX_TEXT_BYTES: u64 = 512 << 20;
/// Limit for the length of a list of frames: 28 minutes of 60 frames per second, more than an index can hold.
pub(super) const MAX_FRAMES: usize = 100_000;
/// Limit for focal lengths, image coordinates and metres.
pub(super) const MAX_NUMBER: f64 = 1e6;

/// Depths of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImportedDepth {
    /// Path of the depths.
    pub file: String,
    /// Path of their confidences, of 8 bit; 0 if low.
    pub confidence: Option<String>,
    /// Encoding of both.
    pub encoding: DepthEncoding,
}

/// Encoding of depths and of their confidences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthEncoding {
    /// Grey PNGs: depths of 16 bit in millimetres, 0 if unknown.
    Png,
    /// LZFSE, or no compression: depths as floats of 32 bit in metres, little-endian.
    Floats {
        /// Width and height of both.
        size_px: [u32; 2],
    },
}

/// A camera frame of another format.
#[derive(Clone, Debug)]
pub struct ImportedFrame {
    /// Time in seconds; `None` if the format has no times.
    pub time_s: Option<f64>,
    /// Path of the picture.
    pub image: String,
    /// Depths, if the format has them.
    pub depth: Option<ImportedDepth>,
    /// Focal lengths, then the principal point, in pixels, the first pixel's centre at (.5, .5).
    pub intrinsics: [f64; 4],
    /// Size of the pictures that the intrinsics refer to, width first; `None` if the format does
    /// not state it.
    pub size_px: Option<[f64; 2]>,
    /// Distortion of the picture.
    pub lens: Lens,
    /// Transform from camera space (+Y up, looks along -Z) to the recording's own world.
    pub recorded_from_camera: DMat4,
}

/// A recording of another format.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Frames whose picture exists, in the order of their times, or else of their pictures' names.
    pub frames: Vec<ImportedFrame>,
    /// Up in the recording's world, if the format fixes it.
    pub up: Option<DVec3>,
    /// Whether its lengths are metres.
    pub is_metric: bool,
    /// Pose of the toy in the recording's world, if the format has it.
    pub recorded_from_object: Option<DMat4>,
    /// Messages about skipped or changed values.
    pub notes: Vec<String>,
}

impl Imported {
    /// Number of frames that have a time.
    pub(super) fn n_times(&self) -> usize {
        self.frames.iter().filter(|frame| frame.time_s.is_some()).count()
    }

    /// Whether all frames have a time; if only some have one, none is used.
    pub(super) fn has_times(&self) -> bool {
        self.n_times() == self.frames.len()
    }
}
