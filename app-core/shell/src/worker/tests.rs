//! The worker of a shell, on a desktop.

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use app_core::Core;
use app_core::preset::Preset;
use app_core::toy::Toy;

use super::*;
use crate::video::MOTION_JPEG;

/// Number of requests to the platform to keep the app running, and number of their ends.
static KEPT: AtomicUsize = AtomicUsize::new(0);
static LET_GO: AtomicUsize = AtomicUsize::new(0);

struct Kept;

impl Drop for Kept {
    fn drop(&mut self) {
        LET_GO.fetch_add(1, Ordering::SeqCst);
    }
}

fn platform() -> Platform {
    Platform {
        app: "app 1.0",
        videos: &[MOTION_JPEG],
        codec: Arc::new(|| PictureCodec::PHONE),
        keep_running: || {
            KEPT.fetch_add(1, Ordering::SeqCst);
            Box::new(Kept)
        },
    }
}

/// An app that draws nothing.
fn live() -> Live {
    let toy = Toy::from_glb("toy.glb", toys::BUNDLED).expect("the bundled toy");
    Live::new(Core::counting(), Arc::new(toy), Preset::Balanced)
}

fn worker_in(folder: Option<&Path>) -> Worker {
    let folder = folder.map(Path::to_owned);
    let folders = Folders {
        shared: folder.clone(),
        toys: folder.clone(),
        own: folder,
    };
    Worker::new(platform(), folders)
}

/// The next outcome other than free space.
fn wait_for(worker: &mut Worker) -> Outcome {
    let begun = Instant::now();
    loop {
        match worker.outcome() {
            None | Some(Outcome::Tell(ShellEvent::FreeSpace(_))) => thread::yield_now(),
            Some(outcome) => return outcome,
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing was told");
    }
}

fn told(worker: &mut Worker) -> ShellEvent {
    match wait_for(worker) {
        Outcome::Tell(event) => event,
        other => panic!("not told, but {other:?}"),
    }
}

#[test]
fn a_thread_that_panics_is_told_as_work_that_failed() {
    let mut worker = worker_in(None);
    worker.spawn("panics", ShellEvent::Plated(None), |_| panic!("planted"));
    let event = told(&mut worker);
    assert!(matches!(event, ShellEvent::Plated(None)), "{event:?}");
    worker.spawn("works", ShellEvent::Plated(None), |_| ShellEvent::MemoryLow);
    let event = told(&mut worker);
    assert!(matches!(event, ShellEvent::MemoryLow), "{event:?}");
}

#[test]
fn without_a_folder_nothing_may_be_kept() {
    let (mut worker, live) = (worker_in(None), live());
    let asked = [
        WorkCommand::SavePhoto,
        WorkCommand::Video(true),
        WorkCommand::Share,
    ];
    let not_allowed = Filmed {
        saved: Saved::NotAllowed,
        ending: VideoEnding::Broken,
    };
    for command in asked {
        let name = format!("{command:?}");
        worker.obey(&live, command);
        let event = told(&mut worker);
        let is_told = match event {
            ShellEvent::Saved(saved) => saved == Saved::NotAllowed,
            ShellEvent::Filmed(filmed) => filmed == not_allowed,
            _ => false,
        };
        assert!(is_told, "{name}: {event:?}");
    }
}

#[test]
fn log_and_latest_recording_are_handed_on() {
    let folder = std::env::temp_dir().join(format!("app-shell-worker-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    for file in ["recording_1.mcap", "recording_2.mcap"] {
        fs::write(folder.join(file), b"").expect("a file");
    }
    let mut worker = worker_in(Some(&folder));
    worker.obey(&live(), WorkCommand::Share);
    let Outcome::Share(files) = wait_for(&mut worker) else {
        panic!("no files to hand on");
    };
    assert_eq!(
        files,
        ["log.txt", "recording_2.mcap"].map(|name| folder.join(name))
    );
    // It is not saved for the person before the platform says so.
    for (is_shared, expected) in [(true, Saved::Done), (false, Saved::NotShared)] {
        worker.shared()(is_shared);
        let event = told(&mut worker);
        assert!(
            matches!(event, ShellEvent::Saved(saved) if saved == expected),
            "{event:?}"
        );
    }
    fs::remove_dir_all(&folder).expect("a folder");
}

#[test]
fn the_app_is_kept_running_until_a_video_is_whole() {
    let folder = std::env::temp_dir().join(format!("app-shell-kept-{}", std::process::id()));
    let (mut worker, live) = (worker_in(Some(&folder)), live());
    worker.obey(&live, WorkCommand::Video(true));
    assert_eq!(
        (KEPT.load(Ordering::SeqCst), LET_GO.load(Ordering::SeqCst)),
        (1, 0)
    );
    worker.obey(&live, WorkCommand::Video(false));
    // It has no picture.
    let event = told(&mut worker);
    let no_picture = Filmed {
        saved: Saved::Failed,
        ending: VideoEnding::Asked,
    };
    assert!(
        matches!(event, ShellEvent::Filmed(filmed) if filmed == no_picture),
        "{event:?}"
    );
    let begun = Instant::now();
    while LET_GO.load(Ordering::SeqCst) == 0 {
        assert!(begun.elapsed() < Duration::from_secs(60), "it is kept for good");
        thread::yield_now();
    }
}

#[test]
fn a_video_that_ends_after_the_app_reaches_the_gallery_at_the_next_start() {
    let folder = std::env::temp_dir().join(format!("app-shell-gallery-{}", std::process::id()));
    let mut worker = worker_in(Some(&folder));
    // Another test counts.
    worker.platform.keep_running = || Box::new(());
    worker.begin_video();
    let picture = app_core::scene::Image {
        width_px: 16,
        height_px: 8,
        rgba8: vec![255; 4 * 16 * 8],
    };
    let video = worker.video.as_mut().expect("a video");
    assert!(video.add(picture, 0.0));
    worker.video = None;
    // Nobody asks for its outcome.
    let begun = Instant::now();
    while worker.gallery.waiting().is_empty() {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing waits");
        thread::yield_now();
    }
    drop(worker);
    let mut worker = worker_in(Some(&folder));
    let Outcome::Written(file) = wait_for(&mut worker) else {
        panic!("no file for the gallery");
    };
    assert!(file.is_file() && file.starts_with(&folder));
    assert!(Gallery::kept_in(&worker.folders).waiting().is_empty(), "once");
    fs::remove_dir_all(&folder).expect("a folder");
}

#[test]
fn toys_are_listed_and_read() {
    let (mut worker, live) = (worker_in(None), live());
    worker.obey(&live, WorkCommand::PickToy);
    let event = told(&mut worker);
    assert!(
        matches!(&event, ShellEvent::ToyFiles(names) if names == &["Llama"]),
        "{event:?}"
    );
    let none = WorkCommand::ReadToy("none.glb".to_owned());
    worker.obey(&live, none);
    let event = told(&mut worker);
    assert!(
        matches!(&event, ShellEvent::Toy(Err(refusal)) if refusal.reason.contains("none.glb")),
        "{event:?}"
    );
}

#[test]
fn at_a_repeatable_pace_work_is_done_when_a_command_returns() {
    let mut worker = worker_in(None).with(Pace::Repeatable, Arc::from(toys::BUNDLED));
    worker.obey(&live(), WorkCommand::ReadToy("none.glb".to_owned()));
    let outcome = worker.outcome();
    assert!(
        matches!(outcome, Some(Outcome::Tell(ShellEvent::Toy(Err(_))))),
        "{outcome:?}"
    );
}

#[test]
fn free_space_is_told_where_there_is_a_folder() {
    let mut worker = worker_in(Some(&std::env::temp_dir()));
    let outcome = worker.outcome();
    assert!(
        matches!(outcome, Some(Outcome::Tell(ShellEvent::FreeSpace(_)))),
        "{outcome:?}"
    );
    assert!(worker_in(None).outcome().is_none());
}

#[test]
fn the_log_of_an_earlier_start_does_not_pass_for_that_of_this_one() {
    let folder = std::env::temp_dir().join(format!("app-shell-logs-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    let worker = worker_in(Some(&folder));
    worker.begin_log();
    fs::write(folder.join("log.txt"), "old").expect("a file");
    worker.begin_log();
    assert!(!folder.join("log.txt").exists());
    let aside = fs::read_to_string(folder.join("log_before.txt"));
    assert_eq!(aside.expect("the old log"), "old");
    fs::remove_dir_all(&folder).expect("a folder");
}
