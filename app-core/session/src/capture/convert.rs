//! From the records of `capture.json` to a capture of checked values.

use std::borrow::Cow;
use std::sync::{Arc, Mutex};

use super::field::{at, check_named, each, in_index, non_empty, read_named};
use super::light_estimate::light_estimate;
use super::light_probe::probe;
use super::place::{self, camera, intrinsics, light, plates, receiver};
use super::record::{CaptureRecord, FrameRecord, PlaceMeshRecord, PoseRecord};
use super::{Capture, Frame, PictureStore, TruthFiles, uncertainty};
use crate::SessionWarning;
use crate::error::SessionError;
use crate::files::{Files, INDEX_FILE};
use crate::picture::PictureSize;
use app_scene::lens::Distortion;
use app_scene::place_mesh::PlaceMesh;
use app_scene::scene::{Intrinsics, Pose, Scene, check};
use app_scene::toy::{self, Toy};
use glam::DMat4;

const MAX_TOY_BYTES: u64 = toy::MAX_FILE_BYTES as u64;
const MAX_PLACE_MESH_BYTES: u64 = 64 << 20;

/// Checks every value, then reads the files that all frames share: the toy, the plates, the probe.
pub(super) fn capture_from_record(
    files: Box<dyn Files>,
    record: CaptureRecord,
    distortion: Option<Distortion>,
) -> Result<Capture, SessionError> {
    let size = picture_size(&record)?;
    let intrinsics = intrinsics("intrinsics", &record.intrinsics)?;
    let world_from_object = at(
        "toy.world_from_object",
        check::similarity(record.toy.world_from_object),
    )?;
    let receivers = non_empty("receivers", &record.receivers, receiver)?;
    let lights = each("lights", &record.lights, light)?;
    let uncertainty = record.uncertainty.as_ref();
    let uncertainty = uncertainty.map(|record| uncertainty::uncertainty("uncertainty", record));
    let uncertainty = uncertainty.transpose()?.unwrap_or_default();

    let place_mesh = record.place_mesh.as_ref();
    let place_mesh = place_mesh
        .map(|record| place_mesh_of(files.as_ref(), record))
        .transpose()?;
    let toy = read_toy(files.as_ref(), &record.toy.file)?;
    let mut warnings = toy_warnings(&toy, &record.toy.file);
    let physical_pose = pose(
        &toy,
        "toy.physical_pose",
        &record.toy.physical_pose,
        &mut warnings,
    )?;
    let defaults = Defaults {
        intrinsics,
        world_from_object,
    };
    let frames = non_empty("frames", &record.frames, |field, frame| {
        frame_from_record(&toy, &defaults, field, frame)
    })?;

    let store = PictureStore {
        files,
        size,
        distortion,
    };
    for frame in &frames {
        store.lens(&frame.camera.intrinsics)?;
    }
    let plates = plates(&store, &intrinsics, &record.backgrounds, &mut warnings)?;
    let probe = record
        .probe
        .as_ref()
        .zip(frames.first())
        .map(|(record, first)| probe(&store, record, (&intrinsics, &first.camera), &mut warnings))
        .transpose()?;
    let scene = Scene::new(
        [size.width_px, size.height_px],
        Arc::new(toy),
        world_from_object,
        receivers,
    )
    .with_name(record.name)
    .with_physical_pose(physical_pose)
    .with_resting(record.toy.resting)
    .with_lights(lights)
    .with_plates(plates)
    .with_probe(probe)
    .with_place_mesh(place_mesh)
    .with_uncertainty(uncertainty);
    Ok(Capture {
        store,
        scene,
        warnings,
        frames,
        last_picture: Mutex::new(None),
        last_depth: Mutex::new(None),
        last_people: Mutex::new(None),
    })
}

/// The index's lens, if it has one.
pub(super) fn distortion(record: &CaptureRecord) -> Result<Option<Distortion>, SessionError> {
    record.lens.as_ref().map(place::distortion).transpose()
}

fn picture_size(record: &CaptureRecord) -> Result<PictureSize, SessionError> {
    at("width", check::number(f64::from(record.width), &check::SIDE_PX))?;
    at("height", check::number(f64::from(record.height), &check::SIDE_PX))?;
    at("width, height", check::picture_size(record.width, record.height))?;
    Ok(PictureSize {
        width_px: record.width,
        height_px: record.height,
    })
}

/// The field that names the toy's file.
const TOY_FILE: &str = "toy.file";

/// A session's toy as one binary glTF: the bytes of the file that `toy.file` names, with the files
/// that it refers to included.
///
/// # Errors
/// When it cannot be read, is no glTF, or refers to a buffer that is not beside it.
pub fn toy_bytes(files: &dyn Files, path: &str) -> Result<Vec<u8>, SessionError> {
    let bytes = read_named(files, path, TOY_FILE, MAX_TOY_BYTES)?;
    let packed = toy::packed(path, &bytes, &mut toy_neighbours(files, path));
    let packed = match packed.map_err(|error| SessionError::new(path, TOY_FILE, error))? {
        Cow::Owned(packed) => Some(packed),
        Cow::Borrowed(_) => None,
    };
    Ok(packed.unwrap_or(bytes))
}

/// A reader of the files to which the toy's file at `path` refers, by their names relative to it.
pub fn toy_neighbours<'a>(
    files: &'a dyn Files,
    path: &str,
) -> impl FnMut(&str) -> Result<Vec<u8>, String> + use<'a> {
    let folder = path.rsplit_once('/').map(|(folder, _)| format!("{folder}/"));
    let folder = folder.unwrap_or_default();
    move |name| {
        let read = files.read(&format!("{folder}{name}"), MAX_TOY_BYTES);
        read.map_err(|error| error.to_string())
    }
}

fn read_toy(files: &dyn Files, path: &str) -> Result<Toy, SessionError> {
    Toy::from_glb(path, &toy_bytes(files, path)?).map_err(|error| SessionError::new(path, TOY_FILE, error))
}

fn place_mesh_of(files: &dyn Files, record: &PlaceMeshRecord) -> Result<PlaceMesh, SessionError> {
    let field = "place_mesh.file";
    let deviation_m = record.deviation.map(|deviation_m| {
        at(
            "place_mesh.deviation",
            check::number(deviation_m, &check::UNCERTAINTY_M),
        )
    });
    let deviation_m = deviation_m.transpose()?;
    let bytes = read_named(files, &record.file, field, MAX_PLACE_MESH_BYTES)?;
    PlaceMesh::from_glb(&record.file, &bytes, deviation_m)
        .map_err(|error| SessionError::new(&record.file, field, error))
}

fn toy_warnings(toy: &Toy, file: &str) -> Vec<SessionWarning> {
    let warnings = toy.warnings().iter().cloned();
    warnings
        .map(|warning| SessionWarning::Toy {
            file: file.to_owned(),
            warning,
        })
        .collect()
}

/// Finds the clip and clamps the time to it, with a warning if it changed.
fn pose(
    toy: &Toy,
    field: &str,
    record: &PoseRecord,
    warnings: &mut Vec<SessionWarning>,
) -> Result<Pose, SessionError> {
    let time_field = format!("{field}.time");
    let asked_secs = at(&time_field, check::time_secs(record.time, &check::CLIP_TIME_SECS))?;
    let Some(name) = &record.clip else {
        return Ok(Pose::Authored);
    };
    let clip = toy
        .find_clip(name)
        .map_err(|error| in_index(&format!("{field}.clip"), error))?;
    let (used_secs, clamped) = toy
        .clamp_time(clip, asked_secs)
        .map_err(|error| in_index(&time_field, error))?;
    if clamped {
        let file = INDEX_FILE.to_owned();
        warnings.push(SessionWarning::TimeClamped {
            file,
            field: time_field,
            asked_secs,
            used_secs,
        });
    }
    Ok(Pose::Clip {
        clip,
        time_secs: used_secs,
    })
}

/// Values for a frame without its own.
struct Defaults {
    intrinsics: Intrinsics,
    world_from_object: DMat4,
}

fn frame_from_record(
    toy: &Toy,
    defaults: &Defaults,
    field: &str,
    record: &FrameRecord,
) -> Result<Frame, SessionError> {
    let mut warnings = Vec::new();
    let picture_fields = [
        ("image", Some(&record.image)),
        ("depth", record.depth.as_ref()),
        ("people", record.people.as_ref()),
        ("truth", record.truth.as_ref()),
        ("mask", record.mask.as_ref()),
    ];
    for (name, path) in picture_fields {
        path.map_or(Ok(()), |path| check_named(path, &format!("{field}.{name}")))?;
    }
    let truth = record.truth.clone().zip(record.mask.clone());
    Ok(Frame {
        time_secs: at(
            &format!("{field}.time"),
            check::time_secs(record.time, &check::TIME_SECS),
        )?,
        picture: record.image.clone(),
        camera: camera(
            field,
            record.world_from_camera,
            (record.intrinsics.as_ref(), &defaults.intrinsics),
        )?,
        world_from_object: match record.world_from_object {
            Some(matrix) => at(&format!("{field}.world_from_object"), check::similarity(matrix))?,
            None => defaults.world_from_object,
        },
        world_from_shown: record
            .world_from_shown
            .map(|matrix| at(&format!("{field}.world_from_shown"), check::similarity(matrix)))
            .transpose()?,
        exposure: at(
            &format!("{field}.exposure"),
            check::number(record.exposure.unwrap_or(1.0), &check::EXPOSURE),
        )?,
        light_estimate: record
            .light_estimate
            .as_ref()
            .map(|estimate| light_estimate(&format!("{field}.light_estimate"), estimate))
            .transpose()?,
        depth: record.depth.clone(),
        people: record.people.clone(),
        shown_pose: pose(
            toy,
            &format!("{field}.animation"),
            &record.animation,
            &mut warnings,
        )?,
        warnings,
        truth: truth.map(|(picture, mask)| TruthFiles { picture, mask }),
    })
}
