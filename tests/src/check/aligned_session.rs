//! A session's folder with corrected poses and lights.

use std::fs;
use std::path::Path;

use anyhow::{Context, ensure};
use app_core::scene::Light;
use serde_json::{Value, json};

use crate::alignment::Alignments;
use crate::output::{make_folder, write_whole};

/// What makes a folder a session.
const INDEX: &str = "capture.json";

/// Copies a session's files, and writes its index with what was found. Returns the number of corrected frames.
///
/// # Errors
/// When the folder is there already, or a file cannot be read or written.
pub fn write(from: &Path, to: &Path, alignments: &Alignments) -> anyhow::Result<usize> {
    ensure!(!to.exists(), "{}: is there already", to.display());
    let text =
        fs::read_to_string(from.join(INDEX)).with_context(|| from.join(INDEX).display().to_string())?;
    let mut index: Value = serde_json::from_str(&text)?;
    let n_corrected = correct(&mut index, alignments);
    make_folder(to)?;
    copy(from, to)?;
    write_whole(&to.join(INDEX), format!("{index:#}\n").as_bytes())?;
    Ok(n_corrected)
}

/// Everything but the index.
fn copy(from: &Path, to: &Path) -> anyhow::Result<()> {
    for entry in fs::read_dir(from).with_context(|| from.display().to_string())? {
        let entry = entry?;
        let (source, target) = (entry.path(), to.join(entry.file_name()));
        if source.is_dir() {
            make_folder(&target)?;
            copy(&source, &target)?;
        } else if entry.file_name() != INDEX {
            fs::copy(&source, &target).with_context(|| source.display().to_string())?;
        }
    }
    Ok(())
}

fn correct(index: &mut Value, alignments: &Alignments) -> usize {
    let mut n_corrected = 0;
    let n_frames = index["frames"].as_array().map_or(0, Vec::len);
    for frame in 0..n_frames {
        let Some(aligned) = alignments.of(frame) else {
            continue;
        };
        let alignment = &aligned.alignment;
        let is_moved = alignment.report.pose.is_some_and(|pose| pose.is_applied);
        if is_moved {
            index["frames"][frame]["world_from_object"] = json!(alignment.world_from_object.to_cols_array());
        }
        if let Some(lights) = &alignment.lights {
            for (place, light) in lights.iter().enumerate() {
                merge(&mut index["lights"][place], light);
            }
        }
        n_corrected += usize::from(is_moved || alignment.lights.is_some());
    }
    n_corrected
}

/// Writes a light over the numbers of an entry; keys that are not its own stay.
fn merge(entry: &mut Value, light: &Light) {
    match light {
        Light::Sphere {
            position_in_world,
            radius_m,
        } => {
            entry["position"] = json!(position_in_world.to_array());
            entry["radius"] = json!(radius_m);
        }
        Light::Directional {
            direction_to_light_in_world,
            angular_radius_rad,
        } => {
            entry["direction_to_light"] = json!(direction_to_light_in_world.to_array());
            entry["angular_radius_deg"] = json!(angular_radius_rad.to_degrees());
        }
    }
}
