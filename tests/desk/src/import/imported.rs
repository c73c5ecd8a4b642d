//! What a format tells, whichever it is.

use glam::{DMat4, DVec3};

use super::lens::Lens;

/// No list of frames is larger.
pub(super) const MAX_TEXT_BYTES: u64 = 512 << 20;
/// An hour of 60 frames a second is more than twice as many.
pub(super) const MAX_FRAMES: usize = 100_000;
/// Focal lengths, places in a picture, metres: whatever is larger is no camera's.
pub(super) const MAX_NUMBER: f64 = 1e6;

/// What a format tells of a camera frame.
#[derive(Clone, Debug)]
pub struct ImportedFrame {
    /// Seconds; none where the format has no times.
    pub time_s: Option<f64>,
    /// Path of the picture.
    pub image: String,
    /// Focal lengths, then the principal point, in pixels, the first pixel's centre at (.5, .5).
    pub intrinsics: [f64; 4],
    /// Size of the pictures that the intrinsics are of, width first; none if the format does not tell.
    pub size_px: Option<[f64; 2]>,
    /// Of the picture.
    pub lens: Lens,
    /// Camera space (+Y up, looks along -Z) to the recording's own world.
    pub recorded_from_camera: DMat4,
}

/// What a format tells.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Frames whose picture is there, in the order of their times, or else of their pictures' names.
    pub frames: Vec<ImportedFrame>,
    /// Up in the recording's world, where the format fixes it.
    pub up: Option<DVec3>,
    /// Whether its lengths are metres.
    pub is_metric: bool,
    /// Where the toy stands in the recording's world, if the format tells.
    pub recorded_from_object: Option<DMat4>,
    /// What was left out or taken otherwise than written, for people.
    pub notes: Vec<String>,
}

impl Imported {
    /// Frames that have a time.
    pub(super) fn n_times(&self) -> usize {
        self.frames.iter().filter(|frame| frame.time_s.is_some()).count()
    }

    /// Whether all frames have a time; if only some have one, none is used.
    pub(super) fn has_times(&self) -> bool {
        self.n_times() == self.frames.len()
    }
}
