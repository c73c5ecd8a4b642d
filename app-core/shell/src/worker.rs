//! Work of the app that needs only files and threads, the same on both phones and on a desktop.
//!
//! | command | work | result |
//! | --- | --- | --- |
//! | `Plate` | on a thread | `Plated` |
//! | `Search` | on a thread | `Searched` |
//! | `Align` | on a thread | `Aligned` |
//! | `Watch` | on a thread | `Watched` |
//! | `SavePhoto` | read the picture, and write it on a thread | `Saved`, and the file for the gallery |
//! | `Video` | pass each drawn picture to a thread, until the video ends | `Filmed`, and the file for the gallery |
//! | `Record` | on a thread, until the recording ends | `Recorded` |
//! | `Share` | write the log and the times | the files to share; `Saved` when they are, or if they cannot be written |
//! | `PickToy` | list the folder | `ToyFiles` |
//! | `ReadToy` | on a thread | `Toy` |
//! | `Remember` | write the text at once | none |
//!
//! A thread that panics, or that cannot be started, is reported as failed work.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use app_core::app::{AlignJob, Filmed, Recorded, Saved, ShellEvent, ToyRefusal, VideoEnding, WorkCommand};
use app_core::live::Live;
use app_core::recording::{PictureCodec, RecordingJob, RecordingOutcome};

use crate::folders::{self, Folders};
use crate::gallery::Gallery;
use crate::guard::guarded;
use crate::toys::{self, ToyFile};
use crate::video::{Video, VideoFormat};
use crate::{pipelines, record, save, starts};

/// Time between two checks of the free space.
const LOOK: Duration = Duration::from_secs(1);

/// Time between two writes of a log that has grown.
const WRITE_LOG: Duration = Duration::from_secs(2);

/// Differences between shells.
#[derive(Clone)]
pub struct Platform {
    /// The app with its version, for recordings.
    pub app: &'static str,
    /// Formats of videos, in order of preference.
    pub videos: &'static [VideoFormat],
    /// Encodes the pictures of recordings.
    pub codec: Arc<dyn Fn() -> PictureCodec + Send + Sync>,
    /// Keeps the app from being suspended until the returned value is dropped, so that a file is
    /// complete. Called on the worker's own thread.
    pub keep_running: fn() -> Box<dyn Send>,
}

/// Timing of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Work runs while the app goes on.
    Live,
    /// The same in each run: alignments wait for [`Worker::align_waiting`], the app waits for work
    /// that ends without a command, and files have numbers in place of dates.
    Repeatable,
}

/// A result of work.
#[derive(Debug)]
pub enum Outcome {
    /// An event for the app.
    Tell(ShellEvent),
    /// A photo or a video that can be copied to the phone's gallery.
    Written(PathBuf),
    /// Files that the person shares.
    Share(Vec<PathBuf>),
    /// Another toy is shown: the scan beside its file, by which a capable platform recognises it;
    /// `None` if there is none.
    Scan(Option<PathBuf>),
}

/// Executes the work.
pub struct Worker {
    platform: Platform,
    folders: Folders,
    pace: Pace,
    toy_file: ToyFile,
    /// Alignments that wait for their run.
    waiting: Vec<AlignJob>,
    video: Option<Video>,
    gallery: Gallery,
    /// The thread that writes the latest recording, and its file.
    recording: Option<JoinHandle<()>>,
    recorded: Option<PathBuf>,
    /// The outcome of writing the latest files to share.
    written: Saved,
    n_files: u128,
    outcomes: (Sender<Outcome>, Receiver<Outcome>),
    /// Time of the last check of the free space.
    looked: Option<Instant>,
    /// Number of complete compilations at the time when the driver's pipelines were last stored.
    n_warm_ups: u32,
    /// Time at which the log was written, and its number of lines.
    logged: Option<(Instant, u64)>,
}

impl Worker {
    /// A worker without any work, except that of an earlier start.
    #[must_use]
    pub fn new(platform: Platform, folders: Folders) -> Self {
        let gallery = Gallery::kept_in(&folders);
        let outcomes = channel();
        for file in gallery.waiting() {
            send(&outcomes.0, Outcome::Written(file));
        }
        Self {
            platform,
            folders,
            gallery,
            outcomes,
            pace: Pace::Live,
            toy_file: ToyFile::default(),
            waiting: Vec::new(),
            video: None,
            recording: None,
            recorded: None,
            written: Saved::Done,
            n_files: 0,
            looked: None,
            n_warm_ups: 0,
            logged: None,
        }
    }

    /// Sets the timing and the toy's file.
    #[must_use]
    pub fn with(self, pace: Pace, toy_file: Arc<[u8]>) -> Self {
        let toy_file = ToyFile::of(toy_file);
        Self {
            pace,
            toy_file,
            ..self
        }
    }

    /// Executes a command.
    pub fn obey(&mut self, live: &Live, command: WorkCommand) {
        match command {
            WorkCommand::Plate(job) => self.run("plate", ShellEvent::Plated(None), move |_| {
                ShellEvent::Plated(Some(Box::new(job.run())))
            }),
            WorkCommand::Search(job) => self.run("search", ShellEvent::Searched(None), move |_| {
                ShellEvent::Searched(Some(Box::new(job.run())))
            }),
            WorkCommand::Align(job) => match self.pace {
                Pace::Live => self.align(*job),
                Pace::Repeatable => self.waiting.push(*job),
            },
            WorkCommand::Watch(job) => {
                let died = ShellEvent::Watched(Box::new(job.without_result()));
                self.run("watch", died, move |_| ShellEvent::Watched(Box::new(job.run())));
            }
            WorkCommand::SavePhoto => self.save_photo(live),
            WorkCommand::Video(true) => self.begin_video(),
            WorkCommand::Video(false) => self.video = None,
            WorkCommand::Record(job) => job.into_iter().for_each(|job| self.record(*job)),
            WorkCommand::Share => self.share(live),
            WorkCommand::PickToy => {
                let folder = self.folders.toys.as_deref().unwrap_or(Path::new(""));
                self.tell(ShellEvent::ToyFiles(toys::list(folder)));
            }
            WorkCommand::ReadToy(name) => {
                self.read_toy(self.folders.toys.clone().unwrap_or_default(), name);
            }
            WorkCommand::Remember(text) => self.remember(&text),
        }
    }

    /// Renames the log of an earlier launch.
    pub fn begin_log(&self) {
        if let Some(folder) = &self.folders.shared {
            record::put_log_aside(folder);
        }
    }

    /// Runs the waiting alignments.
    pub fn align_waiting(&mut self) {
        let waiting = std::mem::take(&mut self.waiting);
        waiting.into_iter().for_each(|job| self.align(job));
    }

    /// Reads the file of a toy that a person has chosen.
    pub fn read_toy(&self, folder: PathBuf, name: String) {
        let died = ToyRefusal::unreadable(&name, "its thread ended");
        let file = self.toy_file.clone();
        let read = move |outcomes: &Sender<Outcome>| {
            let read = file.read(&folder, &name);
            if let ShellEvent::Toy(Ok(_)) = &read {
                send(outcomes, Outcome::Scan(toys::scan_beside(&folder, &name)));
            }
            read
        };
        self.run("toy", ShellEvent::Toy(Err(died)), read);
    }

    /// Waits until an ended recording is written.
    pub fn wait_for_recording(&mut self) {
        // A thread that panicked has reported that.
        let _ = self.recording.take().map(JoinHandle::join);
    }

    /// Adds the picture that was just drawn to a video.
    pub fn drawn(&mut self, live: &Live, time_s: f64) {
        self.keep_pipelines(live);
        self.keep_log(live);
        let video = self.video.as_mut().filter(|video| video.is_due(time_s));
        if let Some(video) = video
            && let Ok(picture) = live.read_picture()
        {
            video.add(picture, time_s);
        }
    }

    /// The next result of work, or the free space.
    #[must_use]
    pub fn outcome(&mut self) -> Option<Outcome> {
        if self.looked.is_none_or(|looked| looked.elapsed() >= LOOK) {
            self.looked = Some(Instant::now());
            let folder = self.folders.shared.as_deref();
            let free_bytes = folder.and_then(record::free_bytes);
            free_bytes
                .into_iter()
                .for_each(|free| self.tell(ShellEvent::FreeSpace(free)));
        }
        let outcome = self.outcomes.1.try_recv().ok();
        if let Some(Outcome::Written(file)) = &outcome {
            self.gallery.remove(file);
        }
        outcome
    }

    /// Stores the driver's compiled pipelines once they are complete.
    fn keep_pipelines(&mut self, live: &Live) {
        let (Some(own), true) = (&self.folders.own, live.n_warm_ups() != self.n_warm_ups) else {
            return;
        };
        self.n_warm_ups = live.n_warm_ups();
        let (Some(key), Some(data)) = (live.core().pipelines_key(), live.core().pipeline_data()) else {
            return;
        };
        let own = own.clone();
        let kept = thread::Builder::new()
            .name("pipelines".to_owned())
            .spawn(move || {
                guarded("a thread", || {
                    if let Err(error) = pipelines::store(&own, &key, &data) {
                        eprintln!("compiled pipelines are not kept: {error}");
                    }
                })
            });
        if let Err(error) = kept {
            eprintln!("compiled pipelines are not kept: {error}");
        }
    }

    /// Writes the log to the accessible folder while the app runs, so that it is available without
    /// an export.
    fn keep_log(&mut self, live: &Live) {
        let n_lines = live.app().log().n_lines();
        let is_due = self
            .logged
            .is_none_or(|(written, n_written)| written.elapsed() >= WRITE_LOG && n_written != n_lines);
        let (Some(folder), true, Pace::Live) = (&self.folders.shared, is_due, self.pace) else {
            return;
        };
        self.logged = Some((Instant::now(), n_lines));
        record::write_log(live, folder);
    }

    fn tell(&self, event: ShellEvent) {
        send(&self.outcomes.0, Outcome::Tell(event));
    }

    /// The path of a new file without its extension; `None` without a folder.
    fn stem(&mut self, what: &str) -> Option<PathBuf> {
        self.n_files += 1;
        let number = match self.pace {
            Pace::Live => folders::unix_ms(),
            Pace::Repeatable => self.n_files,
        };
        self.folders.stem(what, number)
    }

    fn align(&self, job: AlignJob) {
        let died = ShellEvent::Aligned(Box::new(job.without_result()));
        self.run("align", died, move |_| ShellEvent::Aligned(Box::new(job.run())));
    }

    fn save_photo(&mut self, live: &Live) {
        let Some(stem) = self.stem("photo") else {
            return self.tell(ShellEvent::Saved(Saved::NotAllowed));
        };
        let Ok(picture) = live.read_picture() else {
            return self.tell(ShellEvent::Saved(Saved::Failed));
        };
        let (gallery, kept_running) = (self.gallery.clone(), (self.platform.keep_running)());
        self.run("photo", ShellEvent::Saved(Saved::Failed), move |outcomes| {
            let path = stem.with_extension("png");
            let saved = save::picture(&path, &picture);
            if saved == Saved::Done {
                written(outcomes, &gallery, path);
            }
            drop(kept_running);
            ShellEvent::Saved(saved)
        });
    }

    fn begin_video(&mut self) {
        let refused = |saved| {
            let ending = VideoEnding::Broken;
            ShellEvent::Filmed(Filmed { saved, ending })
        };
        let Some(stem) = self.stem("video") else {
            return self.tell(refused(Saved::NotAllowed));
        };
        let (outcomes, gallery) = (self.outcomes.0.clone(), self.gallery.clone());
        let kept_running = (self.platform.keep_running)();
        let done = move |filmed, file: Option<PathBuf>| {
            if let Some(file) = file {
                written(&outcomes, &gallery, file);
            }
            send(&outcomes, Outcome::Tell(ShellEvent::Filmed(filmed)));
            drop(kept_running);
        };
        match Video::begin(stem, self.platform.videos, done) {
            Ok(video) => self.video = Some(video),
            Err(_) => self.tell(refused(Saved::Failed)),
        }
    }

    fn record(&mut self, job: RecordingJob) {
        let Some(stem) = self.stem("recording") else {
            let outcome = job.without_file(&io::ErrorKind::PermissionDenied.into());
            let file = String::new();
            return self.tell(ShellEvent::Recorded(Recorded { file, outcome }));
        };
        let path = stem.with_extension("mcap");
        let died = ShellEvent::Recorded(Recorded {
            file: record::shown_name(&path),
            outcome: RecordingOutcome::died(job.number()),
        });
        self.recorded = Some(path.clone());
        let (platform, toy) = (self.platform.clone(), self.toy_file.bytes());
        let kept_running = (self.platform.keep_running)();
        self.recording = self.spawn("record", died, move |_| {
            let codec = (platform.codec)();
            let recorded = record::write(job, (platform.app, &toy), codec, &path);
            drop(kept_running);
            ShellEvent::Recorded(recorded)
        });
    }

    fn share(&mut self, live: &Live) {
        let Some(folder) = &self.folders.shared else {
            return self.tell(ShellEvent::Saved(Saved::NotAllowed));
        };
        let (saved, files) = record::share(live, folder, self.recorded.as_deref());
        self.written = saved;
        if files.is_empty() {
            self.tell(ShellEvent::Saved(saved));
        } else {
            send(&self.outcomes.0, Outcome::Share(files));
        }
    }

    /// To be called, on any thread, with whether other apps get the files of an [`Outcome::Share`].
    pub fn shared(&self) -> impl FnOnce(bool) + Send + use<> {
        let (outcomes, written) = (self.outcomes.0.clone(), self.written);
        move |is_shared| {
            let saved = if is_shared { written } else { Saved::NotShared };
            send(&outcomes, Outcome::Tell(ShellEvent::Saved(saved)));
        }
    }

    fn remember(&self, text: &str) {
        let stored = self
            .folders
            .own
            .as_deref()
            .map(|folder| starts::store(folder, text));
        if let Some(Err(error)) = stored {
            eprintln!("{}: the start is not kept: {error}", self.platform.app);
        }
    }

    /// Runs `work`, which ends without a command, on a thread, and reports its result, or
    /// `otherwise` if there is none.
    fn run(
        &self,
        name: &str,
        otherwise: ShellEvent,
        work: impl FnOnce(&Sender<Outcome>) -> ShellEvent + Send + 'static,
    ) {
        let thread = self.spawn(name, otherwise, work);
        if self.pace == Pace::Repeatable {
            // A thread that panicked has reported that.
            let _ = thread.map(JoinHandle::join);
        }
    }

    /// The same for work that ends on command.
    fn spawn(
        &self,
        name: &str,
        otherwise: ShellEvent,
        work: impl FnOnce(&Sender<Outcome>) -> ShellEvent + Send + 'static,
    ) -> Option<JoinHandle<()>> {
        let outcomes = self.outcomes.0.clone();
        let (hand_over, handed_over) = channel();
        let begun = thread::Builder::new().name(name.to_owned()).spawn(move || {
            // `otherwise` is reported by the thread, or by its creator if there is no thread.
            let Ok(otherwise) = handed_over.recv() else {
                return;
            };
            let event = guarded("a thread", || work(&outcomes));
            send(&outcomes, Outcome::Tell(event.unwrap_or(otherwise)));
        });
        if begun.is_ok() {
            // The thread waits for this value.
            drop(hand_over.send(otherwise));
        } else {
            self.tell(otherwise);
        }
        begun.ok()
    }
}

/// Sends an outcome; the receiver may no longer exist.
fn send(outcomes: &Sender<Outcome>, outcome: Outcome) {
    let _ = outcomes.send(outcome);
}

/// Hands a whole file to the gallery: by the platform, or else at the next start.
fn written(outcomes: &Sender<Outcome>, gallery: &Gallery, file: PathBuf) {
    gallery.add(&file);
    send(outcomes, Outcome::Written(file));
}

#[cfg(test)]
mod tests;
