//! Events of the phone for the app, and the app's commands to the phone.

use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use app_core::app::{
    ArSession, GraphicsState, LaunchHistory, Panics, Permission, PlatformCommand, ShellCommand, ShellEvent,
    Thermal,
};
use app_core::interface::{Screen, announced};
use app_shell::folders::Folders;
use app_shell::losses::Losses;
use app_shell::starts;
use app_shell::video::MOTION_JPEG;
use app_shell::worker::{Outcome, Platform, Worker};
use arkit::camera;
use arkit::session::{Finds, Session};
use ios_media::jpeg;
use ios_media::video::H264;
use ios_media::voice_over::VoiceOver;
use objc2::MainThreadMarker;
use objc2_foundation::{NSDictionary, NSHomeDirectory, NSProcessInfo, NSURL};
use objc2_quartz_core::CALayer;
use objc2_ui_kit::{UIApplication, UIApplicationOpenSettingsURLString, UIView};

use crate::convert;
use crate::hand_on::{self, into_photos};
use crate::inbox::{CallbackMessage, Inbox};
use crate::person;
use crate::stage::{Fitted, Stage, StageError};

/// State of the shell.
pub(crate) struct Shell {
    main_thread: MainThreadMarker,
    stage: Stage,
    session: Session,
    inbox: Rc<Inbox>,
    worker: Worker,
    start: Instant,
    /// The last reported permission.
    permission: Option<Permission>,
    thermal: Option<Thermal>,
    wants_device: bool,
    losses: Losses,
    frames_per_s: u32,
    /// Files for the share sheet.
    shared: Vec<PathBuf>,
    /// The exposure to restore, while the camera is darkened.
    held_exposure: Option<camera::Exposure>,
    /// The history for the next app.
    history: Option<LaunchHistory>,
    panics: Panics,
    /// Whether a panic requires a new app.
    begins_anew: bool,
    is_restarted: bool,
}

impl Shell {
    /// A shell without an app, which the first fit creates.
    pub(crate) fn new(main_thread: MainThreadMarker, inbox: Rc<Inbox>) -> Self {
        Self {
            main_thread,
            stage: Stage::new(),
            session: Session::new(main_thread, told_to(&inbox)),
            inbox,
            worker: worker(),
            start: Instant::now(),
            permission: None,
            thermal: None,
            wants_device: false,
            losses: Losses::default(),
            frames_per_s: 60,
            shared: Vec::new(),
            held_exposure: None,
            history: None,
            panics: Panics::default(),
            begins_anew: false,
            is_restarted: false,
        }
    }

    /// Lets the app draw on `layer`, and reports the surface.
    pub(crate) fn fit(&mut self, layer: &CALayer, size_px: [u32; 2]) -> Result<(), StageError> {
        if self.stage.live().is_none() && self.history.is_none() {
            // This precedes every use of a driver.
            self.history = Some(starts::begin(&own_folder(), cfg!(debug_assertions)));
        }
        if self.stage.fit(layer, size_px)? == Fitted::Anew {
            self.lend();
            // The new app needs a new worker and new reports.
            self.worker = worker();
            (self.permission, self.thermal) = (None, None);
            if std::mem::take(&mut self.is_restarted) {
                self.inbox.tell(ShellEvent::Restarted);
            }
            if let Some(history) = self.history.take() {
                self.inbox.tell(ShellEvent::Started(history));
            }
            self.begins_anew = false;
            self.inbox.tell(ShellEvent::Language(person::language()));
            self.inbox.tell(ShellEvent::Foreground(true));
            if !Session::is_supported() {
                self.inbox.tell(ShellEvent::ArSession(ArSession::Unsupported));
            }
        }
        self.inbox.tell(ShellEvent::Surface(Some(size_px)));
        Ok(())
    }

    /// The app enters the foreground.
    pub(crate) fn enter_foreground(&mut self) {
        self.inbox.tell(ShellEvent::Foreground(true));
        self.session.enter_foreground();
    }

    /// The app leaves the foreground: on return nothing runs and nothing is drawn.
    pub(crate) fn enter_background(&mut self) {
        self.inbox.tell(ShellEvent::Foreground(false));
        self.inbox.tell(ShellEvent::Surface(None));
        self.settle();
        self.stage.suspend();
    }

    /// Draws one picture.
    pub(crate) fn present(&mut self, layer: &CALayer, screen: &Screen) -> Result<(), StageError> {
        self.look();
        self.settle();
        if !self.stage.has_surface() {
            return Ok(());
        }
        if std::mem::take(&mut self.wants_device) {
            self.stage.reopen(layer, screen.size_px)?;
            self.lend();
        }
        let time_s = self.start.elapsed().as_secs_f64();
        let Some(live) = self.stage.live() else {
            return Ok(());
        };
        match live.present(screen, time_s) {
            Ok(commands) => {
                self.losses.shown();
                self.worker.drawn(live, time_s);
                self.obey(commands);
            }
            Err(error) => {
                eprintln!("app-ios: {error}");
                if self.losses.is_of_surface(&error) {
                    // The next layout or picture makes another one on the same device.
                    self.stage.suspend();
                    self.stage.fit(layer, screen.size_px)?;
                } else {
                    self.inbox.tell(ShellEvent::Graphics(GraphicsState::Lost));
                }
            }
        }
        self.settle();
        Ok(())
    }

    /// Requested pictures per second, or fewer if they take too long.
    pub(crate) fn frames_per_s(&mut self) -> u32 {
        let governed = self.stage.live().and_then(|live| live.frames_per_s());
        governed.map_or(self.frames_per_s, |governed| governed.min(self.frames_per_s))
    }

    /// Sets the screen's orientation, a `UIInterfaceOrientation`.
    pub(crate) fn set_orientation(&self, orientation: isize) {
        self.session.set_orientation(orientation);
    }

    /// Shows ARKit's own guidance over the view.
    pub(crate) fn coach_over(&self, view: &UIView) {
        self.session.coach_over(view);
    }

    /// Gives VoiceOver the widgets of the latest picture.
    pub(crate) fn show_to(&mut self, voice_over: &VoiceOver) {
        if let Some(tree) = self.stage.live().and_then(|live| live.accessibility_tree()) {
            voice_over.update(tree);
        }
    }

    /// Files that wait for the share sheet.
    pub(crate) fn take_shared(&mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.shared)
    }

    /// Handles a panic, which has left the app in an unknown state.
    pub(crate) fn panicked(&mut self) {
        self.is_restarted = true;
        self.begins_anew = self.panics.begins_anew(self.start.elapsed().as_secs_f64());
    }

    /// Handles an error, after which only the person begins anew.
    pub(crate) fn stop(&mut self) {
        self.begins_anew = false;
    }

    /// Whether a panic requires a new app.
    pub(crate) fn begins_anew(&self) -> bool {
        self.begins_anew
    }

    /// Drops the app and everything that it contains.
    pub(crate) fn clear(&mut self) {
        self.session.pause();
        self.session.recognise(None);
        self.session.lend_to(None);
        self.stage.clear();
        let _ = self.inbox.take();
    }

    /// Lends the camera's pictures to the app's device.
    fn lend(&mut self) {
        let device = self.stage.live().and_then(|live| live.core_mut().device());
        self.session.lend_to(device);
    }

    /// Reports values that must be polled, if they changed.
    fn look(&mut self) {
        let permission = camera::permission();
        if self.permission.replace(permission) != Some(permission) {
            self.inbox.tell(ShellEvent::Permission(permission));
        }
        let thermal = convert::thermal(NSProcessInfo::processInfo().thermalState().0);
        if self.thermal.replace(thermal) != Some(thermal) {
            self.inbox.tell(ShellEvent::Thermal(thermal));
        }
        while let Some(outcome) = self.worker.outcome() {
            match outcome {
                Outcome::Tell(event) => self.inbox.tell(event),
                Outcome::Written(file) => into_photos(&file),
                Outcome::Share(files) => {
                    self.shared = files;
                    self.worker.shared()(true);
                }
                Outcome::Scan(scan) => self.session.recognise(scan.as_deref()),
            }
        }
    }

    /// Processes all events and their commands, until there are no more.
    fn settle(&mut self) {
        loop {
            let told = self.inbox.take();
            if told.is_empty() {
                return;
            }
            for told in told {
                let Some(live) = self.stage.live() else { return };
                match told {
                    CallbackMessage::Event(event) => {
                        let commands = live.event(event);
                        self.obey(commands);
                    }
                    CallbackMessage::Touch(touch) => live.touch(touch),
                    CallbackMessage::Request(request) => live.request(request),
                }
            }
        }
    }

    fn obey(&mut self, commands: Vec<ShellCommand>) {
        for command in commands {
            match command {
                ShellCommand::Platform(command) => self.call_platform(command),
                ShellCommand::Work(command) => {
                    let Some(live) = self.stage.live() else { return };
                    self.worker.obey(live, command);
                }
            }
        }
    }

    fn call_platform(&mut self, command: PlatformCommand) {
        match command {
            PlatformCommand::AskPermission => camera::ask_permission(),
            PlatformCommand::OpenSettings => self.open_settings(),
            PlatformCommand::RunTracking {
                finds_planes,
                finds_card,
                finds_people,
                measures_depth,
                is_new_world,
            } => {
                let finds = Finds {
                    planes: finds_planes,
                    card: finds_card,
                    people: finds_people,
                    depth: measures_depth,
                };
                self.session.run(finds, is_new_world);
            }
            PlatformCommand::PauseTracking => self.session.pause(),
            PlatformCommand::LockExposure(is_held) => camera::hold_exposure(is_held),
            PlatformCommand::Underexpose(true) => self.held_exposure = camera::underexpose(),
            PlatformCommand::Underexpose(false) => {
                if let Some(held) = self.held_exposure.take() {
                    camera::restore(&held);
                }
            }
            PlatformCommand::HoldAnchor {
                id,
                world_from_anchor,
            } => self.session.hold(id, &world_from_anchor),
            PlatformCommand::KeepAwake(is_kept) => {
                UIApplication::sharedApplication(self.main_thread).setIdleTimerDisabled(is_kept);
            }
            PlatformCommand::FrameRate(frames_per_s) => self.frames_per_s = frames_per_s,
            PlatformCommand::ReopenDevice => self.wants_device = true,
            PlatformCommand::Announce(_) => {
                if let Some(live) = self.stage.live() {
                    person::say(&announced(live.app()));
                }
            }
            PlatformCommand::Knock => person::knock(self.main_thread),
        }
    }

    fn open_settings(&self) {
        // SAFETY: a constant of UIKit.
        let Some(url) = NSURL::URLWithString(unsafe { UIApplicationOpenSettingsURLString }) else {
            return;
        };
        let application = UIApplication::sharedApplication(self.main_thread);
        // SAFETY: without options and without a handler there is nothing that could be of a wrong type.
        unsafe { application.openURL_options_completionHandler(&url, &NSDictionary::new(), None) };
    }
}

/// Stores an event for the shell.
fn told_to(inbox: &Rc<Inbox>) -> Rc<dyn Fn(ShellEvent)> {
    let inbox = Rc::clone(inbox);
    Rc::new(move |event| inbox.tell(event))
}

/// A worker for a new app.
fn worker() -> Worker {
    let platform = Platform {
        app: concat!("app-ios ", env!("CARGO_PKG_VERSION")),
        videos: &[H264, MOTION_JPEG],
        codec: Arc::new(jpeg::codec),
        keep_running: hand_on::keep_running,
    };
    // The folder that Files displays.
    let documents = PathBuf::from(NSHomeDirectory().to_string()).join("Documents");
    let folders = Folders {
        shared: Some(documents.clone()),
        toys: Some(documents),
        own: Some(own_folder()),
    };
    let worker = Worker::new(platform, folders);
    worker.begin_log();
    worker
}

/// The folder of the app's own files; the system creates it with the app's home.
fn own_folder() -> PathBuf {
    PathBuf::from(NSHomeDirectory().to_string()).join("Library")
}
