//! The shell: it executes the app's commands and reports events. It contains everything except
//! Android itself, so that it runs in tests.

use std::sync::Arc;
use std::time::{Duration, Instant};

use app_core::app::{GraphicsState, Obstacle, PlatformCommand, ShellCommand, ShellEvent};
use app_core::interface::{Screen, announced};
use app_core::live::Live;
use app_core::recording::PictureCodec;
use app_core::toy::{Toy, ToyError};
use app_shell::folders::Folders;
use app_shell::losses::Losses;
use app_shell::pace::Pace;
use app_shell::toys::BUNDLED;
use app_shell::video::{MOTION_JPEG, VideoFormat};
use app_shell::worker::{Outcome, Platform, Worker};
use app_shell::{kept, record};
use arcore::feed::Feed;
use arcore::tracker::{Geometry, Run};

use crate::phone::{self, Phone};

/// Frame rate of the camera; each of its pictures gives a frame.
const CAMERA_HZ: u32 = 30;
/// File with the size of the camera's pictures, if larger ones fail.
const CAMERA_FILE: &str = "camera.txt";
/// Time between reads of the display's rotation: Android does not report half a turn.
const TURN: Duration = Duration::from_millis(250);
/// Time between reads of the thermal state.
const LOOK: Duration = Duration::from_secs(1);
/// Formats of videos, in order of preference.
#[cfg(target_os = "android")]
const VIDEOS: &[VideoFormat] = &[android_media::video::H264, MOTION_JPEG];
#[cfg(not(target_os = "android"))]
const VIDEOS: &[VideoFormat] = &[MOTION_JPEG];

/// The toy that is part of the app: that of the bundled session, made by this project.
///
/// # Errors
///
/// Fails if it cannot be read.
pub fn bundled_toy() -> Result<Arc<Toy>, ToyError> {
    Ok(Arc::new(Toy::from_glb("toy.glb", BUNDLED)?))
}

/// An app on a phone.
pub struct Shell<P> {
    live: Live,
    phone: P,
    feed: Feed,
    worker: Worker,
    wants_device: bool,
    wants_surface: bool,
    losses: Losses,
    size_px: Option<[u32; 2]>,
    pace: Pace,
    start: Instant,
    /// Times of the last reads of the thermal state and of the display's rotation.
    looked: Option<Instant>,
    turned: Option<Instant>,
}

impl<P: Phone> Shell<P> {
    /// A shell at its launch.
    pub fn new(mut live: Live, phone: P, feed: Feed) -> Self {
        live.set_clock(record::clock());
        live.set_target_fps(CAMERA_HZ);
        live.disclose(arcore::status::DISCLOSURE.into());
        let platform = Platform {
            app: concat!("app-android ", env!("CARGO_PKG_VERSION")),
            videos: VIDEOS,
            codec: Arc::new(|| PictureCodec::PHONE),
            // Android lets an abandoned activity continue for minutes.
            keep_running: || Box::new(()),
        };
        let folders = Folders {
            shared: phone.folder(),
            toys: phone.folder(),
            own: phone.own_folder(),
        };
        let kept = folders
            .own
            .as_deref()
            .and_then(|own| kept::text(own, CAMERA_FILE));
        let worker = Worker::new(platform, folders);
        worker.begin_log();
        let mut shell = Self {
            live,
            phone,
            feed: feed.with_kept(kept.as_deref().unwrap_or_default()),
            worker,
            wants_device: false,
            wants_surface: false,
            losses: Losses::default(),
            size_px: None,
            pace: Pace::default(),
            start: Instant::now(),
            looked: None,
            turned: None,
        };
        let language = shell.phone.language();
        shell.tell(ShellEvent::Language(language));
        let event = shell.feed.come_back();
        shell.tell_some(event);
        shell
    }

    /// The app.
    pub fn live(&mut self) -> &mut Live {
        &mut self.live
    }

    /// The phone.
    #[cfg(any(test, target_os = "android"))]
    pub(crate) fn phone(&self) -> &P {
        &self.phone
    }

    /// Gives an event to the app, and executes its commands.
    pub fn tell(&mut self, event: ShellEvent) {
        let commands = self.live.event(event);
        self.obey(commands);
    }

    /// Handles the activity's entry to the foreground, where the camera's permission may have
    /// changed, or its exit.
    pub fn set_foreground(&mut self, is_foreground: bool) {
        if is_foreground {
            let permission = self.phone.permission();
            self.tell(ShellEvent::Permission(permission));
            let event = self.feed.come_back();
            self.tell_some(event);
        }
        self.tell(ShellEvent::Foreground(is_foreground));
    }

    /// Sets the window's size in pixels; `None` without a window.
    pub fn set_surface(&mut self, size_px: Option<[u32; 2]>) {
        self.size_px = size_px;
        self.follow_display();
        self.pace.touched();
        self.tell(ShellEvent::Surface(size_px));
    }

    /// Tells ARCore the display's orientation.
    fn follow_display(&mut self) {
        if let Some(size_px) = self.size_px {
            self.feed.set_display(Geometry {
                quarter_turns: self.phone.rotation(),
                size_px: size_px.map(|side| i32::try_from(side).unwrap_or(0)),
            });
        }
    }

    /// The timing of pictures.
    pub fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }

    /// The phone's back gesture, within the app or out of it.
    pub fn back(&mut self) {
        self.pace.touched();
        match self.live.back() {
            Some(commands) => self.obey(commands),
            None => self.phone.leave(),
        }
    }

    /// Reports results of other threads, and the camera's latest frame.
    pub fn tick(&mut self) {
        self.live.begin_picture();
        while let Some(outcome) = self.worker.outcome() {
            self.settle(outcome);
        }
        if self.looked.is_none_or(|looked| looked.elapsed() >= LOOK) {
            self.looked = Some(Instant::now());
            if let Some(status) = self.phone.thermal_status() {
                self.tell(ShellEvent::Thermal(phone::thermal(status)));
            }
        }
        if self.turned.is_none_or(|turned| turned.elapsed() >= TURN) {
            self.turned = Some(Instant::now());
            self.follow_display();
        }
        let waits = self.live.app().obstacle() == Some(Obstacle::Interrupted);
        self.feed.set_wanted(waits);
        let event = self.feed.poll(&mut self.phone, self.start.elapsed());
        if matches!(event, Some(ShellEvent::Frame(_))) {
            self.pace.camera_came(self.start.elapsed());
        }
        self.tell_some(event);
        if let (Some(text), Some(own)) = (self.feed.take_kept(), self.phone.own_folder()) {
            kept::store_or_say(&own, CAMERA_FILE, text.as_bytes());
        }
    }

    /// Draws on the core's surface. A lost device or surface must be replaced.
    pub fn present(&mut self, screen: &Screen, time_s: f64) {
        match self.live.present(screen, time_s) {
            Ok(commands) => {
                self.losses.shown();
                self.worker.drawn(&self.live, time_s);
                self.obey(commands);
            }
            Err(error) => {
                eprintln!("app-android: nothing drawn: {error}");
                if self.losses.is_of_surface(&error) {
                    self.wants_surface = true;
                } else {
                    self.tell(ShellEvent::Graphics(GraphicsState::Lost));
                }
            }
        }
    }

    /// Whether the window needs another surface; this resets the request.
    pub fn take_wants_surface(&mut self) -> bool {
        std::mem::take(&mut self.wants_surface)
    }

    /// Whether another core is needed; this resets the request.
    pub fn take_wants_device(&mut self) -> bool {
        std::mem::take(&mut self.wants_device)
    }

    fn tell_some(&mut self, event: Option<ShellEvent>) {
        event.into_iter().for_each(|event| self.tell(event));
    }

    /// Passes on a result of work.
    pub(crate) fn settle(&mut self, outcome: Outcome) {
        match outcome {
            Outcome::Tell(event) => self.tell(event),
            Outcome::Written(file) => self.phone.show_in_gallery(file),
            Outcome::Share(files) => self.phone.share(files, self.worker.shared()),
            Outcome::Scan(Some(_)) => eprintln!("app-android: ARCore recognises no objects by a scan"),
            Outcome::Scan(None) => {}
        }
    }

    /// Executes the app's commands.
    pub(crate) fn obey(&mut self, commands: Vec<ShellCommand>) {
        for command in commands {
            match command {
                ShellCommand::Platform(command) => self.call_platform(command),
                ShellCommand::Work(command) => self.worker.obey(&self.live, command),
            }
        }
    }

    fn call_platform(&mut self, command: PlatformCommand) {
        match command {
            PlatformCommand::AskPermission => self.phone.ask_for_camera(),
            PlatformCommand::OpenSettings => self.phone.open_settings(),
            PlatformCommand::RunTracking {
                finds_planes,
                finds_card,
                is_new_world,
                ..
            } => {
                let run = Run {
                    finds_planes,
                    finds_card,
                    is_new_world,
                };
                let event = self.feed.run(&mut self.phone, run);
                self.tell_some(event);
            }
            PlatformCommand::PauseTracking => self.feed.pause(),
            PlatformCommand::HoldAnchor {
                id,
                world_from_anchor,
            } => self.feed.hold(id, &world_from_anchor),
            PlatformCommand::KeepAwake(is_awake) => self.phone.keep_awake(is_awake),
            PlatformCommand::ReopenDevice => self.wants_device = true,
            PlatformCommand::Announce(_) => self.phone.say(announced(self.live.app())),
            PlatformCommand::Knock => self.phone.knock(),
            PlatformCommand::FrameRate(frames_per_s) => self.pace.set_rate(frames_per_s),
            // ARCore does not give access to the exposure.
            PlatformCommand::LockExposure(_) | PlatformCommand::Underexpose(_) => {}
        }
    }
}
