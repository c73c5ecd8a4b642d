//! A shell on a desktop: it does what the app asks for, with a session as its camera and a folder as its photo library.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};

use app_core::app::{Permission, Saved, ShellCommand, ShellEvent};
use app_core::core::CoreError;
use app_core::interface::Screen;
use app_core::live::Live;
use app_core::scene::Image;
use app_shell::video::{MOTION_JPEG, Video};

use super::feed::Feed;
use super::kept;
use super::moment::Moment;
use desk::output::{make_folder, write_png};

/// Where alignments run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jobs {
    /// On a thread, as on a phone.
    Thread,
    /// When [`Desk::work`] is called: a tour is the same each time.
    WhenAsked,
}

/// A shell on a desktop.
pub struct Desk {
    /// The app.
    pub live: Live,
    /// Its camera.
    pub feed: Feed,
    /// What a person answers when the camera is asked for.
    pub answer: Permission,
    out: PathBuf,
    jobs: Jobs,
    waiting: Vec<ShellCommand>,
    /// What threads tell.
    done: (Sender<ShellEvent>, Receiver<ShellEvent>),
    /// Quality of a recording's pictures; lossless without one.
    pub jpeg_quality: Option<u8>,
    /// The toy that a person chooses when asked, or a folder of toys to choose from.
    pub toy_to_pick: Option<PathBuf>,
    /// The thread that writes a recording.
    writer: Option<JoinHandle<()>>,
    /// The latest recording.
    recording: Option<PathBuf>,
    /// Time since free space was told, in seconds.
    unlooked_s: f64,
    is_tracking: bool,
    video: Option<Video>,
    n_saved: usize,
    /// Whether the device is to be opened anew.
    pub wants_device: bool,
}

impl Desk {
    /// A shell that has just been started.
    #[must_use]
    pub fn new(live: Live, feed: Feed, out: PathBuf, jobs: Jobs) -> Self {
        Self {
            live,
            feed,
            answer: Permission::Granted,
            out,
            jobs,
            waiting: Vec::new(),
            done: channel(),
            jpeg_quality: None,
            toy_to_pick: None,
            writer: None,
            recording: None,
            unlooked_s: f64::INFINITY,
            is_tracking: false,
            video: None,
            n_saved: 0,
            wants_device: false,
        }
    }

    /// Tells the app, and does what it asks for.
    pub fn tell(&mut self, event: ShellEvent) {
        let commands = self.live.event(event);
        self.obey(commands);
    }

    /// The camera goes on by `elapsed_s`, if it was asked to, and what threads have done is told.
    pub fn tick(&mut self, elapsed_s: f64) {
        while let Ok(event) = self.done.1.try_recv() {
            self.tell(event);
        }
        self.unlooked_s += elapsed_s;
        if self.unlooked_s >= 1.0 {
            self.unlooked_s = 0.0;
            let free_bytes = kept::free_bytes(&self.out);
            free_bytes
                .into_iter()
                .for_each(|free| self.tell(ShellEvent::FreeSpace(free)));
        }
        if self.is_tracking {
            let frame = self.feed.next(elapsed_s);
            self.tell(ShellEvent::Frame(Box::new(frame)));
        }
    }

    /// Runs the alignments that wait.
    pub fn work(&mut self) {
        for command in std::mem::take(&mut self.waiting) {
            if let ShellCommand::Align(job) = command {
                self.tell(ShellEvent::Aligned(Some(Box::new(job.run()))));
            }
        }
    }

    /// Draws on a screen that nobody sees, and returns what it shows.
    ///
    /// # Errors
    /// As [`Live::screenshot`].
    pub fn screenshot(&mut self, screen: &Screen, time_s: f64) -> Result<Image, CoreError> {
        let (image, commands) = self.live.screenshot(screen, time_s)?;
        self.drawn(commands, time_s);
        Ok(image)
    }

    /// Draws on the core's surface.
    ///
    /// # Errors
    /// As [`Live::present`].
    pub fn present(&mut self, screen: &Screen, time_s: f64) -> Result<(), CoreError> {
        let commands = self.live.present(screen, time_s)?;
        self.drawn(commands, time_s);
        Ok(())
    }

    fn drawn(&mut self, commands: Vec<ShellCommand>, time_s: f64) {
        if let Some(video) = self.video.as_mut().filter(|video| video.is_due(time_s))
            && let Ok(picture) = self.live.read_picture()
        {
            video.add(picture, time_s);
        }
        self.obey(commands);
    }

    fn begin_video(&mut self) {
        let done = self.done.0.clone();
        // The window may be closed by then.
        let tell = move |saved, _| drop(done.send(ShellEvent::Saved(saved)));
        match Video::begin(&self.out, &[MOTION_JPEG], tell) {
            Ok(video) => self.video = Some(video),
            Err(_) => self.tell(ShellEvent::Saved(Saved::Failed)),
        }
    }

    fn obey(&mut self, commands: Vec<ShellCommand>) {
        for command in commands {
            match command {
                ShellCommand::AskPermission => self.tell(ShellEvent::Permission(self.answer)),
                ShellCommand::RunTracking { is_new_world, .. } => {
                    self.is_tracking = true;
                    self.feed.world_epoch += u32::from(is_new_world);
                }
                ShellCommand::PauseTracking => self.is_tracking = false,
                ShellCommand::Align(job) => match self.jobs {
                    Jobs::WhenAsked => self.waiting.push(ShellCommand::Align(job)),
                    Jobs::Thread => {
                        let done = self.done.0.clone();
                        thread::spawn(move || {
                            let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| job.run()));
                            // The window may be closed by now.
                            let _ = done.send(ShellEvent::Aligned(result.ok().map(Box::new)));
                        });
                    }
                },
                ShellCommand::SavePhoto => {
                    let saved = self.save_picture("photo");
                    self.tell(ShellEvent::Saved(saved));
                }
                ShellCommand::Video(true) => self.begin_video(),
                ShellCommand::Video(false) => self.video = None,
                ShellCommand::PickToy => {
                    let asked = self.toy_to_pick.clone();
                    match asked {
                        Some(folder) if folder.is_dir() => {
                            let files = kept::toys_of(&folder);
                            self.tell(ShellEvent::ToyFiles(files));
                        }
                        Some(path) => self.pick(&path),
                        None => {
                            let reason = "drop one on the window, or name one with --toy".to_owned();
                            self.tell(ShellEvent::Toy(Err(reason)));
                        }
                    }
                }
                ShellCommand::ReadToy(name) => {
                    let folder = self.toy_to_pick.clone().unwrap_or_default();
                    self.pick(&folder.join(name));
                }
                ShellCommand::Underexpose(is_on) => self.feed.is_dark = is_on,
                ShellCommand::Remember(text) => kept::store_starts(&self.out, &text),
                ShellCommand::ReopenDevice => self.wants_device = true,
                ShellCommand::Record(Some(take)) => {
                    let kept = kept::Recording {
                        take,
                        toy: self.feed.toy_file(),
                        jpeg_quality: self.jpeg_quality,
                    };
                    let (writer, file) = kept.write(&self.out, self.done.0.clone());
                    (self.writer, self.recording) = (Some(writer), file);
                }
                ShellCommand::Share => {
                    let shared = kept::share(&self.out, &self.live, self.recording.as_deref());
                    self.tell(ShellEvent::Saved(match shared {
                        Ok(()) => Saved::Done,
                        Err(_) => Saved::Failed,
                    }));
                }
                // A desktop has no screen that goes off, no lens to hold and no settings of its own.
                _ => {}
            }
        }
    }

    /// Writes a page of the moment that is shown, with every preset, on a thread that tells where it is; none while the toy does not
    /// move.
    pub fn look_into(&mut self) -> Option<JoinHandle<()>> {
        let moment = Moment::of(self.live.app())?;
        let folder = self.out.join(format!("moment_{:04}", self.n_saved));
        self.n_saved += 1;
        Some(thread::spawn(move || match moment.write(&folder) {
            Ok(page) => println!(
                "all presets, maps, lights and times of this moment: {}",
                page.display()
            ),
            Err(error) => eprintln!("no page of this moment: {error:#}"),
        }))
    }

    /// A person chose a toy's file, which may be none.
    pub fn pick(&mut self, path: &Path) {
        let read = kept::read_toy(path).map(|(toy, file)| {
            self.feed.set_toy_file(file);
            toy
        });
        self.tell(ShellEvent::Toy(read));
    }

    /// The file of the latest recording.
    #[must_use]
    pub fn recording(&self) -> Option<&Path> {
        self.recording.as_deref()
    }

    /// Waits until a recording that was ended is written, and tells.
    pub fn wait_for_recording(&mut self) {
        if let Some(writer) = self.writer.take() {
            let _ = writer.join();
        }
        while let Ok(event) = self.done.1.try_recv() {
            self.tell(event);
        }
    }

    /// Leaves nothing unwritten behind.
    pub fn close(&mut self) {
        self.tell(ShellEvent::Foreground(false));
        self.wait_for_recording();
    }

    fn save_picture(&mut self, name: &str) -> Saved {
        let Ok(picture) = self.live.read_picture() else {
            return Saved::Failed;
        };
        let path = self.out.join(format!("{name}_{:04}.png", self.n_saved));
        self.n_saved += 1;
        match make_folder(&self.out).and_then(|()| write_png(&path, &picture)) {
            Ok(()) => Saved::Done,
            Err(_) => Saved::Failed,
        }
    }
}
