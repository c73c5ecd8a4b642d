//! Writes a session's frames in nerfstudio's format.

use std::path::Path;

use anyhow::Context;
use app_core::session::Files;
use glam::DMat4;
use serde_json::json;

use crate::convert::check_out;
use crate::files::{SESSION_FILE, index_of};
use crate::output::{make_folder, write_whole};
use crate::stored::Stored;

/// Limit for a picture's size.
const MAX_FILE_BYTES: u64 = 512 << 20;

/// Writes a session's frames as a folder with `transforms.json`, which has no place for toy,
/// receivers, lights and plates.
///
/// # Errors
/// When `out` exists already or lies in the session's folder, the session cannot be read, or the
/// system refuses.
pub fn write_transforms(session: &Stored, out: &Path) -> anyhow::Result<()> {
    check_out(session, out)?;
    let index = index_of(session)?;
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
