//! Recordings: a thread of a shell writes them into files for the person.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Instant;

use app_core::app::{Recorded, Saved};
use app_core::frame::Clock;
use app_core::live::Live;
use app_core::recording::{Limits, PictureCodec, RecordingJob, RecordingOptions};

use crate::{kept, save};

/// Name of the log that is written while the app runs.
const LOG: &str = "log.txt";

/// Writes a recording into the file at `path` until it ends; `app` is the app with its version, and
/// `toy` the file of its toy.
#[must_use]
pub fn write(job: RecordingJob, (app, toy): (&str, &[u8]), codec: PictureCodec, path: &Path) -> Recorded {
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = fs::create_dir_all(folder).and_then(|()| File::create(path));
    let told = [
        ("system", std::env::consts::OS),
        ("architecture", std::env::consts::ARCH),
        ("app", app),
    ];
    let device = told.map(|(key, value)| (key.to_owned(), value.to_owned()));
    let outcome = match file {
        Ok(file) => job.run(
            file,
            RecordingOptions {
                toy,
                codec,
                device: device.into(),
                limits: Limits::APP,
            },
        ),
        Err(error) => job.without_file(&error),
    };
    Recorded {
        file: shown_name(path),
        outcome,
    }
}

/// A file's name as shown to the person.
pub(crate) fn shown_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// Writes the log into the folder.
pub(crate) fn write_log(live: &Live, folder: &Path) {
    kept::store_or_say(folder, LOG, live.app().log().text().as_bytes());
}

/// Renames the log of an earlier start.
pub(crate) fn put_log_aside(folder: &Path) {
    let (log, aside) = (folder.join(LOG), folder.join("log_before.txt"));
    if log.is_file()
        && let Err(error) = fs::rename(&log, aside).or_else(|_| fs::remove_file(&log))
    {
        eprintln!("{LOG} is still that of an earlier start: {error}");
    }
}

/// The files of the folder that a person shares: the log, the times, and `recording` or else the
/// latest of earlier starts, as far as they exist.
#[must_use]
pub fn share(live: &Live, folder: &Path, recording: Option<&Path>) -> (Saved, Vec<PathBuf>) {
    let mut files = vec![folder.join(LOG)];
    let mut saved = save::bytes(&files[0], live.app().log().text().as_bytes());
    if let (Saved::Done, Some(times)) = (saved, live.times()) {
        let path = folder.join("profile.json");
        let written = serde_json::to_vec(&times).map(|times| save::bytes(&path, &times));
        files.push(path);
        saved = written.unwrap_or(Saved::Failed);
    }
    files.extend(recording.map(Path::to_owned).or_else(|| latest(folder)));
    files.retain(|file| file.is_file());
    (saved, files)
}

/// The latest recording of a folder: their names increase with time.
fn latest(folder: &Path) -> Option<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_recording = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "mcap");
    entries.map(|entry| entry.path()).filter(is_recording).max()
}

/// Free space of a folder's device, in bytes.
#[must_use]
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let there = folder.ancestors().find(|folder| folder.exists())?;
    let told = rustix::fs::statvfs(there).ok()?;
    told.f_bavail.checked_mul(told.f_frsize)
}

/// A clock for times of frames.
#[must_use]
pub fn clock() -> Clock {
    let start = Instant::now();
    Clock::new(move || 1e3 * start.elapsed().as_secs_f64())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use app_core::camera_frame::CameraImage;
    use app_core::recording::{Ending, Item, LiveFrame, Recording};
    use app_core::scene::{Camera, Image, Intrinsics, Pose, Receiver, Scene, Surface};
    use app_core::session::{Capture, Session};
    use app_core::toy::Toy;
    use glam::{DMat4, DVec2, DVec3};

    use super::*;
    use crate::toys::BUNDLED as TOY;

    fn live(world_from_object: DMat4) -> (Scene, LiveFrame) {
        let intrinsics = Intrinsics {
            fx_px: 20.0,
            fy_px: 20.0,
            cx_px: 8.0,
            cy_px: 8.0,
        };
        let image = Image {
            width_px: 16,
            height_px: 16,
            rgba8: [90, 120, 60, 255].repeat(256),
        };
        let scene = Scene::new(
            [16, 16],
            Arc::new(Toy::from_glb("toy.glb", TOY).expect("the bundled toy")),
            world_from_object,
            vec![Receiver {
                name: "table".to_owned(),
                world_from_plane: DMat4::IDENTITY,
                half_extent_m: DVec2::ONE,
                surface: Surface::Textured,
            }],
        );
        let live = LiveFrame {
            image: CameraImage::from(image),
            camera: Camera {
                intrinsics,
                world_from_camera: DMat4::from_translation(DVec3::Y),
            },
            world_from_object,
            exposure: 1.0,
            light_estimate: None,
            depth: None,
            people: None,
            shown_pose: Pose::Authored,
            world_from_shown: None,
        };
        (scene, live)
    }

    #[test]
    fn a_recording_is_a_file_that_is_read_as_a_session_or_is_told_as_missing() {
        let folder = std::env::temp_dir().join(format!("app-shell-recording-{}", std::process::id()));
        let (scene, live) = live(DMat4::from_scale(DVec3::splat(0.1)));
        let (sender, job) = RecordingJob::new(7, scene.clone(), live.camera.intrinsics);
        sender
            .offer(0, Item::Live(Box::new(live.clone())))
            .expect("room in the queue");
        drop(sender);
        let path = folder.join("recording_2.mcap");
        let Recorded { file, outcome } = write(job, ("app 1.0", TOY), PictureCodec::PHONE, &path);
        assert_eq!((outcome.n_frames, &outcome.ending), (1, &Ending::Asked));
        assert_eq!(file, "recording_2.mcap");
        let recording = Recording::open(fs::read(&path).expect("a file")).expect("a recording");
        assert!(recording.losses().is_empty());
        let read = Capture::open(recording)
            .expect("a session")
            .frame(0)
            .expect("a frame");
        let codes = read.image.rgba8.iter().zip(&live.image.rgba().rgba8);
        assert!(codes.fold(0, |most, (a, b)| most.max(a.abs_diff(*b))) <= 2);
        assert!(free_bytes(&folder).is_some_and(|free| free > 0));
        fs::write(folder.join("recording_1.mcap"), b"").expect("an older one");
        assert_eq!(latest(&folder), Some(path.clone()));
        let (_, job) = RecordingJob::new(8, scene, live.camera.intrinsics);
        let refused = write(job, ("app 1.0", TOY), PictureCodec::PHONE, &path.join("a.mcap"));
        assert!(matches!(refused.outcome.ending, Ending::Failed(_)), "{refused:?}");
        fs::remove_dir_all(&folder).expect("a folder");
    }
}
