//! Writes the session's folder.

use std::path::{Path, PathBuf};

use app_core::scene::{Camera, Image};
use app_core::session::record::{
    BackgroundRecord, CaptureRecord, Encoding, FrameRecord, Index, LightRecord, PoseRecord, ReceiverRecord,
    ToyRecord,
};
use app_core::session::{Capture, Session};
use desk::files::{Folder, SESSION_FILE, index_text};
use desk::output::{make_folder, write_png, write_whole};

use super::found::Found;
use super::{Given, Wanted, shot};
use crate::inbetween::shot::Shot;
use crate::photograph::Photograph;
use crate::video::PICTURES_PER_SEC;

const TOY: &str = "toy.glb";
const PHOTOGRAPH: &str = "photograph.png";

/// Pictures that follow the photograph in its video.
fn following(given: &Given) -> &[PathBuf] {
    given.video.as_ref().map_or(&[], |video| &video.pictures()[1..])
}

/// File of a video's picture, counted from 0.
fn picture_file(index: usize) -> String {
    match index {
        0 => PHOTOGRAPH.to_owned(),
        _ => format!("photograph_{index:05}.png"),
    }
}

fn plate_file(index: usize) -> String {
    format!("plate_{index}.png")
}

/// Writes a folder and reads it once, to make sure that it is a valid session; the index is written
/// last.
pub(super) fn write(given: &Given, found: &Found, wanted: &Wanted, out: &Path) -> anyhow::Result<()> {
    make_folder(out)?;
    write_whole(&out.join(TOY), &given.toy_bytes)?;
    let plates = given.plates.iter().enumerate();
    for (index, plate) in plates {
        write_png(&out.join(plate_file(index)), &plate.image)?;
    }
    write_png(&out.join(picture_file(0)), &given.photograph.image)?;
    for (index, path) in following(given).iter().enumerate() {
        let picture = Photograph::read(path)?;
        write_png(&out.join(picture_file(index + 1)), &picture.image)?;
    }
    let record = record(given, found, wanted);
    if !wanted.keys.is_empty() {
        shot::write(given, record.clone(), wanted, out)?;
    }
    let index = Index::from(record);
    write_whole(&out.join(SESSION_FILE), &index_text(&index)?)?;
    Capture::open(Folder::open(out)?)?.frame(0)?;
    if !wanted.keys.is_empty() {
        Shot::open(out)?;
    }
    Ok(())
}

fn record(given: &Given, found: &Found, wanted: &Wanted) -> CaptureRecord {
    let Image {
        width_px, height_px, ..
    } = given.photograph.image;
    let scene = &found.scene;
    let columns = |camera: &Camera| camera.world_from_camera.to_cols_array();
    let plates = scene.plates.iter().enumerate();
    let (clip, time) = match &wanted.moment {
        Some((clip, time_secs)) => (Some(clip.clone()), *time_secs),
        None => (None, 0.0),
    };
    let stem = given.photograph.path.file_stem().unwrap_or_default();
    CaptureRecord {
        name: stem.to_string_lossy().into_owned(),
        width: width_px,
        height: height_px,
        encoding: Encoding::Srgb,
        intrinsics: (&given.intrinsics).into(),
        lens: None,
        toy: ToyRecord {
            file: TOY.to_owned(),
            world_from_object: scene.world_from_object.to_cols_array(),
            physical_pose: PoseRecord { clip, time },
            resting: scene.resting,
        },
        receivers: scene.receivers.iter().map(ReceiverRecord::from).collect(),
        lights: found.lights().iter().map(LightRecord::from).collect(),
        backgrounds: plates
            .map(|(index, plate)| BackgroundRecord {
                image: plate_file(index),
                intrinsics: None,
                world_from_camera: columns(&plate.camera),
            })
            .collect(),
        frames: (0..=following(given).len())
            .map(|index| FrameRecord {
                image: picture_file(index),
                time: index as f64 / f64::from(PICTURES_PER_SEC),
                world_from_camera: columns(&found.input.camera),
                ..FrameRecord::default()
            })
            .collect(),
        probe: None,
        place_mesh: None,
        uncertainty: None,
    }
}
