//! nerfstudio's `transforms.json`, in and out.
//!
//! Camera axes are OpenGL's, which are ours; the world has +Z up; matrices are written row by row. Principal points are
//! taken as they are: `cx` is half the width in the middle. Times, scale and the scene itself are not in it.

use std::path::Path;

use anyhow::Context;
use app_core::session::Files;
use glam::{DMat4, DVec3, DVec4};
use serde::Deserialize;
use serde_json::{Value, json};

use super::error::{ImportError, ImportReason};
use super::{Imported, ImportedFrame, has, number, whole};
use crate::files::SESSION_FILE;
use crate::output::{make_folder, write_whole};
use crate::stored::Stored;

/// No picture of a session is larger.
const MAX_FILE_BYTES: u64 = 512 << 20;

#[derive(Deserialize)]
struct Transforms {
    camera_model: Option<String>,
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

pub(super) fn parse(file: &str, text: &str, paths: &[String]) -> Result<Imported, ImportError> {
    let transforms: Transforms =
        serde_json::from_str(text).map_err(|error| ImportError::new(file, "the file", error))?;
    if let Some(model) = &transforms.camera_model
        && !["OPENCV", "PINHOLE", "SIMPLE_PINHOLE"].contains(&model.as_str())
    {
        return Err(ImportError::new(
            file,
            "camera_model",
            ImportReason::Lens(model.clone()),
        ));
    }
    let lens = lens(file, "", &transforms.camera)?;
    let frame = |(index, frame): (usize, &Frame)| {
        let image = image_path(&frame.file_path, paths)?;
        Some((|| {
            let field = |name: &str| format!("frames[{index}].{name}");
            if self::lens(file, &field(""), &frame.camera)?.is_some_and(|own| Some(own) != lens) {
                let reason = ImportReason::Lens("a lens of a frame's own".to_owned());
                return Err(ImportError::new(file, field("k1"), reason));
            }
            let time_s = frame.time.map(|time_s| number(file, &field("time"), time_s));
            Ok(ImportedFrame {
                time_s: time_s.transpose()?,
                image,
                intrinsics: intrinsics(file, [&frame.camera, &transforms.camera])?,
                recorded_from_camera: matrix(file, &field("transform_matrix"), &frame.transform_matrix)?,
            })
        })())
    };
    let frames = transforms.frames.iter().enumerate().filter_map(frame);
    Ok(Imported {
        frames: whole(file, frames.collect::<Result<_, _>>()?)?,
        lens,
        up: Some(DVec3::Z),
        is_metric: false,
    })
}

/// As written, without `./`, and as instant-ngp has it without an ending.
fn image_path(path: &str, paths: &[String]) -> Option<String> {
    let path = path.strip_prefix("./").unwrap_or(path);
    let names = ["", ".png", ".jpg", ".jpeg"].map(|ending| format!("{path}{ending}"));
    names.into_iter().find(|name| has(paths, name))
}

fn lens(file: &str, prefix: &str, camera: &Projection) -> Result<Option<[f64; 2]>, ImportError> {
    let others = [
        ("k3", camera.k3),
        ("k4", camera.k4),
        ("p1", camera.p1),
        ("p2", camera.p2),
    ];
    if let Some((name, Some(value))) = others
        .into_iter()
        .find(|(_, value)| value.is_some_and(|value| value != 0.0))
    {
        let reason = ImportReason::Lens(format!("{name} = {value}"));
        return Err(ImportError::new(file, format!("{prefix}{name}"), reason));
    }
    let terms = [camera.k1, camera.k2].map(|term| term.unwrap_or(0.0));
    for term in terms {
        number(file, &format!("{prefix}k1, k2"), term)?;
    }
    Ok((terms != [0.0; 2]).then_some(terms))
}

/// Of the first of two that states it.
fn intrinsics(file: &str, cameras: [&Projection; 2]) -> Result<[f64; 4], ImportError> {
    let of = |name: &str, get: fn(&Projection) -> Option<f64>| {
        let value = cameras.into_iter().find_map(get);
        value.map(|value| number(file, name, value)).transpose()
    };
    let missing = |name: &str| ImportError::new(file, name, ImportReason::Missing);
    let [width, height] = [of("w", |camera| camera.w)?, of("h", |camera| camera.h)?];
    let by_angle = match (of("camera_angle_x", |camera| camera.camera_angle_x)?, width) {
        (Some(angle_rad), Some(width)) => Some(number(
            file,
            "camera_angle_x",
            0.5 * width / (0.5 * angle_rad).tan(),
        )?),
        _ => None,
    };
    let fx = of("fl_x", |camera| camera.fl_x)?
        .or(by_angle)
        .ok_or_else(|| missing("fl_x"))?;
    Ok([
        fx,
        of("fl_y", |camera| camera.fl_y)?.unwrap_or(fx),
        of("cx", |camera| camera.cx)?
            .or(width.map(|width| 0.5 * width))
            .ok_or_else(|| missing("cx"))?,
        of("cy", |camera| camera.cy)?
            .or(height.map(|height| 0.5 * height))
            .ok_or_else(|| missing("cy"))?,
    ])
}

/// Three or four rows of four.
fn matrix(file: &str, field: &str, rows: &[Vec<f64>]) -> Result<DMat4, ImportError> {
    let wrong = |n: usize, expected| ImportError::new(file, field, ImportReason::Length { n, expected });
    if !(3..=4).contains(&rows.len()) {
        return Err(wrong(rows.len(), "3 or 4 rows of 4"));
    }
    let mut all = [DVec4::ZERO, DVec4::ZERO, DVec4::ZERO, DVec4::W];
    for (row, numbers) in all.iter_mut().zip(rows) {
        let four: [f64; 4] = numbers
            .as_slice()
            .try_into()
            .map_err(|_| wrong(numbers.len(), "4"))?;
        for value in four {
            number(file, field, value)?;
        }
        *row = DVec4::from_array(four);
    }
    Ok(DMat4::from_cols(all[0], all[1], all[2], all[3]).transpose())
}

/// Writes a session's frames as a folder with `transforms.json`. Toy, receivers, lights and plates have no place in it.
///
/// # Errors
/// When `out` is there already, the session cannot be read, or the system refuses.
pub fn write_transforms(session: &Stored, out: &Path) -> anyhow::Result<()> {
    anyhow::ensure!(!out.exists(), "{}: is there already", out.display());
    let index = session.read(SESSION_FILE, MAX_FILE_BYTES).context(SESSION_FILE)?;
    let index: Value = serde_json::from_slice(&index).context(SESSION_FILE)?;
    let shared = &index["intrinsics"];
    let z_up_from_y_up = DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let mut frames = Vec::new();
    for (place, frame) in index["frames"].as_array().into_iter().flatten().enumerate() {
        let at = || format!("{SESSION_FILE} (frames[{place}])");
        let columns: [f64; 16] =
            serde_json::from_value(frame["world_from_camera"].clone()).with_context(at)?;
        let path = frame["image"].as_str().with_context(at)?;
        let file = out.join(path);
        if !file.exists() {
            let picture = session
                .read(path, MAX_FILE_BYTES)
                .with_context(|| path.to_owned())?;
            make_folder(file.parent().unwrap_or(out))?;
            write_whole(&file, &picture)?;
        }
        let rows = (z_up_from_y_up * DMat4::from_cols_array(&columns))
            .transpose()
            .to_cols_array_2d();
        let own = if frame["intrinsics"].is_null() {
            shared
        } else {
            &frame["intrinsics"]
        };
        frames.push(json!({
            "file_path": path, "transform_matrix": rows, "time": frame["time"],
            "fl_x": own["fx"], "fl_y": own["fy"], "cx": own["cx"], "cy": own["cy"],
        }));
    }
    let lens = &index["lens"];
    let term = |name: &str| lens[name].as_f64().unwrap_or(0.0);
    let transforms = json!({
        "camera_model": "OPENCV", "w": index["width"], "h": index["height"],
        "fl_x": shared["fx"], "fl_y": shared["fy"], "cx": shared["cx"], "cy": shared["cy"],
        "k1": term("k1"), "k2": term("k2"), "p1": 0.0, "p2": 0.0, "frames": frames,
    });
    Ok(write_whole(
        &out.join("transforms.json"),
        &serde_json::to_vec_pretty(&transforms)?,
    )?)
}
