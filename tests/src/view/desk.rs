//! A shell on a desktop: it does what the app asks for, with a session as its camera and a folder as its photo library.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use app_core::app::{AlignedJob, Permission, Saved, ShellCommand, ShellEvent};
use app_core::core::CoreError;
use app_core::interface::Screen;
use app_core::live::Live;
use app_core::scene::Image;

use super::feed::Feed;
use crate::output::{make_folder, write_png, write_whole};

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
    done: (Sender<Option<AlignedJob>>, Receiver<Option<AlignedJob>>),
    is_tracking: bool,
    is_making_video: bool,
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
            is_tracking: false,
            is_making_video: false,
            n_saved: 0,
            wants_device: false,
        }
    }

    /// Tells the app, and does what it asks for.
    pub fn tell(&mut self, event: ShellEvent) {
        let commands = self.live.event(event);
        self.obey(commands);
    }

    /// The camera goes on by `elapsed_s`, if it was asked to, and alignments that ended are told.
    pub fn tick(&mut self, elapsed_s: f64) {
        while let Ok(done) = self.done.1.try_recv() {
            self.tell(ShellEvent::Aligned(done.map(Box::new)));
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
        self.drawn(commands);
        Ok(image)
    }

    /// Draws on the core's surface.
    ///
    /// # Errors
    /// As [`Live::present`].
    pub fn present(&mut self, screen: &Screen, time_s: f64) -> Result<(), CoreError> {
        let commands = self.live.present(screen, time_s)?;
        self.drawn(commands);
        Ok(())
    }

    fn drawn(&mut self, commands: Vec<ShellCommand>) {
        if self.is_making_video {
            let _ = self.save_picture("video");
        }
        self.obey(commands);
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
                            let _ = done.send(result.ok());
                        });
                    }
                },
                ShellCommand::SavePhoto => {
                    let saved = self.save_picture("photo");
                    self.tell(ShellEvent::Saved(saved));
                }
                ShellCommand::Video(is_on) => {
                    self.is_making_video = is_on;
                    if !is_on {
                        self.tell(ShellEvent::Saved(Saved::Done));
                    }
                }
                ShellCommand::ReopenDevice => self.wants_device = true,
                ShellCommand::Share => {
                    let log = self.live.app().log().text();
                    let shared = make_folder(&self.out)
                        .and_then(|()| write_whole(&self.out.join("log.txt"), log.as_bytes()));
                    let saved = if shared.is_ok() {
                        Saved::Done
                    } else {
                        Saved::Failed
                    };
                    self.tell(ShellEvent::Saved(saved));
                }
                // A desktop has no screen that goes off, no lens to hold, no settings of its own, and a session its own toy.
                _ => {}
            }
        }
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
