//! A shell on a desktop: it does what the app asks for, with a session as its camera and a folder for what people keep.

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

/// What a person keeps, and how.
#[derive(Clone, Debug)]
pub struct Keeping {
    /// Where photos, videos and recordings go.
    pub out: PathBuf,
    /// Quality of a recording's pictures; lossless without one.
    pub jpeg_quality: Option<u8>,
    /// The toy that a person chooses when asked, or a folder of toys to choose from in place of `out`.
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
    /// Its camera.
    pub feed: Feed,
    /// What a person answers when the camera is asked for.
    pub answer: Permission,
    /// What a person keeps.
    pub keeping: Keeping,
    worker: Worker,
    is_tracking: bool,
    n_moments: usize,
    /// Whether the device is to be opened anew.
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
            n_moments: 0,
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
        self.settle();
        if self.is_tracking {
            let frame = self.feed.next(elapsed_s);
            self.tell(ShellEvent::Frame(Box::new(frame)));
        }
    }

    /// Runs the alignments that wait, at a pace that has them wait.
    pub fn align(&mut self) {
        self.worker.align_waiting();
        self.settle();
    }

    /// Passes on what came of work.
    fn settle(&mut self) {
        while let Some(outcome) = self.worker.outcome() {
            match outcome {
                Outcome::Tell(event) => self.tell(event),
                // No platform here recognises anything.
                Outcome::Scan(_) => {}
                Outcome::Written(file) => println!("{}", file.display()),
                Outcome::Share(files) => files.iter().for_each(|file| println!("{}", file.display())),
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

    /// Takes the toy that was named, if it is no folder of several.
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
            // A desktop has no screen that goes off, no lens to hold and no settings of its own.
            _ => {}
        }
    }

    /// Writes a page of the moment that is shown, with every preset, on a thread that tells where it is; none while the toy does not
    /// move.
    pub fn look_into(&mut self) -> Option<JoinHandle<()>> {
        let moment = Moment::of(self.live.app())?;
        let folder = self.keeping.out.join(format!("moment_{:04}", self.n_moments));
        self.n_moments += 1;
        Some(thread::spawn(move || match moment.write(&folder) {
            Ok(page) => println!(
                "all presets, maps, lights and times of this moment: {}",
                page.display()
            ),
            Err(error) => eprintln!("no page of this moment: {error:#}"),
        }))
    }

    /// A person chose a toy's file.
    pub fn pick(&mut self, path: &Path) {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        self.worker.read_toy(folder, name.into_owned());
    }

    /// Waits until a recording that was ended is written, and tells.
    pub fn wait_for_recording(&mut self) {
        self.worker.wait_for_recording();
        self.settle();
    }

    /// Leaves nothing unwritten behind.
    pub fn close(&mut self) {
        self.tell(ShellEvent::Foreground(false));
        self.wait_for_recording();
    }
}
