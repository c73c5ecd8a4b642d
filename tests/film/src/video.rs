//! Extracts pictures from a video by ffmpeg, if it is installed.

use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, bail, ensure};

/// File name extensions of videos.
const ENDINGS: [&str; 6] = ["mp4", "mov", "m4v", "mkv", "webm", "avi"];
/// Pictures per second: those of a film.
pub const PICTURES_PER_SEC: u32 = 24;
/// Largest number of pictures: a minute.
pub const MAX_PICTURES: u32 = 60 * PICTURES_PER_SEC;

/// Whether a file is a video, by its extension.
#[must_use]
pub fn is_video(path: &Path) -> bool {
    let ending = path.extension().map(OsStr::to_ascii_lowercase);
    ending.is_some_and(|ending| ENDINGS.iter().any(|of_video| ending == *of_video))
}

/// Pictures of a video, in a folder that is removed with this.
#[derive(Debug)]
pub struct Video {
    folder: PathBuf,
    pictures: Vec<PathBuf>,
}

impl Video {
    /// Extracts the first pictures of a video, [`PICTURES_PER_SEC`] of each second and at most
    /// `n_most`, into a folder that is made for them.
    ///
    /// # Errors
    /// When ffmpeg is not installed, it finds no picture in the file, or the folder exists already.
    pub fn open(path: &Path, folder: &Path, n_most: u32) -> anyhow::Result<Self> {
        let named = || path.display().to_string();
        ensure!(path.is_file(), "{}: is no file", named());
        match fs::create_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => bail!(
                "{}: another run works there, or was interrupted: remove it in that case",
                folder.display()
            ),
            made => made.with_context(|| folder.display().to_string())?,
        }
        let mut video = Self {
            folder: folder.to_owned(),
            pictures: Vec::new(),
        };
        extract(path, folder, n_most).with_context(named)?;
        let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
        video.pictures = entries.into_iter().map(|entry| entry.path()).collect();
        video.pictures.sort();
        ensure!(!video.pictures.is_empty(), "{}: has no picture", named());
        Ok(video)
    }

    /// Files of the pictures, in the order of time; one at least.
    #[must_use]
    pub fn pictures(&self) -> &[PathBuf] {
        &self.pictures
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        // Nobody is left to receive an error.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

fn extract(video: &Path, folder: &Path, n_most: u32) -> anyhow::Result<()> {
    let output = Command::new("ffmpeg")
        .args(["-nostdin", "-loglevel", "error", "-i"])
        .arg(video)
        .args(["-vf", &format!("fps={PICTURES_PER_SEC}")])
        .args(["-frames:v", &n_most.to_string(), "-start_number", "0"])
        .arg(folder.join("picture_%05d.png"))
        .output();
    let output = match output {
        Err(error) if error.kind() == io::ErrorKind::NotFound => bail!(
            "is a video, which needs ffmpeg, and ffmpeg is not installed; give a photograph, or a picture of the video as PNG"
        ),
        output => output.context("ffmpeg")?,
    };
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "ffmpeg cannot read it: {}", said.trim());
    Ok(())
}
