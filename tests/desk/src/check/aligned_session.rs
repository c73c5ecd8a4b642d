//! A session with corrected cameras, poses and lights.

use std::path::Path;
use std::sync::Arc;

use app_core::alignment::{LensAlignment, RatioOutcome};
use app_core::scene::{Light, Receiver};
use app_core::session::record::{LensRecord, LightRecord};
use serde::Serialize;
use serde_json::{Value, json};

use crate::alignment::Alignments;
use crate::convert;
use crate::files::{index_of, index_text};
use crate::stored::Stored;

/// The handling of lights that are assumed, since none was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Assumed {
    /// The session's list stays: assumed lights are no result.
    Omitted,
    /// They are written, to make pictures with them.
    Written,
}

/// Writes a session anew, as a folder or as a recording, with the estimates in its index. Returns
/// the number of corrected frames.
///
/// # Errors
/// When the new one exists already or would lie in the session, its index is too large to be read,
/// or a file is a link or cannot be read or written.
pub fn write(from: &Stored, to: &Path, alignments: &Alignments, assumed: Assumed) -> anyhow::Result<usize> {
    let mut index = index_of(from)?;
    let n_corrected = correct(&mut index, alignments, assumed);
    convert::write(from, Some(index_text(&index)?), to)?;
    Ok(n_corrected)
}

/// Moves the receivers of an index, and adds those that it lacks.
fn set_receivers(index: &mut Value, receivers: &[Receiver]) {
    let mut entries = index["receivers"].as_array().cloned().unwrap_or_default();
    for (place, receiver) in receivers.iter().enumerate() {
        let world_from_plane = json!(receiver.world_from_plane.to_cols_array());
        match entries.get_mut(place) {
            Some(entry) => entry["world_from_plane"] = world_from_plane,
            None => entries.push(json!({
                "name": receiver.name,
                "world_from_plane": world_from_plane,
                "half_extent": receiver.half_extent_m.to_array(),
                "surface": "textured",
            })),
        }
    }
    index["receivers"] = entries.into();
    if index["uncertainty"].is_object() {
        index["uncertainty"]["receivers_guessed"] = json!(false);
    }
}

fn correct(index: &mut Value, alignments: &Alignments, assumed: Assumed) -> usize {
    let mut n_corrected = 0;
    let has_other_lens = set_lens(index, alignments.lens());
    let focal_ratio = alignments.focal_ratio();
    lengthen(index, focal_ratio);
    for (plate, camera) in alignments.moved_plates() {
        index["backgrounds"][plate]["world_from_camera"] = json!(camera.world_from_camera.to_cols_array());
    }
    if let Some(receivers) = alignments.receivers() {
        set_receivers(index, receivers);
    }
    let n_frames = index["frames"].as_array().map_or(0, Vec::len);
    for frame in 0..n_frames {
        let Some(aligned) = alignments.of(frame) else {
            continue;
        };
        let alignment = &aligned.alignment;
        let is_moved = alignment.report.pose.is_some_and(|pose| pose.is_applied);
        let is_scaled = alignments.world_scale() != 1.0;
        if is_moved || is_scaled {
            index["frames"][frame]["world_from_object"] = json!(alignment.world_from_object.to_cols_array());
        }
        let is_camera_moved = alignment.report.camera.is_some_and(|camera| camera.is_applied);
        if is_camera_moved {
            index["frames"][frame]["world_from_camera"] =
                json!(alignment.camera.world_from_camera.to_cols_array());
        }
        // If none was found, the list stays.
        let is_taken = assumed == Assumed::Written || alignment.report.assumed.is_none();
        let is_found = |lights: &&Arc<[Light]>| !lights.is_empty() && is_taken;
        let found = alignment.lights.as_ref().filter(is_found);
        if let Some(lights) = found {
            let listed = index["lights"].as_array().cloned().unwrap_or_default();
            let mut entries = if aligned.put_aside.is_empty() {
                listed
            } else {
                Vec::new()
            };
            entries.resize(lights.len(), json!({}));
            for (entry, light) in entries.iter_mut().zip(lights.iter()) {
                overwrite(entry, &LightRecord::from(light));
            }
            index["lights"] = entries.into();
        }
        let is_other_camera = focal_ratio != 1.0 || has_other_lens;
        n_corrected +=
            usize::from(is_moved || is_scaled || is_camera_moved || found.is_some() || is_other_camera);
    }
    n_corrected
}

/// Writes the estimated lens, or its absence. Returns whether the lens changed.
fn set_lens(index: &mut Value, found: Option<&LensAlignment>) -> bool {
    let lens = match found {
        Some(found) if found.is_applied() => json!(LensRecord::from(&found.distortion)),
        Some(found) if found.outcome == RatioOutcome::AsGiven => Value::Null,
        _ => return false,
    };
    let before = index.get("lens").cloned().unwrap_or_default();
    if before != lens {
        index["lens"] = lens;
        return true;
    }
    false
}

/// Scales the focal length of the session, and those of single plates and frames.
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

/// Overwrites the keys of an entry that a record has; other keys stay.
fn overwrite(entry: &mut Value, record: &impl Serialize) {
    if let Value::Object(keys) = json!(record) {
        for (key, value) in keys {
            entry[key] = value;
        }
    }
}
