//! A scene of a BOP data set: `scene_camera.json`, `scene_gt.json`, and pictures numbered by their
//! keys.
//!
//! Poses are from the model to a camera with OpenCV's axes (y down, z forward), row by row, in
//! millimetres. Matrices of cameras are OpenCV's: their first pixel's centre is at (0, 0). The
//! recording's world is that of the toy's model, in metres: a scene without poses of its cameras
//! has no other.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DMat4, DVec3};
use serde::Deserialize;

use super::error::{ImportError, ImportReason};
use super::imported::{Imported, ImportedFrame};
use super::lens::Lens;
use super::paths::Known;
use super::values::{OPENCV_FROM_CAMERA, numbers, ordered, pose_of_rows, without_picture};

pub(super) const CAMERA_FILE: &str = "scene_camera.json";
pub(super) const TRUTH_FILE: &str = "scene_gt.json";

const METRES_IN_MM: f64 = 1e-3;
/// From OpenCV's first pixel to ours.
const HALF_PIXEL: f64 = 0.5;

#[derive(Deserialize)]
struct Camera {
    #[serde(rename = "cam_K")]
    matrix: Vec<f64>,
}

#[derive(Deserialize)]
struct Truth {
    #[serde(rename = "cam_R_m2c")]
    rotation: Vec<f64>,
    #[serde(rename = "cam_t_m2c")]
    translation: Vec<f64>,
    obj_id: u32,
}

pub(super) fn parse(texts: [&str; 2], known: &Known, object: Option<u32>) -> Result<Imported, ImportError> {
    let json =
        |file: &'static str| move |error| ImportError::new(file, "the file", ImportReason::Json(error));
    let cameras: BTreeMap<u32, Camera> = serde_json::from_str(texts[0]).map_err(json(CAMERA_FILE))?;
    let truths: BTreeMap<u32, Vec<Truth>> = serde_json::from_str(texts[1]).map_err(json(TRUTH_FILE))?;
    let object = toy(&truths, object)?;
    let mut frames = Vec::new();
    let mut missing = Vec::new();
    let mut n_without = 0;
    let mut n_several = 0;
    for (key, truths) in &truths {
        let mut instances = truths.iter().filter(|truth| truth.obj_id == object);
        let Some(truth) = instances.next() else {
            n_without += 1;
            continue;
        };
        n_several += usize::from(instances.next().is_some());
        let folders = ["rgb", "gray"].into_iter();
        let names =
            folders.flat_map(|folder| ["png", "jpg", "jpeg"].map(|kind| format!("{folder}/{key:06}.{kind}")));
        match known.first(names) {
            Some(image) => frames.push(frame(*key, image, (&cameras, truth))?),
            None => missing.push(format!("rgb/{key:06}.png")),
        }
    }
    let mut notes = Vec::from_iter(without_picture(&missing, truths.len()));
    if n_without > 0 {
        notes.push(format!("{n_without} frames without object {object} are skipped"));
    }
    if n_several > 0 {
        notes.push(format!(
            "object {object} occurs several times in {n_several} frames, and the toy is the first of them in each: check that this is always the same one"
        ));
    }
    Ok(Imported {
        frames: ordered(TRUTH_FILE, frames, missing.into_iter().next())?,
        up: None,
        is_metric: true,
        recorded_from_object: Some(DMat4::from_scale(DVec3::splat(METRES_IN_MM))),
        notes,
    })
}

/// The requested object, or the only one.
fn toy(truths: &BTreeMap<u32, Vec<Truth>>, asked: Option<u32>) -> Result<u32, ImportError> {
    let objects: BTreeSet<u32> = truths.values().flatten().map(|truth| truth.obj_id).collect();
    let mut all = objects.iter().copied();
    match (asked, all.next(), all.next()) {
        (Some(asked), ..) if objects.contains(&asked) => Ok(asked),
        (None, Some(only), None) => Ok(only),
        (None, None, _) => Err(ImportError::new(
            TRUTH_FILE,
            "the frames",
            ImportReason::NoFrames { first: None },
        )),
        _ => {
            let listed: Vec<String> = objects.iter().map(u32::to_string).collect();
            let reason = ImportReason::Objects(listed.join(", "));
            Err(ImportError::new(TRUTH_FILE, "obj_id", reason))
        }
    }
}

fn frame(
    key: u32,
    image: String,
    (cameras, truth): (&BTreeMap<u32, Camera>, &Truth),
) -> Result<ImportedFrame, ImportError> {
    let missing = || ImportError::new(CAMERA_FILE, key.to_string(), ImportReason::Missing);
    let camera = cameras.get(&key).ok_or_else(missing)?;
    let field = format!("{key}.cam_K");
    let [fx, _, cx, _, fy, cy, ..] = numbers::<9>(CAMERA_FILE, &field, (&camera.matrix, "9"))?;
    let field = format!("{key}.cam_R_m2c");
    let rows = numbers(TRUTH_FILE, &field, (&truth.rotation, "9"))?;
    let translation_mm: [f64; 3] =
        numbers(TRUTH_FILE, &format!("{key}.cam_t_m2c"), (&truth.translation, "3"))?;
    let translation_m = translation_mm.map(|mm| METRES_IN_MM * mm);
    let opencv_from_model = pose_of_rows(TRUTH_FILE, &field, rows, translation_m)?;
    Ok(ImportedFrame {
        time_s: None,
        image,
        depth: None,
        intrinsics: [fx, fy, cx + HALF_PIXEL, cy + HALF_PIXEL],
        size_px: None,
        lens: Lens::NONE,
        recorded_from_camera: opencv_from_model.inverse() * OPENCV_FROM_CAMERA,
    })
}
