//! A session's folder with corrected cameras, poses and lights.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use app_core::scene::Light;
use glam::DMat4;
use serde_json::{Value, json};

use crate::alignment::Alignments;
use crate::files::SESSION_FILE;
use crate::output::{make_folder, write_whole};

/// Copies a session's files, and writes its index with what was found. Returns the number of corrected frames.
///
/// # Errors
/// When the folder is there already or would lie in the session, or a file is a link or cannot be read or written.
pub fn write(from: &Path, to: &Path, alignments: &Alignments) -> anyhow::Result<usize> {
    ensure!(!to.exists(), "{}: is there already", to.display());
    let text = fs::read_to_string(from.join(SESSION_FILE))
        .with_context(|| from.join(SESSION_FILE).display().to_string())?;
    let mut index: Value = serde_json::from_str(&text)?;
    let n_corrected = correct(&mut index, alignments);
    let files = files_below(from, Path::new(""))?;
    make_folder(to)?;
    let is_inside = to.canonicalize()?.starts_with(from.canonicalize()?);
    if is_inside {
        fs::remove_dir(to)?;
    }
    ensure!(!is_inside, "{}: lies in the session itself", to.display());
    for file in files.iter().filter(|file| *file != Path::new(SESSION_FILE)) {
        if let Some(folder) = file.parent() {
            make_folder(&to.join(folder))?;
        }
        fs::copy(from.join(file), to.join(file)).with_context(|| from.join(file).display().to_string())?;
    }
    write_whole(&to.join(SESSION_FILE), format!("{index:#}\n").as_bytes())?;
    Ok(n_corrected)
}

/// Files of a folder and of those in it, as paths within the session; a link could lead out of it.
fn files_below(session: &Path, folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let at = session.join(folder);
    let mut files = Vec::new();
    for entry in fs::read_dir(&at).with_context(|| at.display().to_string())? {
        let entry = entry?;
        let (kind, path) = (entry.file_type()?, folder.join(entry.file_name()));
        ensure!(!kind.is_symlink(), "{}: is a link", session.join(&path).display());
        if kind.is_dir() {
            files.extend(files_below(session, &path)?);
        } else {
            files.push(path);
        }
    }
    Ok(files)
}

fn correct(index: &mut Value, alignments: &Alignments) -> usize {
    let mut n_corrected = 0;
    let focal_ratio = alignments.focal_ratio();
    lengthen(index, focal_ratio);
    for (plate, camera) in alignments.moved_plates() {
        index["backgrounds"][plate]["world_from_camera"] = matrix(&camera.world_from_camera);
    }
    let n_frames = index["frames"].as_array().map_or(0, Vec::len);
    for frame in 0..n_frames {
        let Some(aligned) = alignments.of(frame) else {
            continue;
        };
        let alignment = &aligned.alignment;
        let is_moved = alignment.report.pose.is_some_and(|pose| pose.is_applied);
        if is_moved {
            index["frames"][frame]["world_from_object"] = matrix(&alignment.world_from_object);
        }
        let is_camera_moved = alignment.report.camera.is_some_and(|camera| camera.is_applied);
        if is_camera_moved {
            index["frames"][frame]["world_from_camera"] = matrix(&alignment.camera.world_from_camera);
        }
        if let Some(lights) = &alignment.lights {
            let mut entries = index["lights"].as_array().cloned().unwrap_or_default();
            entries.resize(lights.len(), json!({}));
            for (entry, light) in entries.iter_mut().zip(lights.iter()) {
                merge(entry, light);
            }
            index["lights"] = entries.into();
        }
        let is_lengthened = focal_ratio != 1.0;
        n_corrected +=
            usize::from(is_moved || is_camera_moved || alignment.lights.is_some() || is_lengthened);
    }
    n_corrected
}

/// Scales the focal length of the session, and those that plates and frames have of their own.
fn lengthen(index: &mut Value, ratio: f64) {
    if ratio == 1.0 {
        return;
    }
    for list in ["backgrounds", "frames"] {
        for entry in index[list].as_array_mut().into_iter().flatten() {
            lengthen_intrinsics(entry, ratio);
        }
    }
    lengthen_intrinsics(index, ratio);
}

fn lengthen_intrinsics(entry: &mut Value, ratio: f64) {
    let Some(intrinsics) = entry.get_mut("intrinsics") else {
        return;
    };
    for key in ["fx", "fy"] {
        if let Some(length_px) = intrinsics[key].as_f64() {
            intrinsics[key] = json!(ratio * length_px);
        }
    }
}

fn matrix(matrix: &DMat4) -> Value {
    json!(matrix.to_cols_array())
}

/// Writes a light over the numbers of an entry; keys that are not its own stay.
fn merge(entry: &mut Value, light: &Light) {
    match light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => {
            entry["kind"] = json!("sphere");
            entry["position"] = json!(position_in_world.to_array());
            entry["radius"] = json!(radius_m);
        }
        Light::Directional {
            direction_to_light_in_world,
            angular_radius_rad,
        } => {
            entry["kind"] = json!("directional");
            entry["direction_to_light"] = json!(direction_to_light_in_world.to_array());
            entry["angular_radius_deg"] = json!(angular_radius_rad.to_degrees());
        }
    }
}
