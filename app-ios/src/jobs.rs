//! Work on threads of its own, whose results are fetched with the next picture.

use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::{fs, io, thread};

use app_core::app::{Saved, ShellEvent};
use app_core::scene::Image;

use crate::guard::{Callback, guarded};

/// Threads at work, and what they have to tell.
#[derive(Debug)]
pub struct Jobs {
    done: Sender<ShellEvent>,
    results: Receiver<ShellEvent>,
}

impl Default for Jobs {
    fn default() -> Self {
        let (done, results) = channel();
        Self { done, results }
    }
}

impl Jobs {
    /// Runs `job` on a thread; what it comes to, or `failed` where it panics or has no thread, is a result.
    pub fn start(
        &self,
        job: impl FnOnce() -> ShellEvent + Send + 'static,
        failed: impl Fn() -> ShellEvent + Clone + Send + 'static,
    ) {
        let (done, otherwise) = (self.done.clone(), failed.clone());
        let run = move || {
            // Whoever waited may be gone.
            let _ = done.send(guarded(Callback::Thread, job).unwrap_or_else(otherwise));
        };
        if thread::Builder::new().spawn(run).is_err() {
            let _ = self.done.send(failed());
        }
    }

    /// A result that has come.
    #[must_use]
    pub fn result(&self) -> Option<ShellEvent> {
        self.results.try_recv().ok()
    }
}

/// Writes `picture` into `folder` as a PNG file of that name, and tells what became of it.
#[must_use]
pub fn save_picture(folder: &Path, name: &str, picture: &Image) -> Saved {
    let (size, rgba8) = ([picture.width_px, picture.height_px], &picture.rgba8);
    let path = folder.join(name).with_extension("png");
    let colors = image::ExtendedColorType::Rgba8;
    match image::save_buffer(&path, rgba8, size[0], size[1], colors) {
        Ok(()) => Saved::Done,
        Err(image::ImageError::IoError(error)) => failed(&path, &error),
        Err(error) => failed(&path, &io::Error::other(error)),
    }
}

/// Writes a file.
#[must_use]
pub fn save_bytes(path: &Path, bytes: &[u8]) -> Saved {
    match fs::write(path, bytes) {
        Ok(()) => Saved::Done,
        Err(error) => failed(path, &error),
    }
}

fn failed(path: &Path, error: &io::Error) -> Saved {
    eprintln!("app-ios: {}: {error}", path.display());
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Saved::NoRoom,
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => Saved::NotAllowed,
        _ => Saved::Failed,
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn wait_for(jobs: &Jobs) -> ShellEvent {
        let start = Instant::now();
        loop {
            if let Some(event) = jobs.result() {
                return event;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "no result");
            thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_job_that_panics_is_told_as_one_that_failed() {
        let jobs = Jobs::default();
        jobs.start(|| panic!("as planned"), || ShellEvent::Aligned(None));
        assert!(matches!(wait_for(&jobs), ShellEvent::Aligned(None)));
        jobs.start(|| ShellEvent::MemoryLow, || ShellEvent::Aligned(None));
        assert!(matches!(wait_for(&jobs), ShellEvent::MemoryLow));
    }

    #[test]
    fn a_photo_is_a_file_of_the_same_codes_or_is_told_as_missing() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/tmp/photos");
        fs::create_dir_all(&folder).expect("a folder");
        let picture = Image {
            width_px: 2,
            height_px: 1,
            rgba8: vec![1, 2, 3, 255, 4, 5, 6, 255],
        };
        assert_eq!(save_picture(&folder, "photo", &picture), Saved::Done);
        let read = image::open(folder.join("photo.png"))
            .expect("a PNG file")
            .to_rgba8();
        assert_eq!(read.into_raw(), picture.rgba8);
        assert_eq!(
            save_picture(&folder.join("none"), "photo", &picture),
            Saved::Failed
        );
        assert_eq!(save_bytes(&folder.join("none/log.txt"), b""), Saved::Failed);
    }
}
