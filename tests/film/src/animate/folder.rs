//! A film's folder: all its files are the film's own, and `film.json` describes each picture.
//!
//! `film.json` is written before any picture, and pictures that contradict it are removed before
//! that. So every picture in the folder agrees with `film.json`, whenever a run ends.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::{fs, io};

use anyhow::{Context, bail, ensure};
use app_core::preset::Preset;
use app_core::session::Files;
use app_core::shadow_style::ShadowStyle;
use desk::files::{SESSION_FILE, index_of};
use desk::output::{make_folder, remove_file, write_whole};
use desk::stored::Stored;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::timeline::{FramePose, Timing};

/// File with the description of the film.
pub const FILM_FILE: &str = "film.json";
/// The copy of the session that its frames are made from, in the film's folder.
pub const SESSION_FOLDER: &str = "session";
const LOCK_FILE: &str = ".film.lock";
const TURN_FILE: &str = ".begin.lock";
const MAX_SESSION_FILE_BYTES: u64 = 1 << 30;
/// The keys of the index that name files.
const FILE_KEYS: [&str; 4] = ["image", "depth", "people", "file"];

/// All that determines the pixels of a film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Film {
    /// Version of the program.
    pub version: String,
    /// Program and driver of its pictures.
    #[serde(default)]
    pub made_by: MadeBy,
    /// Name of the session.
    pub name: String,
    /// The session's files.
    pub sources: Vec<SourceFile>,
    /// Whether camera, pose and lights are the session's, without alignment by its pictures.
    pub is_as_given: bool,
    /// Whether each frame shows the session's photograph of its time, instead of the first one.
    #[serde(default)]
    pub is_moving: bool,
    /// How much work a frame may cost.
    pub preset: String,
    /// Style of the shadow.
    #[serde(default)]
    pub shadow: ShadowStyle,
    /// Bits of a picture's channels: 8 or 16.
    #[serde(default = "eight")]
    pub bits: u8,
    /// Whether each picture's layers are written beside it.
    #[serde(default)]
    pub has_layers: bool,
    /// The text of the clips.
    pub clips: String,
    /// Conversion of clips to frames.
    pub timing: Timing,
    /// All frames, in order.
    pub frames: Vec<FilmFrame>,
}

/// The program and the driver that make pictures: those of others may differ slightly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MadeBy {
    /// Checksum of the program.
    pub build: String,
    /// Name of the graphics adapter with its driver.
    pub driver: String,
}

/// A file that a film is made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SourceFile {
    /// Its path in the session.
    pub path: String,
    /// Its size.
    pub n_bytes: u64,
    /// Its checksum.
    pub crc32: u32,
}

/// One frame of a film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FilmFrame {
    /// Its number, which its file's name has.
    pub number: u32,
    /// Its picture.
    pub file: String,
    /// Index of the session's frame that provides the photograph.
    #[serde(default)]
    pub photograph: usize,
    /// The pose that it shows.
    pub pose: FramePose,
}

/// Bits of films whose file does not state them.
fn eight() -> u8 {
    8
}

impl FilmFrame {
    /// The file of its layers, if it has any.
    #[must_use]
    pub fn layers_file(&self) -> PathBuf {
        Path::new(&self.file).with_extension("exr")
    }
}

impl Film {
    /// Files of a frame: its picture, and its layers if there are any.
    #[must_use]
    pub fn files_of(&self, frame: &FilmFrame) -> Vec<PathBuf> {
        let layers = self.has_layers.then(|| frame.layers_file());
        [PathBuf::from(&frame.file)].into_iter().chain(layers).collect()
    }

    /// The photographs of the film, in the order of its time, each once.
    #[must_use]
    pub fn photographs(&self) -> Vec<usize> {
        let mut shown: Vec<usize> = self.frames.iter().map(|frame| frame.photograph).collect();
        shown.dedup();
        shown
    }

    /// The preset.
    ///
    /// # Errors
    /// When no preset has that name.
    pub fn preset(&self) -> anyhow::Result<Preset> {
        self.preset.parse().map_err(anyhow::Error::msg)
    }

    /// Whether both are made from the same session in the same way.
    fn has_session_of(&self, other: &Self) -> bool {
        let of = |film: &Self| {
            let how = (film.is_as_given, film.is_moving);
            (film.version.clone(), film.sources.clone(), how)
        };
        of(self) == of(other)
    }

    /// Whether two films with equal frames have equal pictures. All poses determine the processed
    /// part of the picture.
    fn has_pictures_of(&self, other: &Self) -> bool {
        let shown = |film: &Self| -> Vec<(usize, FramePose)> {
            let frames = film.frames.iter();
            frames.map(|frame| (frame.photograph, frame.pose)).collect()
        };
        let look = |film: &Self| (film.preset.clone(), film.shadow, film.bits, film.has_layers);
        self.has_session_of(other) && look(self) == look(other) && shown(self) == shown(other)
    }
}

/// Sizes and checksums of a session's files that a film uses: with the photographs of all frames
/// for a moving film, else with that of the first.
///
/// # Errors
/// When one cannot be read.
pub fn sources(session: &Stored, is_moving: bool) -> anyhow::Result<Vec<SourceFile>> {
    let mut index = index_of(session)?;
    if let Some(frames) = index["frames"].as_array_mut().filter(|_| !is_moving) {
        frames.truncate(1);
    }
    let mut paths = vec![SESSION_FILE.to_owned()];
    add_named(&index, &mut paths);
    let toy = index["toy"]["file"].as_str().unwrap_or_default();
    if !toy.to_ascii_lowercase().ends_with(".glb") {
        // Buffers and pictures may lie beside it.
        let folder = toy.rsplit_once('/').map_or("", |(folder, _)| folder);
        let all = session.paths()?.into_iter();
        paths.extend(all.filter(|path| path.starts_with(folder)));
    }
    paths.sort();
    paths.dedup();
    let source = |path: String| {
        let bytes = session
            .read(&path, MAX_SESSION_FILE_BYTES)
            .with_context(|| path.clone())?;
        Ok(SourceFile {
            n_bytes: bytes.len() as u64,
            crc32: crc32fast::hash(&bytes),
            path,
        })
    };
    paths.into_iter().map(source).collect()
}

/// Adds the files that a part of the index names, except truths: they are compared with pictures
/// and change none.
fn add_named(part: &Value, paths: &mut Vec<String>) {
    match part {
        Value::Array(parts) => parts.iter().for_each(|part| add_named(part, paths)),
        Value::Object(keys) => {
            for (key, value) in keys {
                match value.as_str() {
                    Some(path) if FILE_KEYS.contains(&key.as_str()) => paths.push(path.to_owned()),
                    _ => add_named(value, paths),
                }
            }
        }
        _ => {}
    }
}

/// The folder of a film in work.
pub struct FilmFolder {
    path: PathBuf,
    is_shared: bool,
    /// Held as long as this lives.
    _lock: File,
}

impl FilmFolder {
    /// Takes a new folder, an empty one, or that of a film. Several runs share one if each makes a
    /// part of its frames.
    ///
    /// # Errors
    /// When it has other files, or another run works in it.
    pub fn take(path: &Path, is_shared: bool) -> anyhow::Result<Self> {
        make_folder(path)?;
        // In this order, since another run that takes the same new folder in between makes the
        // lock's file first.
        let is_empty = fs::read_dir(path)?.next().is_none();
        let is_film = [FILM_FILE, LOCK_FILE].iter().any(|file| path.join(file).exists());
        ensure!(
            is_film || is_empty,
            "{}: has files of something else than a film; name another folder",
            path.display()
        );
        let lock_path = path.join(LOCK_FILE);
        let lock = File::create(&lock_path).with_context(|| lock_path.display().to_string())?;
        let locked = if is_shared {
            lock.try_lock_shared()
        } else {
            lock.try_lock()
        };
        match locked {
            Err(TryLockError::WouldBlock) => {
                bail!(
                    "{}: another run is making a film there; wait for its end, or name another folder",
                    path.display()
                )
            }
            // Some network drives have no locks.
            Err(TryLockError::Error(error)) if error.kind() != io::ErrorKind::Unsupported => {
                return Err(error).with_context(|| lock_path.display().to_string());
            }
            _ => {}
        }
        Ok(Self {
            path: path.to_owned(),
            is_shared,
            _lock: lock,
        })
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The film in a folder, if any.
    ///
    /// # Errors
    /// When its file cannot be read as one.
    pub fn film_in(path: &Path) -> anyhow::Result<Option<Film>> {
        let path = path.join(FILM_FILE);
        match fs::read(&path) {
            Ok(bytes) => {
                let named = || path.display().to_string();
                let film: Film = serde_json::from_slice(&bytes).with_context(named)?;
                for frame in &film.frames {
                    let is_name = Path::new(&frame.file).components().count() == 1
                        && Path::new(&frame.file).file_name().is_some();
                    ensure!(is_name, "{}: {:?} is no file of this folder", named(), frame.file);
                }
                Ok(Some(film))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error).with_context(|| path.display().to_string()),
        }
    }

    /// Makes `film` the folder's film: `write_session` makes its session if it is missing, and
    /// pictures that contradict the film are removed.
    ///
    /// # Errors
    /// When something cannot be read, written or removed.
    pub fn begin(
        &self,
        film: &Film,
        is_forced: bool,
        write_session: impl FnOnce(&Path) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let turn_path = self.path.join(TURN_FILE);
        let turn = File::create(&turn_path).with_context(|| turn_path.display().to_string())?;
        // One of several runs begins, and the others find the film begun. Without locks, start the
        // runs one by one.
        let _ = turn.lock();
        let before = Self::film_in(&self.path)?;
        // The film as it will be read back.
        let mut film = film.clone();
        let mut bytes = serde_json::to_vec_pretty(&film)?;
        let as_read: Film = serde_json::from_slice(&bytes)?;
        if let Some(before) = before
            .as_ref()
            .filter(|before| !is_forced && before.has_pictures_of(&as_read))
        {
            film.made_by.clone_from(&before.made_by);
            bytes = serde_json::to_vec_pretty(&film)?;
        }
        let film: Film = serde_json::from_slice(&bytes)?;
        ensure!(
            !self.is_shared || before.as_ref().is_none_or(|before| *before == film),
            "{}: a run for some frames of a film leaves another film as it is; name another --out, or run without --frames first",
            self.path.display()
        );
        if let Some(before) = before.as_ref().filter(|before| **before != film && !is_forced) {
            let n_lost = before
                .frames
                .iter()
                .filter(|frame| self.path.join(&frame.file).exists())
                .count();
            let is_kept = before.has_pictures_of(&film);
            ensure!(
                is_kept || n_lost == 0,
                "{}: has {n_lost} pictures of another film ({}); name another --out, or say --force to have them removed",
                self.path.display(),
                before.clips
            );
        }
        let has_session = before.as_ref().is_some_and(|before| before.has_session_of(&film));
        let session = self.path.join(SESSION_FOLDER);
        if is_forced || !has_session || !session.exists() {
            let partial = self.path.join(format!("{SESSION_FOLDER}.partial"));
            remove_folder(&partial)?;
            write_session(&partial)?;
            self.remove_pictures(before.as_ref(), |_| false)?;
            // It is unknown to which film these pictures belong.
            self.remove_pictures(Some(&film), |_| false)?;
            remove_file(&self.path.join(FILM_FILE))?;
            remove_folder(&session)?;
            fs::rename(&partial, &session)?;
        } else if let Some(before) = &before
            && *before != film
        {
            let is_kept = before.has_pictures_of(&film);
            self.remove_pictures(Some(before), |frame| is_kept && film.frames.contains(frame))?;
            self.remove_pictures(Some(&film), |frame| is_kept && before.frames.contains(frame))?;
        }
        let path = self.path.join(FILM_FILE);
        if before.as_ref() != Some(&film) || !path.exists() {
            write_whole(&path, &bytes)?;
        }
        Ok(())
    }

    fn remove_pictures(
        &self,
        film: Option<&Film>,
        is_kept: impl Fn(&FilmFrame) -> bool,
    ) -> anyhow::Result<()> {
        for frame in film.iter().flat_map(|film| &film.frames) {
            if !is_kept(frame) {
                let files = film.map(|film| film.files_of(frame)).unwrap_or_default();
                files
                    .iter()
                    .try_for_each(|file| remove_file(&self.path.join(file)))?;
            }
        }
        Ok(())
    }

    /// Removes partial files of killed runs.
    ///
    /// # Errors
    /// When a file cannot be removed.
    pub fn remove_partial(&self) -> anyhow::Result<()> {
        for entry in fs::read_dir(&self.path)? {
            let path = entry?.path();
            if path.is_file() && path.extension().is_some_and(|extension| extension == "partial") {
                remove_file(&path)?;
            }
        }
        Ok(())
    }
}

fn remove_folder(path: &Path) -> anyhow::Result<()> {
    match fs::remove_dir_all(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(error).with_context(|| path.display().to_string())
        }
        _ => Ok(()),
    }
}
