//! Writes a shot as a session's folder, for replay.

use std::path::Path;

use app_core::session::ScenePaths;
use app_core::session::record::{CaptureRecord, FrameRecord, Index, PoseRecord, Remarks};
use serde_json::json;

use super::shot::Shot;
use desk::files::SESSION_FILE;
use desk::output::{WriteError, make_folder, write_png, write_whole};

/// Writes a session's folder.
///
/// # Errors
/// When a file cannot be written.
pub fn write(folder: &Path, shot: &Shot) -> Result<(), WriteError> {
    make_folder(folder)?;
    for plate in &shot.scene.plates {
        write_png(&folder.join("plate.png"), &plate.image)?;
    }
    write_png(&folder.join("frame.png"), shot.input.image.rgba())?;
    write_png(&folder.join("truth.png"), &shot.truth.image)?;
    write_png(&folder.join("mask.png"), &shot.truth.mask)?;
    write_whole(&folder.join("toy.glb"), &shot.glb)?;
    let pictures = shot.scene.probe.iter().flat_map(|probe| &probe.pictures);
    for (index, picture) in pictures.enumerate() {
        write_png(&folder.join(probe_file(index)), &picture.image)?;
    }
    let text = format!("{:#}\n", json!(index(shot)));
    write_whole(&folder.join(SESSION_FILE), text.as_bytes())
}

fn index(shot: &Shot) -> Index {
    let scene = &shot.scene;
    let n_pictures = scene.probe.as_ref().map_or(0, |probe| probe.pictures.len());
    let paths = ScenePaths {
        toy: "toy.glb",
        plates: &["plate.png".to_owned()],
        probe: &(0..n_pictures).map(probe_file).collect::<Vec<_>>(),
        place_mesh: None,
    };
    let frame = FrameRecord {
        image: "frame.png".to_owned(),
        world_from_camera: shot.input.camera.world_from_camera.to_cols_array(),
        animation: PoseRecord::new(&shot.input.shown_pose, &scene.toy),
        truth: Some("truth.png".to_owned()),
        mask: Some("mask.png".to_owned()),
        ..FrameRecord::default()
    };
    let capture = CaptureRecord {
        frames: vec![frame],
        ..CaptureRecord::new(scene, &shot.input.camera.intrinsics, paths)
    };
    Index {
        remarks: Remarks {
            description: Some("Photographed by exact rays.".to_owned()),
            credits: Some(String::new()),
            units: None,
        },
        ..Index::from(capture)
    }
}

fn probe_file(index: usize) -> String {
    format!("probe_{index}.png")
}
