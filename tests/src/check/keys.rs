//! Keys of `capture.json` that no reader knows, which are mostly misspelt.

use app_core::session::Files;
use serde_json::Value;

use crate::files::{Folder, SESSION_FILE};

/// No longer index is read.
const MOST_BYTES: u64 = 16 << 20;
const INTRINSICS: &[&str] = &["fx", "fy", "cx", "cy"];
const POSE: &[&str] = &["clip", "time"];
/// Keys of each object, by its path without numbers.
const KNOWN: &[(&str, &[&str])] = &[
    (
        "",
        &[
            "format",
            "version",
            "name",
            "description",
            "credits",
            "units",
            "width",
            "height",
            "encoding",
            "intrinsics",
            "toy",
            "receivers",
            "lights",
            "backgrounds",
            "frames",
            "probe",
        ],
    ),
    ("intrinsics", INTRINSICS),
    ("toy", &["file", "world_from_object", "physical_pose"]),
    ("toy.physical_pose", POSE),
    (
        "receivers[]",
        &["name", "world_from_plane", "half_extent", "surface"],
    ),
    (
        "lights[]",
        &[
            "kind",
            "position",
            "radius",
            "direction_to_light",
            "angular_radius_deg",
        ],
    ),
    ("backgrounds[]", &["image", "intrinsics", "world_from_camera"]),
    ("backgrounds[].intrinsics", INTRINSICS),
    (
        "frames[]",
        &[
            "time",
            "image",
            "intrinsics",
            "world_from_object",
            "exposure",
            "world_from_camera",
            "animation",
            "truth",
            "mask",
        ],
    ),
    ("frames[].intrinsics", INTRINSICS),
    ("frames[].animation", POSE),
    (
        "probe",
        &["kind", "world_from_lens", "radius", "image", "exposure_ratio"],
    ),
];

/// Those of a session's index; none where it cannot be read, which the reader tells.
pub(super) fn unknown(folder: &Folder) -> Vec<String> {
    let bytes = folder.read(SESSION_FILE, MOST_BYTES).unwrap_or_default();
    let index: Value = serde_json::from_slice(&bytes).unwrap_or_default();
    let mut unknown = Vec::new();
    look(&index, "", "", &mut unknown);
    unknown
}

fn look(value: &Value, path: &str, kind: &str, unknown: &mut Vec<String>) {
    match value {
        Value::Object(entries) => {
            let Some((_, known)) = KNOWN.iter().find(|(of, _)| *of == kind) else {
                return;
            };
            for (key, value) in entries {
                let join = |parent: &str| match parent {
                    "" => key.clone(),
                    parent => format!("{parent}.{key}"),
                };
                if known.contains(&key.as_str()) {
                    look(value, &join(path), &join(kind), unknown);
                } else {
                    unknown.push(format!("{SESSION_FILE} ({}): the key is not known", join(path)));
                }
            }
        }
        Value::Array(entries) => {
            for (index, value) in entries.iter().enumerate() {
                look(value, &format!("{path}[{index}]"), &format!("{kind}[]"), unknown);
            }
        }
        _ => {}
    }
}
