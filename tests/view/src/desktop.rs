//! A desktop shell: it executes the app's commands, with a session as its camera and a folder for
//! the user's files.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use app_core::app::{Permission, PlatformCommand, ShellCommand, ShellEvent, WorkCommand};
use app_core::core::CoreError;
use app_core::interface::Screen;
use app_core::live::Live;
use app_core::recording::PictureCodec;
use app_core::scene::Image;
use app_shell::folders::Folders;
use app_shell::video::MOTION_JPEG;
use app_shell::worker::{Outcome, Pace, Platform, Worker};

use super::feed::Feed;
use super::moment::Moment;

/// The user's files, and their options.
#[derive(Clone, Debug)]
pub struct Keeping {
    /// Folder of photos, videos and recordings.
    pub out: PathBuf,
    /// Quality of a recording's pictures; `None` for lossless.
    pub jpeg_quality: Option<u8>,
    /// The user's choice of a toy, or a folder of toys to choose from in place of `out`.
    pub toy_to_pick: Option<PathBuf>,
}

impl Keeping {
    fn worker(&self) -> Worker {
        let quality = self.jpeg_quality;
        let platform = Platform {
            app: concat!("view ", env!("CARGO_PKG_VERSION")),
            videos: &[MOTION_JPEG],
            codec: Arc::new(move || {
                quality.map_or(PictureCodec::Lossless, |quality| PictureCodec::Jpeg { quality })
            }),
            // A desktop suspends nothing.
            keep_running: || Box::new(()),
        };
        let toys = self.toy_to_pick.clone().filter(|path| path.is_dir());
        let folders = Folders {
            shared: Some(self.out.clone()),
            toys: toys.or_else(|| Some(self.out.clone())),
            own: Some(self.out.clone()),
        };
        Worker::new(platform, folders)
    }
}

/// A shell on a desktop.
pub struct Desk {
    /// The app.
    pub live: Live,
    /// Its camera feed.
    pub feed: Feed,
    /// The user's answer to the request for the camera.
    pub answer: Permission,
    /// The user's files.
    pub keeping: Keeping,
    worker: Worker,
    is_tracking: bool,
    /// The thread that writes a page.
    looking: Option<JoinHandle<()>>,
    /// Whether the device must be reopened.
    pub wants_device: bool,
}

impl Desk {
    /// A shell that has just been started.
    #[must_use]
    pub fn new(live: Live, feed: Feed, keeping: Keeping, pace: Pace) -> Self {
        Self {
            live,
            worker: keeping.worker().with(pace, feed.toy_file()),
            feed,
            answer: Permission::Granted,
            keeping,
            is_tracking: false,
            looking: None,
            wants_device: false,
        }
    }

    /// Passes an event to the app, and executes its commands.
    pub fn tell(&mut self, event: ShellEvent) {
        let commands = self.live.event(event);
        self.obey(commands);
    }

    /// Advances the camera by `elapsed_s`, if it is running, and passes on the results of threads.
    pub fn tick(&mut self, elapsed_s: f64) {
        self.settle();
        if self.is_tracking {
            let frame = self.feed.next(elapsed_s);
            self.tell(ShellEvent::Frame(Box::new(frame)));
        }
    }

    /// Runs the waiting alignments, at a pace at which they wait.
    pub fn align(&mut self) {
        self.worker.align_waiting();
        self.settle();
    }

    /// Passes on the results of work.
    fn settle(&mut self) {
        while let Some(outcome) = self.worker.outcome() {
            match outcome {
                Outcome::Tell(event) => self.tell(event),
                // No platform here recognises anything.
                Outcome::Scan(_) => {}
                Outcome::Written(file) => println!("{}", file.display()),
                Outcome::Share(files) => {
                    files.iter().for_each(|file| println!("{}", file.display()));
                    self.worker.shared()(true);
                }
            }
        }
    }

    /// Draws on an invisible screen, and returns its picture.
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
        self.worker.drawn(&self.live, time_s);
        self.obey(commands);
    }

    fn obey(&mut self, commands: Vec<ShellCommand>) {
        for command in commands {
            match command {
                ShellCommand::Platform(command) => self.call_platform(command),
                ShellCommand::Work(WorkCommand::PickToy) => self.pick_toy(),
                ShellCommand::Work(command) => self.worker.obey(&self.live, command),
            }
        }
    }

    /// Uses the named toy, unless it is a folder of several.
    fn pick_toy(&mut self) {
        match self.keeping.toy_to_pick.clone().filter(|path| !path.is_dir()) {
            Some(file) => self.pick(&file),
            None => self.worker.obey(&self.live, WorkCommand::PickToy),
        }
    }

    fn call_platform(&mut self, command: PlatformCommand) {
        match command {
            PlatformCommand::AskPermission => self.tell(ShellEvent::Permission(self.answer)),
            PlatformCommand::RunTracking { is_new_world, .. } => {
                self.is_tracking = true;
                self.feed.world_epoch += u32::from(is_new_world);
            }
            PlatformCommand::PauseTracking => self.is_tracking = false,
            PlatformCommand::Underexpose(is_on) => self.feed.is_dark = is_on,
            PlatformCommand::ReopenDevice => self.wants_device = true,
            // A desktop has no screen that turns off, no lens to fix and no settings of its own.
            _ => {}
        }
    }

    /// Writes a page of the present moment, with every preset, on a thread that reports its path.
    /// Does nothing while the toy does not move, or while another page is being written.
    pub fn look_into(&mut self) {
        if self.looking.as_ref().is_some_and(|page| !page.is_finished()) {
            return;
        }
        let Some(moment) = Moment::of(self.live.app()) else {
            return;
        };
        let folder = moment_folder(&self.keeping.out);
        self.looking = Some(thread::spawn(move || match moment.write(&folder) {
            Ok(page) => println!(
                "all presets, maps, lights and times of this moment: {}",
                page.display()
            ),
            Err(error) => eprintln!("no page of this moment: {error:#}"),
        }));
    }

    /// Waits until a page of a moment is written.
    pub fn wait_for_page(&mut self) {
        if let Some(page) = self.looking.take() {
            // The thread reports its failure itself.
            let _ = page.join();
        }
    }

    /// The user chose a toy's file.
    pub fn pick(&mut self, path: &Path) {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.worker.read_toy(folder, name.into_owned());
    }

    /// Waits until an ended recording is written, and passes on the result.
    pub fn wait_for_recording(&mut self) {
        self.worker.wait_for_recording();
        self.settle();
    }

    /// Completes all writing.
    pub fn close(&mut self) {
        self.tell(ShellEvent::Foreground(false));
        self.wait_for_recording();
        self.wait_for_page();
    }
}

/// The first folder for a moment's page that does not exist yet: pages of earlier runs stay.
fn moment_folder(out: &Path) -> PathBuf {
    let mut number = 0;
    loop {
        let folder = out.join(format!("moment_{number:04}"));
        if !folder.exists() {
            return folder;
        }
        number += 1;
    }
}
