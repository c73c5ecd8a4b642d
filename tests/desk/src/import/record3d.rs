//! Record3D: `metadata`, JSON, and pictures that are counted from 0.
//!
//! Poses are quaternion (x, y, z, w), then position, of a camera as ARKit has it; the world begins with the recording, so
//! that which way is up is not told. `K` is column by column. There may be more poses than pictures.

use serde::Deserialize;

use super::error::{ImportError, ImportReason};
use super::{Imported, ImportedFrame, number, picture, pose, whole};

#[derive(Deserialize)]
struct Metadata {
    #[serde(default, rename = "K")]
    matrix: Vec<f64>,
    fps: Option<f64>,
    poses: Vec<Vec<f64>>,
    #[serde(default, rename = "perFrameIntrinsicCoeffs")]
    intrinsics: Option<Vec<Vec<f64>>>,
    #[serde(default, rename = "frameTimestamps")]
    times_s: Option<Vec<f64>>,
}

pub(super) fn parse(file: &str, text: &str, paths: &[String]) -> Result<Imported, ImportError> {
    let metadata: Metadata =
        serde_json::from_str(text).map_err(|error| ImportError::new(file, "the file", error))?;
    let times_s = metadata.times_s.unwrap_or_default();
    let intrinsics = metadata.intrinsics.unwrap_or_default();
    let frame = |(index, numbers): (usize, &Vec<f64>)| {
        let folders = ["rgbd/", "rgb/", ""].into_iter();
        let names = folders.flat_map(|folder| ["jpg", "png"].map(|kind| format!("{folder}{index}.{kind}")));
        let image = picture(paths, names)?;
        Some((|| {
            let field = format!("poses[{index}]");
            let &[qx, qy, qz, qw, x, y, z] = numbers.as_slice() else {
                let reason = ImportReason::Length {
                    n: numbers.len(),
                    expected: "7",
                };
                return Err(ImportError::new(file, field, reason));
            };
            Ok(ImportedFrame {
                time_s: time_s(file, index, &times_s, metadata.fps)?,
                image,
                intrinsics: match intrinsics.get(index) {
                    Some(numbers) => of_frame(file, index, numbers)?,
                    None => of_matrix(file, &metadata.matrix)?,
                },
                recorded_from_camera: pose(file, &field, [qx, qy, qz, qw], [x, y, z])?,
            })
        })())
    };
    let frames = metadata.poses.iter().enumerate().filter_map(frame);
    Ok(Imported {
        frames: whole(file, frames.collect::<Result<_, _>>()?)?,
        lens: None,
        up: None,
        is_metric: true,
    })
}

fn time_s(file: &str, index: usize, times_s: &[f64], fps: Option<f64>) -> Result<Option<f64>, ImportError> {
    if let Some(time_s) = times_s.get(index) {
        return number(file, &format!("frameTimestamps[{index}]"), *time_s).map(Some);
    }
    let Some(fps) = fps else { return Ok(None) };
    if fps.is_nan() || fps <= 0.0 {
        return Err(ImportError::new(
            file,
            "fps",
            ImportReason::NotANumber(fps.to_string()),
        ));
    }
    let time_s = index as f64 / fps;
    number(file, "fps", time_s).map(Some)
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
