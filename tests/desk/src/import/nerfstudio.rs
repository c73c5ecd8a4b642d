//! nerfstudio's `transforms.json`, and that of instant-ngp.
//!
//! Camera axes are OpenGL's, which are ours; the world has +Z up; matrices are written row by row.
//! Principal points are used unchanged: `cx` is half the width for a centred one. The file has
//! neither scale nor scene, and rarely times.

use glam::{DMat3, DMat4, DVec3, DVec4};
use serde::Deserialize;

use super::error::{ImportError, ImportReason};
use super::imported::{Imported, ImportedFrame};
use super::lens::Lens;
use super::paths::{Known, Taken};
use super::values::{is_scaled_rotation, number, numbers, ordered, time_s, without_picture};

/// Largest deviation of a matrix's last row from 0 0 0 1.
const SAME_ROW: f64 = 1e-6;

#[derive(Deserialize)]
struct Transforms {
    camera_model: Option<String>,
    is_fisheye: Option<bool>,
    #[serde(flatten)]
    camera: Projection,
    frames: Vec<Frame>,
}

#[derive(Clone, Copy, Deserialize)]
struct Projection {
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    w: Option<f64>,
    h: Option<f64>,
    camera_angle_x: Option<f64>,
    k1: Option<f64>,
    k2: Option<f64>,
    k3: Option<f64>,
    k4: Option<f64>,
    p1: Option<f64>,
    p2: Option<f64>,
}

#[derive(Deserialize)]
struct Frame {
    file_path: String,
    transform_matrix: Vec<Vec<f64>>,
    time: Option<f64>,
    #[serde(flatten)]
    camera: Projection,
}

/// The model of OpenCV that the coefficients belong to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Model {
    Brown,
    Fisheye,
}

pub(super) fn parse(file: &str, text: &str, known: &Known) -> Result<Imported, ImportError> {
    let transforms: Transforms =
        serde_json::from_str(text).map_err(|error| ImportError::new(file, "the file", error))?;
    let model = model(file, &transforms)?;
    let mut frames = Vec::new();
    let mut missing = Vec::new();
    let mut taken = Taken::new();
    for (index, frame) in transforms.frames.iter().enumerate() {
        let Some(image) = known.picture(&frame.file_path, &[]) else {
            missing.push(frame.file_path.clone());
            continue;
        };
        let field = |name: &str| format!("frames[{index}].{name}");
        if !taken.take(&image, &frame.file_path) {
            return Err(ImportError::new(
                file,
                field("file_path"),
                ImportReason::Twice(image),
            ));
        }
        let cameras = Cameras {
            file,
            both: [&frame.camera, &transforms.camera],
        };
        let time = frame.time.map(|time| time_s(file, &field("time"), time));
        frames.push(ImportedFrame {
            time_s: time.transpose()?,
            image,
            depth: None,
            intrinsics: cameras.intrinsics()?,
            size_px: cameras.size_px()?,
            lens: cameras.lens(model)?,
            recorded_from_camera: matrix(file, &field("transform_matrix"), &frame.transform_matrix)?,
        });
    }
    let notes = without_picture(&missing, transforms.frames.len());
    Ok(Imported {
        frames: ordered(file, frames, missing.into_iter().next())?,
        up: Some(DVec3::Z),
        is_metric: false,
        recorded_from_object: None,
        notes: notes.into_iter().collect(),
    })
}

fn model(file: &str, transforms: &Transforms) -> Result<Model, ImportError> {
    const BROWN: [&str; 6] = [
        "OPENCV",
        "FULL_OPENCV",
        "PINHOLE",
        "SIMPLE_PINHOLE",
        "SIMPLE_RADIAL",
        "RADIAL",
    ];
    const FISHEYE: [&str; 3] = ["OPENCV_FISHEYE", "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE"];
    let named = match transforms.camera_model.as_deref() {
        None => Model::Brown,
        Some(name) if BROWN.contains(&name) => Model::Brown,
        Some(name) if FISHEYE.contains(&name) => Model::Fisheye,
        Some(name) => {
            let reason = ImportReason::Lens(name.to_owned());
            return Err(ImportError::new(file, "camera_model", reason));
        }
    };
    // instant-ngp has this flag in place of a model.
    Ok(match transforms.is_fisheye {
        Some(true) => Model::Fisheye,
        _ => named,
    })
}

/// A frame's camera and the common one; the first that states a number counts.
struct Cameras<'a> {
    file: &'a str,
    both: [&'a Projection; 2],
}

impl Cameras<'_> {
    fn stated(&self, name: &str, get: fn(&Projection) -> Option<f64>) -> Result<Option<f64>, ImportError> {
        let value = self.both.into_iter().find_map(get);
        value.map(|value| number(self.file, name, value)).transpose()
    }

    fn size_px(&self) -> Result<Option<[f64; 2]>, ImportError> {
        let [w, h] = [
            self.stated("w", |camera| camera.w)?,
            self.stated("h", |camera| camera.h)?,
        ];
        Ok(w.zip(h).map(|(w, h)| [w, h]))
    }

    fn lens(&self, model: Model) -> Result<Lens, ImportError> {
        let term = |name, get| Ok(self.stated(name, get)?.unwrap_or(0.0));
        let radial = [
            term("k1", |camera| camera.k1)?,
            term("k2", |camera| camera.k2)?,
            term("k3", |camera| camera.k3)?,
            term("k4", |camera| camera.k4)?,
        ];
        let tangential = [term("p1", |camera| camera.p1)?, term("p2", |camera| camera.p2)?];
        Ok(match model {
            Model::Fisheye => Lens::Fisheye(radial),
            Model::Brown => Lens::Brown {
                radial,
                divisor: [0.0; 3],
                tangential,
            },
        })
    }

    fn intrinsics(&self) -> Result<[f64; 4], ImportError> {
        let missing = |name: &str| ImportError::new(self.file, name, ImportReason::Missing);
        let [width, height] = [
            self.stated("w", |camera| camera.w)?,
            self.stated("h", |camera| camera.h)?,
        ];
        let angle = self.stated("camera_angle_x", |camera| camera.camera_angle_x)?;
        let by_angle = match (angle, width) {
            (Some(angle_rad), Some(width)) => Some(number(
                self.file,
                "camera_angle_x",
                0.5 * width / (0.5 * angle_rad).tan(),
            )?),
            _ => None,
        };
        let fx = self
            .stated("fl_x", |camera| camera.fl_x)?
            .or(by_angle)
            .ok_or_else(|| missing("fl_x"))?;
        Ok([
            fx,
            self.stated("fl_y", |camera| camera.fl_y)?.unwrap_or(fx),
            self.stated("cx", |camera| camera.cx)?
                .or(width.map(|width| 0.5 * width))
                .ok_or_else(|| missing("cx"))?,
            self.stated("cy", |camera| camera.cy)?
                .or(height.map(|height| 0.5 * height))
                .ok_or_else(|| missing("cy"))?,
        ])
    }
}

/// Three or four rows of four.
fn matrix(file: &str, field: &str, rows: &[Vec<f64>]) -> Result<DMat4, ImportError> {
    let wrong = |n: usize, expected| ImportError::new(file, field, ImportReason::Length { n, expected });
    if !(3..=4).contains(&rows.len()) {
        return Err(wrong(rows.len(), "3 or 4 rows of 4"));
    }
    let mut all = [DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::W];
    for (row, values) in all.iter_mut().zip(rows) {
        *row = DVec4::from_array(numbers(file, field, (values, "4"))?);
    }
    let matrix = DMat4::from_cols(all[0], all[1], all[2], all[3]).transpose();
    let is_affine = all[3].abs_diff_eq(DVec4::W, SAME_ROW);
    match is_affine && is_scaled_rotation(&DMat3::from_mat4(matrix)) {
        true => Ok(matrix),
        false => Err(ImportError::new(file, field, ImportReason::NotAPose)),
    }
}
