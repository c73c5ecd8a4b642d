//! A shot: a scene and the photographs of its key poses, as `shot.json` lists them.
//!
//! The file has the fields of a session's `capture.json`, but for `keys` in place of `frames`, and a pose for each print in place of the
//! toy's one.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use app_core::scene::{Pose, Scene};
use app_core::session::SessionWarning;
use app_core::session::record::{
    BackgroundRecord, CaptureRecord, Encoding, FrameRecord, Index, IntrinsicsRecord, LensRecord, LightRecord,
    PoseRecord, ReceiverRecord, ToyRecord, UncertaintyRecord,
};
use app_core::session::{
    Capture, FileError, Files, Folder, FolderError, INDEX_FILE, MAX_INDEX_BYTES, Session, SessionError,
    SessionFrame,
};
use app_core::toy::ToyError;
use serde::Deserialize;
use thiserror::Error;

use super::nodes;
use super::nodes::NodeRecords;

/// File name of a shot's index in its folder.
pub const SHOT_FILE: &str = "shot.json";
/// Value of `format`.
pub const FORMAT: &str = "shadow-shot";
/// The only supported version.
pub const VERSION: u64 = 1;

/// `shot.json`, version 1. Other fields are as in `capture.json`.
#[derive(Clone, Debug, Deserialize)]
struct ShotRecord {
    /// `shadow-shot`.
    format: String,
    /// 1.
    version: u64,
    /// Name for people; may be empty.
    #[serde(default)]
    name: String,
    width: u32,
    height: u32,
    intrinsics: IntrinsicsRecord,
    lens: Option<LensRecord>,
    toy: MarkedToyRecord,
    receivers: Vec<ReceiverRecord>,
    #[serde(default)]
    lights: Vec<LightRecord>,
    #[serde(default)]
    backgrounds: Vec<BackgroundRecord>,
    /// Photographs of prints, in the order of the film.
    keys: Vec<KeyRecord>,
    uncertainty: Option<UncertaintyRecord>,
}

/// The toy of a shot.
#[derive(Clone, Debug, Deserialize)]
struct MarkedToyRecord {
    file: String,
    /// The place of the mark for all prints: each print is searched near it.
    world_from_object: [f64; 16],
    resting: Option<bool>,
}

/// A print and its photograph.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct KeyRecord {
    /// Path of the photograph in the shot's folder.
    image: String,
    /// Seconds of the film.
    time: f64,
    /// Pose of the print: a moment of a clip.
    physical_pose: Option<PoseRecord>,
    /// The pose by its nodes, if it is in no clip.
    nodes: Option<NodeRecords>,
    /// The camera; without it, that of the first plate.
    world_from_camera: Option<[f64; 16]>,
    intrinsics: Option<IntrinsicsRecord>,
    /// The place of the print; without it, the mark.
    world_from_object: Option<[f64; 16]>,
}

/// A shot that cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ShotError {
    /// There is no such folder.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The index cannot be read.
    #[error("{}: {reason}", path.display())]
    Index {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// A value, the toy or a picture cannot be used.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// Photographs with a lens's distortion.
    #[error(
        "{SHOT_FILE} (lens): the film would have no distortion, unlike the photographs; remove the lens's \
         distortion in the program that develops them, and leave lens out"
    )]
    Lens,
    /// A film needs more than one key.
    #[error("{SHOT_FILE} (keys): {n_keys} given, but in-between frames need two or more")]
    TooFewKeys {
        /// Number of keys.
        n_keys: usize,
    },
    /// Keys out of the film's order.
    #[error("{SHOT_FILE} (keys[{index}].time): {time_secs} s is not later than that of the key before")]
    TimeOrder {
        /// The key, from 0.
        index: usize,
        /// Its time.
        time_secs: f64,
    },
    /// A pose that is given twice.
    #[error("{SHOT_FILE} (keys[{index}]): has both physical_pose and nodes; remove one of them")]
    TwoPoses {
        /// The key, from 0.
        index: usize,
    },
    /// A pose that the toy cannot take.
    #[error("{SHOT_FILE} (keys[{index}].nodes): {reason}")]
    Nodes {
        /// The key, from 0.
        index: usize,
        /// The reason.
        reason: ToyError,
    },
    /// Neither a key nor a plate states the camera.
    #[error(
        "{SHOT_FILE} (keys[{index}].world_from_camera): missing, and there is no plate whose camera could replace it"
    )]
    NoCamera {
        /// The key, from 0.
        index: usize,
    },
}

/// An open shot: all its files are checked, and its photographs are read on demand.
pub struct Shot {
    capture: Capture,
    /// The folder that it was opened in.
    folder: Option<PathBuf>,
    /// Poses that are in no clip, by the index of their key.
    node_poses: BTreeMap<usize, Pose>,
}

/// A shot's files, whose index is read like a session's.
struct ShotFiles<F> {
    files: F,
    index: Vec<u8>,
}

impl<F: Files> Files for ShotFiles<F> {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        if path == INDEX_FILE {
            return Ok(self.index.clone());
        }
        self.files.read(path, max_bytes)
    }
}

impl Shot {
    /// Opens a folder with a `shot.json`, or such a file of any name.
    ///
    /// # Errors
    /// When a file is missing, damaged or breaks a rule. The error names file, field and reason.
    pub fn open(path: &Path) -> Result<Self, ShotError> {
        let file = if path.is_dir() {
            path.join(SHOT_FILE)
        } else {
            path.to_owned()
        };
        let at_file = |reason: String| ShotError::Index {
            path: file.clone(),
            reason,
        };
        let n_bytes = fs::metadata(&file)
            .map_err(|error| at_file(error.to_string()))?
            .len();
        if n_bytes > MAX_INDEX_BYTES {
            return Err(at_file(format!(
                "larger than the {MAX_INDEX_BYTES} bytes allowed"
            )));
        }
        let text = fs::read(&file).map_err(|error| at_file(error.to_string()))?;
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        let shot = Self::read(&text, Folder::open(folder)?).map_err(|error| match error {
            ShotError::Index { reason, .. } => at_file(reason),
            error => error,
        })?;
        Ok(Self {
            folder: Some(folder.to_owned()),
            ..shot
        })
    }

    /// Reads the text of a `shot.json`, whose pictures and toy are among `files`.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn read(text: &[u8], files: impl Files + 'static) -> Result<Self, ShotError> {
        let at_file = |reason: String| ShotError::Index {
            path: SHOT_FILE.into(),
            reason,
        };
        let record = parsed(text).map_err(at_file)?;
        if record.lens.is_some() {
            return Err(ShotError::Lens);
        }
        check_keys(&record)?;
        let nodes: Vec<_> = record.keys.iter().map(|key| key.nodes.clone()).collect();
        let capture = capture_record(record)?;
        let index = serde_json::to_vec(&Index::from(capture)).map_err(|error| at_file(error.to_string()))?;
        let capture = Capture::open(ShotFiles { files, index }).map_err(as_of_shot)?;
        let node_poses = node_poses(capture.scene(), &nodes)?;
        Ok(Self {
            capture,
            folder: None,
            node_poses,
        })
    }

    /// The shot's folder; `None` if its files come from elsewhere.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The scene, in which the toy is as authored.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        self.capture.scene()
    }

    /// Number of keys; two or more.
    #[must_use]
    pub fn n_keys(&self) -> usize {
        self.capture.n_frames()
    }

    /// Warnings about the files.
    #[must_use]
    pub fn warnings(&self) -> &[SessionWarning] {
        self.capture.warnings()
    }

    /// A key: its photograph, and the print's pose as the pose to show.
    ///
    /// # Errors
    /// When there is no such key, or its photograph cannot be read.
    pub fn key(&self, index: usize) -> Result<SessionFrame, ShotError> {
        let mut frame = self.capture.frame(index).map_err(as_of_shot)?;
        if let Some(pose) = self.node_poses.get(&index) {
            frame.shown_pose = pose.clone();
        }
        Ok(frame)
    }

    /// The scene with the toy in the pose of a print.
    #[must_use]
    pub fn scene_with(&self, pose: &Pose) -> Scene {
        self.scene().clone().with_physical_pose(pose.clone())
    }

    /// A pose in words.
    #[must_use]
    pub fn pose_text(&self, pose: &Pose) -> String {
        match pose {
            Pose::Clip { clip, time_secs } => {
                let names = self.scene().toy.clip_names();
                let name = names.get(clip.index()).map_or("", String::as_str);
                format!("{name}@{time_secs:.4}")
            }
            Pose::Authored => "as authored".to_owned(),
            Pose::Nodes(_) => "by its nodes".to_owned(),
        }
    }
}

fn parsed(text: &[u8]) -> Result<ShotRecord, String> {
    let mut json = serde_json::Deserializer::from_slice(text);
    let record: ShotRecord = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let field = error.path().to_string();
        format!("({field}): {}", error.into_inner())
    })?;
    json.end().map_err(|error| error.to_string())?;
    if (record.format.as_str(), record.version) != (FORMAT, VERSION) {
        return Err(format!(
            "(format, version): {:?} {} is not supported; write {FORMAT:?} {VERSION}",
            record.format, record.version
        ));
    }
    Ok(record)
}

fn node_poses(scene: &Scene, nodes: &[Option<NodeRecords>]) -> Result<BTreeMap<usize, Pose>, ShotError> {
    let given = nodes.iter().enumerate();
    let given = given.filter_map(|(index, nodes)| Some((index, nodes.as_ref()?)));
    let poses = given.map(|(index, nodes)| match nodes::pose(&scene.toy, nodes) {
        Ok(pose) => Ok((index, pose)),
        Err(reason) => Err(ShotError::Nodes { index, reason }),
    });
    poses.collect()
}

fn check_keys(record: &ShotRecord) -> Result<(), ShotError> {
    let keys = &record.keys;
    if keys.len() < 2 {
        return Err(ShotError::TooFewKeys { n_keys: keys.len() });
    }
    let is_twofold = |key: &KeyRecord| key.physical_pose.is_some() && key.nodes.is_some();
    if let Some(index) = keys.iter().position(is_twofold) {
        return Err(ShotError::TwoPoses { index });
    }
    for (index, pair) in (1..).zip(keys.windows(2)) {
        if pair[1].time.partial_cmp(&pair[0].time) != Some(std::cmp::Ordering::Greater) {
            return Err(ShotError::TimeOrder {
                index,
                time_secs: pair[1].time,
            });
        }
    }
    Ok(())
}

/// The record of a session whose frames are the keys.
fn capture_record(record: ShotRecord) -> Result<CaptureRecord, ShotError> {
    let of_plate = record.backgrounds.first().map(|plate| plate.world_from_camera);
    let frames = record.keys.iter().enumerate().map(|(index, key)| {
        let world_from_camera = key.world_from_camera.or(of_plate);
        Ok(FrameRecord {
            time: key.time,
            image: key.image.clone(),
            intrinsics: key.intrinsics,
            world_from_object: key.world_from_object,
            world_from_camera: world_from_camera.ok_or(ShotError::NoCamera { index })?,
            animation: key.physical_pose.clone().unwrap_or_default(),
            ..FrameRecord::default()
        })
    });
    let frames = frames.collect::<Result<Vec<_>, ShotError>>()?;
    Ok(CaptureRecord {
        name: record.name,
        width: record.width,
        height: record.height,
        encoding: Encoding::Srgb,
        intrinsics: record.intrinsics,
        lens: None,
        toy: ToyRecord {
            file: record.toy.file,
            world_from_object: record.toy.world_from_object,
            physical_pose: PoseRecord::default(),
            resting: record.toy.resting,
        },
        receivers: record.receivers,
        lights: record.lights,
        backgrounds: record.backgrounds,
        frames,
        probe: None,
        place_mesh: None,
        uncertainty: record.uncertainty,
    })
}

/// Names file and field as the shot has them.
fn as_of_shot(mut error: SessionError) -> SessionError {
    if error.file == INDEX_FILE {
        SHOT_FILE.clone_into(&mut error.file);
    }
    let field = error.field.replace("frames[", "keys[");
    error.field = field.replace(".animation", ".physical_pose");
    error
}
