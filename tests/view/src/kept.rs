//! What a person keeps of a session on a desktop: recordings, and what is to be shared.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread::{self, JoinHandle};

use anyhow::Context;
use app_core::app::{Recorded, ShellEvent, Starts};
use app_core::live::Live;
use app_core::recording::{Limits, PictureCodec, Take, TakeOptions};
use app_core::toy::Toy;

use super::feed::MAX_TOY_BYTES;
use desk::convert::EXTENSION;
use desk::output::{make_folder, write_whole};

/// Where what is shared goes, in the folder of photos.
pub const SHARED: &str = "shared";

/// What is kept from start to start, in the folder of photos.
pub const STARTS: &str = "starts.txt";

/// Reads what was kept, and stores that another start begins.
#[must_use]
pub fn begin_start(folder: &Path) -> Starts {
    let mut starts = Starts::read(&fs::read_to_string(folder.join(STARTS)).unwrap_or_default());
    starts.begin();
    store_starts(folder, &starts.text());
    starts
}

/// Keeps it; where that fails the next start knows of nothing.
pub(super) fn store_starts(folder: &Path, text: &str) {
    let stored = make_folder(folder).and_then(|()| write_whole(&folder.join(STARTS), text.as_bytes()));
    if let Err(error) = stored {
        eprintln!("the start is not kept: {error}");
    }
}

/// A recording that is about to be written.
pub(super) struct Recording {
    pub(super) take: Box<Take>,
    /// The toy's file.
    pub(super) toy: Arc<[u8]>,
    /// Lossless without one.
    pub(super) jpeg_quality: Option<u8>,
}

impl Recording {
    /// Writes it into a new file of `folder` by a thread of its own, which tells what became of it. The file, where there is one.
    pub(super) fn write(self, folder: &Path, done: Sender<ShellEvent>) -> (JoinHandle<()>, Option<PathBuf>) {
        let (file, path) = match new_file(folder) {
            Ok((file, path)) => (Ok(file), Some(path)),
            Err(error) => (Err(error), None),
        };
        let named = path.as_deref().unwrap_or(folder).display().to_string();
        let writer = thread::spawn(move || {
            let codec = self
                .jpeg_quality
                .map_or(PictureCodec::Lossless, |quality| PictureCodec::Jpeg { quality });
            let taken = match file {
                Ok(file) => self.take.run(
                    file,
                    TakeOptions {
                        toy: &self.toy,
                        codec,
                        device: device(),
                        limits: Limits::APP,
                    },
                ),
                Err(error) => self.take.without_file(&error),
            };
            // The window may be closed by now.
            let _ = done.send(ShellEvent::Recorded(Recorded { file: named, taken }));
        });
        (writer, path)
    }
}

/// A file that was not there.
fn new_file(folder: &Path) -> io::Result<(File, PathBuf)> {
    fs::create_dir_all(folder)?;
    for number in 0_u32.. {
        let path = folder.join(format!("recording_{number:04}.{EXTENSION}"));
        match File::create_new(&path) {
            Ok(file) => return Ok((file, path)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

fn device() -> BTreeMap<String, String> {
    let told = [
        ("system", std::env::consts::OS),
        ("architecture", std::env::consts::ARCH),
        ("app", concat!("view ", env!("CARGO_PKG_VERSION"))),
    ];
    told.map(|(key, value)| (key.to_owned(), value.to_owned())).into()
}

/// Log, times and the latest recording, in a folder of their own.
pub(super) fn share(folder: &Path, live: &Live, recording: Option<&Path>) -> anyhow::Result<()> {
    let folder = folder.join(SHARED);
    make_folder(&folder)?;
    write_whole(&folder.join("log.txt"), live.app().log().text().as_bytes())?;
    if let Some(times) = live.times() {
        write_whole(&folder.join("profile.json"), &serde_json::to_vec(times)?)?;
    }
    if let Some(recording) = recording {
        let copy = folder.join("recording").with_extension(EXTENSION);
        fs::copy(recording, &copy).with_context(|| copy.display().to_string())?;
    }
    Ok(())
}

/// A toy and its file, or why it is none: the limit that it breaks, too.
pub(super) fn read_toy(path: &Path) -> Result<(Arc<Toy>, Vec<u8>), String> {
    let told = |reason: &dyn std::fmt::Display| format!("{}: {reason}", path.display());
    let mut file = Vec::new();
    File::open(path)
        .and_then(|opened| opened.take(MAX_TOY_BYTES + 1).read_to_end(&mut file))
        .map_err(|reason| told(&reason))?;
    if file.len() as u64 > MAX_TOY_BYTES {
        return Err(told(&format!("more than {} MiB", MAX_TOY_BYTES >> 20)));
    }
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let toy = Toy::from_glb(&name, &file).map_err(|reason| told(&reason))?;
    Ok((Arc::new(toy), file))
}

/// Names of the toys' files in a folder.
pub(super) fn toys_of(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let is_toy = |name: &String| {
        Path::new(name)
            .extension()
            .is_some_and(|extension| extension == "glb")
    };
    let mut toys: Vec<String> = names.filter(is_toy).collect();
    toys.sort();
    toys
}

/// What is free where a folder is, or is to be.
#[cfg(unix)]
pub(super) fn free_bytes(folder: &Path) -> Option<u64> {
    let there = folder.ancestors().find(|folder| folder.exists())?;
    let told = rustix::fs::statvfs(there).ok()?;
    told.f_bavail.checked_mul(told.f_frsize)
}

/// Not told there.
#[cfg(not(unix))]
pub(super) fn free_bytes(_: &Path) -> Option<u64> {
    None
}
