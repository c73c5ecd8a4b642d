//! Recordings of other programs as sessions: nerfstudio's `transforms.json`, Record3D, Stray Scanner.
//!
//! Source: docs.nerf.studio, «Data conventions»; strayrobots/scanner, `docs/format.md` and `OdometryEncoder.swift`;
//! Record3D's exported `metadata`.

mod error;
mod nerfstudio;
mod record3d;
mod stray_scanner;
mod write;

use app_core::session::Files;
use glam::{DMat4, DQuat, DVec3};

pub use error::{ImportError, ImportReason};
pub use nerfstudio::write_transforms;
pub use write::{Lacking, PlateFrames, write};

/// No list of frames is larger.
const MAX_TEXT_BYTES: u64 = 64 << 20;
/// An hour of 60 frames a second is more than twice as many.
const MAX_FRAMES: usize = 100_000;
/// Focal lengths, places in a picture, metres: whatever is larger is no camera's.
const MAX_NUMBER: f64 = 1e6;

/// Which program wrote it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// A folder with `transforms.json`.
    Nerfstudio,
    /// A folder with `metadata` or `metadata.json` and pictures in `rgbd`, `rgb` or beside it.
    #[value(name = "record3d")]
    Record3d,
    /// A folder with `odometry.csv`, `camera_matrix.csv` and the video's frames in `rgb`.
    StrayScanner,
}

/// What a format tells of a camera frame.
#[derive(Clone, Debug)]
pub struct ImportedFrame {
    /// Seconds; none where the format has no times.
    pub time_s: Option<f64>,
    /// Path of the picture.
    pub image: String,
    /// Focal lengths, then the principal point, in pixels, the first pixel's centre at (.5, .5).
    pub intrinsics: [f64; 4],
    /// Camera space (+Y up, looks along -Z) to the recording's own world.
    pub recorded_from_camera: DMat4,
}

/// What a format tells.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Frames whose picture is there, in their order.
    pub frames: Vec<ImportedFrame>,
    /// Radial distortion, k1 and k2.
    pub lens: Option<[f64; 2]>,
    /// Up in the recording's world, where the format fixes it.
    pub up: Option<DVec3>,
    /// Whether its lengths are metres.
    pub is_metric: bool,
}

/// Reads a folder, but no picture.
///
/// # Errors
/// When a file is missing, or a number in it cannot be taken.
pub fn read(format: Format, files: &dyn Files, paths: &[String]) -> Result<Imported, ImportError> {
    let imported = match format {
        Format::Nerfstudio => {
            let file = "transforms.json";
            nerfstudio::parse(file, &text(files, file)?, paths)
        }
        Format::Record3d => {
            let file = ["metadata", "metadata.json"]
                .into_iter()
                .find(|file| has(paths, file));
            let file = file.ok_or_else(|| ImportError::new("metadata", "the file", ImportReason::Missing))?;
            record3d::parse(file, &text(files, file)?, paths)
        }
        Format::StrayScanner => {
            let matrix = has(paths, stray_scanner::MATRIX_FILE)
                .then(|| text(files, stray_scanner::MATRIX_FILE))
                .transpose()?;
            let odometry = text(files, stray_scanner::ODOMETRY_FILE)?;
            stray_scanner::parse(&odometry, matrix.as_deref(), paths)
        }
    }?;
    Ok(imported)
}

/// Reads the texts of a format as they are: for tests that change them.
///
/// # Errors
/// As [`read`].
pub fn parse(format: Format, texts: [&str; 2], paths: &[String]) -> Result<Imported, ImportError> {
    match format {
        Format::Nerfstudio => nerfstudio::parse("transforms.json", texts[0], paths),
        Format::Record3d => record3d::parse("metadata", texts[0], paths),
        Format::StrayScanner => stray_scanner::parse(texts[0], Some(texts[1]), paths),
    }
}

fn has(paths: &[String], path: &str) -> bool {
    paths.iter().any(|other| other == path)
}

/// The first of a picture's possible paths that is there.
fn picture(paths: &[String], candidates: impl IntoIterator<Item = String>) -> Option<String> {
    candidates.into_iter().find(|path| has(paths, path))
}

fn text(files: &dyn Files, file: &str) -> Result<String, ImportError> {
    let bytes = files
        .read(file, MAX_TEXT_BYTES)
        .map_err(|error| ImportError::new(file, "the file", error))?;
    String::from_utf8(bytes).map_err(|_| ImportError::new(file, "the file", ImportReason::NotText))
}

/// A number of a file, if it can be one of a camera.
fn number(file: &str, field: &str, value: f64) -> Result<f64, ImportError> {
    if value.abs() <= MAX_NUMBER {
        Ok(value)
    } else {
        Err(ImportError::new(
            file,
            field,
            ImportReason::NotANumber(value.to_string()),
        ))
    }
}

/// A pose of a quaternion (x, y, z, w) of about length 1 and a position.
fn pose(file: &str, field: &str, quaternion: [f64; 4], position: [f64; 3]) -> Result<DMat4, ImportError> {
    for value in quaternion.iter().chain(&position) {
        number(file, field, *value)?;
    }
    let rotation = DQuat::from_array(quaternion);
    if rotation.length() < 0.5 {
        return Err(ImportError::new(file, field, ImportReason::NoRotation));
    }
    Ok(DMat4::from_rotation_translation(
        rotation.normalize(),
        DVec3::from_array(position),
    ))
}

fn whole(file: &str, frames: Vec<ImportedFrame>) -> Result<Vec<ImportedFrame>, ImportError> {
    match frames.len() {
        0 => Err(ImportError::new(file, "the frames", ImportReason::NoFrames)),
        n if n > MAX_FRAMES => Err(ImportError::new(
            file,
            "the frames",
            ImportReason::TooMany(MAX_FRAMES),
        )),
        _ => Ok(frames),
    }
}
