//! Record3D: `metadata`, JSON, and pictures that are numbered from 0.
//!
//! Poses are quaternion (x, y, z, w), then position, with ARKit's camera axes; the world is that of
//! the recording's start, so that up is unknown. `K` is column by column. There may be more poses
//! than pictures. A frame's depths are `.depth`, its confidences `.conf`, each compressed by LZFSE:
//! `dw` x `dh` floats in metres, and as many bytes from 0, low, to 2; they show what the picture shows.

use app_core::scene::check;
use serde::Deserialize;

use super::error::{ImportError, ImportReason};
use super::imported::{DepthEncoding, Imported, ImportedDepth, ImportedFrame};
use super::lens::Lens;
use super::paths::Known;
use super::values::{number, ordered, pose, time_s as time, without_picture};

/// Possible folders of the pictures.
const FOLDERS: [&str; 3] = ["rgbd/", "rgb/", ""];

#[derive(Deserialize)]
struct Metadata {
    #[serde(default, rename = "K")]
    matrix: Vec<f64>,
    w: Option<f64>,
    h: Option<f64>,
    dw: Option<u32>,
    dh: Option<u32>,
    fps: Option<f64>,
    poses: Vec<Vec<f64>>,
    #[serde(default, rename = "perFrameIntrinsicCoeffs")]
    intrinsics: Option<Vec<Vec<f64>>>,
    #[serde(default, rename = "frameTimestamps")]
    times_s: Option<Vec<f64>>,
}

pub(super) fn parse(file: &str, text: &str, known: &Known) -> Result<Imported, ImportError> {
    let metadata: Metadata =
        serde_json::from_str(text).map_err(|error| ImportError::new(file, "the file", error))?;
    let n_poses = metadata.poses.len();
    let last_frame = n_poses.saturating_sub(1) as u64;
    let first_number = first_number(file, known, last_frame)?;
    let depth_px = metadata.depth_px(file)?;
    let mut found = Vec::new();
    let mut missing = Vec::new();
    for index in 0..n_poses {
        let number = index as u64 + first_number;
        let names = FOLDERS
            .into_iter()
            .flat_map(|folder| ["jpg", "png"].map(|kind| format!("{folder}{number}.{kind}")));
        match known.first(names) {
            Some(image) => {
                let depth = depth_px.and_then(|size_px| depth(number, size_px, known));
                found.push((index, image, depth));
            }
            None => missing.push(format!("rgbd/{number}.jpg")),
        }
    }
    let n_times = metadata.times_s.as_ref().map_or(0, Vec::len);
    let has_times = found.last().is_some_and(|(last, ..)| *last < n_times);
    let found_depths = found
        .iter()
        .any(|(index, ..)| depth(*index as u64 + first_number, [0; 2], known).is_some());
    let frames = found.into_iter().map(|(index, image, depth)| {
        let frame = metadata.frame(file, index, image, has_times)?;
        Ok(ImportedFrame { depth, ..frame })
    });
    let frames = frames.collect::<Result<Vec<_>, _>>()?;
    let mut notes = Vec::from_iter(without_picture(&missing, n_poses));
    if n_times > 0 && !has_times {
        notes.push(format!(
            "frameTimestamps has {n_times} times for {n_poses} poses: none is used"
        ));
    }
    if depth_px.is_none() && found_depths {
        notes.push("dw and dh are missing: depths are left out".to_owned());
    }
    if first_number > 0 {
        notes.push("the pictures are counted from 1".to_owned());
    }
    Ok(Imported {
        frames: ordered(file, frames, missing.into_iter().next())?,
        up: None,
        is_metric: true,
        recorded_from_object: None,
        notes,
    })
}

/// The depths of a frame with that number.
fn depth(number: u64, size_px: [u32; 2], known: &Known) -> Option<ImportedDepth> {
    let named = |ending: &str| known.first(FOLDERS.map(|folder| format!("{folder}{number}.{ending}")));
    Some(ImportedDepth {
        file: named("depth")?,
        confidence: named("conf"),
        encoding: DepthEncoding::Floats { size_px },
    })
}

/// The number of the first frame's picture.
fn first_number(file: &str, known: &Known, last_frame: u64) -> Result<u64, ImportError> {
    let of_folders = FOLDERS.map(|folder| known.first_number(folder, [0, last_frame]));
    if of_folders.contains(&Ok(1)) {
        return Ok(1);
    }
    // More poses than pictures are usual: numbers from 1 that end before the last pose are
    // ambiguous nevertheless.
    match of_folders.into_iter().find_map(Result::err) {
        Some(numbers) => Err(ImportError::new(
            file,
            "the pictures",
            ImportReason::Numbering { numbers, last_frame },
        )),
        None => Ok(0),
    }
}

impl Metadata {
    /// Size of the depths, if it is stated.
    fn depth_px(&self, file: &str) -> Result<Option<[u32; 2]>, ImportError> {
        let Some((width, height)) = self.dw.zip(self.dh) else {
            return Ok(None);
        };
        match check::picture_size(width, height) {
            Ok(()) => Ok(Some([width, height])),
            Err(error) => Err(ImportError::new(file, "dw, dh", ImportReason::Field(error))),
        }
    }

    fn frame(
        &self,
        file: &str,
        index: usize,
        image: String,
        has_times: bool,
    ) -> Result<ImportedFrame, ImportError> {
        let numbers = &self.poses[index];
        let field = format!("poses[{index}]");
        let &[qx, qy, qz, qw, x, y, z] = numbers.as_slice() else {
            let reason = ImportReason::Length {
                n: numbers.len(),
                expected: "7",
            };
            return Err(ImportError::new(file, field, reason));
        };
        let intrinsics = self.intrinsics.iter().flatten().nth(index);
        let times_s = self.times_s.as_deref().filter(|_| has_times).unwrap_or_default();
        let size = |name, value: Option<f64>| value.map(|value| number(file, name, value)).transpose();
        Ok(ImportedFrame {
            time_s: time_s(file, index, times_s, self.fps)?,
            image,
            depth: None,
            intrinsics: match intrinsics {
                Some(numbers) => of_frame(file, index, numbers)?,
                None => of_matrix(file, &self.matrix)?,
            },
            size_px: size("w", self.w)?.zip(size("h", self.h)?).map(|(w, h)| [w, h]),
            lens: Lens::NONE,
            recorded_from_camera: pose(file, &field, [qx, qy, qz, qw], [x, y, z])?,
        })
    }
}

fn time_s(file: &str, index: usize, times_s: &[f64], fps: Option<f64>) -> Result<Option<f64>, ImportError> {
    if let Some(time_s) = times_s.get(index) {
        return time(file, &format!("frameTimestamps[{index}]"), *time_s).map(Some);
    }
    let Some(fps) = fps else { return Ok(None) };
    if fps.is_nan() || fps <= 0.0 {
        return Err(ImportError::new(
            file,
            "fps",
            ImportReason::NotANumber(fps.to_string()),
        ));
    }
    time(file, "fps", index as f64 / fps).map(Some)
}

fn of_frame(file: &str, index: usize, numbers: &[f64]) -> Result<[f64; 4], ImportError> {
    let field = format!("perFrameIntrinsicCoeffs[{index}]");
    let four: [f64; 4] = numbers.try_into().map_err(|_| {
        let n = numbers.len();
        ImportError::new(file, field.clone(), ImportReason::Length { n, expected: "4" })
    })?;
    four.iter()
        .try_for_each(|value| number(file, &field, *value).map(|_| ()))?;
    Ok(four)
}

fn of_matrix(file: &str, numbers: &[f64]) -> Result<[f64; 4], ImportError> {
    let &[fx, _, _, _, fy, _, cx, cy, _] = numbers else {
        let n = numbers.len();
        return Err(ImportError::new(
            file,
            "K",
            ImportReason::Length { n, expected: "9" },
        ));
    };
    let four = [fx, fy, cx, cy];
    four.iter()
        .try_for_each(|value| number(file, "K", *value).map(|_| ()))?;
    Ok(four)
}
