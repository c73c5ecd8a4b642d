//! What the app is told of the phone, and what the phone is asked for by the app.

use std::path::PathBuf;
use std::rc::Rc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant, SystemTime};

use app_core::app::{
    ArSession, Device, Panics, Permission, Recorded, Saved, ShellCommand, ShellEvent, Starts, Thermal,
};
use app_core::interface::Screen;
use app_core::recording::{Take, Taken};
use app_files::toys::{self, ToyFile};
use app_files::video::{MOTION_JPEG, Video, VideoFormat};
use app_files::{record, save, starts};
use objc2::MainThreadMarker;
use objc2_foundation::{NSDictionary, NSHomeDirectory, NSProcessInfo, NSURL};
use objc2_quartz_core::CALayer;
use objc2_ui_kit::{UIApplication, UIApplicationOpenSettingsURLString};

use crate::arkit::session::Session;
use crate::hand_on::{Unsuspended, into_photos};
use crate::inbox::{Inbox, Told};
use crate::jobs::Jobs;
use crate::stage::{Fitted, Stage, StageError};
use crate::video::H264;
use crate::{camera, convert, jpeg};

/// The app with its version, as recordings name it.
const APP: &str = concat!("app-ios ", env!("CARGO_PKG_VERSION"));
/// Time after which free space is looked at anew.
const LOOK: Duration = Duration::from_secs(1);
/// Of videos, the better first.
const VIDEOS: &[VideoFormat] = &[H264, MOTION_JPEG];

/// The app's hands.
pub(crate) struct Shell {
    main_thread: MainThreadMarker,
    stage: Stage,
    session: Session,
    inbox: Rc<Inbox>,
    jobs: Jobs,
    start: Instant,
    /// As told last.
    permission: Option<Permission>,
    thermal: Option<Thermal>,
    /// When free space was looked at.
    looked: Option<Instant>,
    wants_device: bool,
    frames_per_s: u32,
    toy_file: ToyFile,
    video: Option<Video>,
    /// Photos and videos that threads have written.
    written: (Sender<PathBuf>, Receiver<PathBuf>),
    /// For the share sheet.
    shared: Vec<PathBuf>,
    /// While the camera is darkened.
    held_exposure: Option<camera::Exposure>,
    /// For an app that is about to be made.
    starts: Option<Starts>,
    panics: Panics,
    /// After a panic, until there is a new app.
    begins_anew: bool,
    is_restarted: bool,
}

impl Shell {
    /// A shell without an app, which comes with the first fit.
    pub(crate) fn new(main_thread: MainThreadMarker, inbox: Rc<Inbox>) -> Self {
        Self {
            main_thread,
            stage: Stage::new(),
            session: Session::new(main_thread, Rc::clone(&inbox)),
            inbox,
            jobs: Jobs::default(),
            start: Instant::now(),
            permission: None,
            thermal: None,
            looked: None,
            wants_device: false,
            frames_per_s: 60,
            toy_file: ToyFile::default(),
            video: None,
            written: channel(),
            shared: Vec::new(),
            held_exposure: None,
            starts: None,
            panics: Panics::default(),
            begins_anew: false,
            is_restarted: false,
        }
    }

    /// Lets the app draw on `layer`, and tells it.
    pub(crate) fn fit(&mut self, layer: &CALayer, size_px: [u32; 2]) -> Result<(), StageError> {
        if self.stage.live().is_none() && self.starts.is_none() {
            // Before a driver is asked for anything.
            self.starts = Some(starts::begin(&own_folder()));
        }
        if self.stage.fit(layer, size_px)? == Fitted::Anew {
            self.lend();
            // Another app than the one that threads worked for, and that was told.
            self.jobs = Jobs::default();
            (self.toy_file, self.video) = (ToyFile::default(), None);
            (self.permission, self.thermal) = (None, None);
            if std::mem::take(&mut self.is_restarted) {
                self.inbox.tell(ShellEvent::Restarted);
            }
            if let Some(starts) = self.starts.take() {
                self.inbox.tell(ShellEvent::Started(starts));
            }
            self.begins_anew = false;
            self.inbox.tell(ShellEvent::Foreground(true));
            if !Session::is_supported() {
                self.inbox.tell(ShellEvent::ArSession(ArSession::Unsupported));
            }
        }
        self.inbox.tell(ShellEvent::Surface(Some(size_px)));
        Ok(())
    }

    /// The app came to the front.
    pub(crate) fn enter_foreground(&mut self) {
        self.inbox.tell(ShellEvent::Foreground(true));
        self.session.enter_foreground();
    }

    /// The app leaves the front: nothing runs and nothing is drawn when this returns.
    pub(crate) fn enter_background(&mut self) {
        self.inbox.tell(ShellEvent::Foreground(false));
        self.inbox.tell(ShellEvent::Surface(None));
        self.settle();
        self.stage.suspend();
    }

    /// One picture.
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
                self.add_to_video(time_s);
                self.obey(commands);
            }
            Err(error) => {
                eprintln!("app-ios: {error}");
                self.inbox.tell(ShellEvent::Device(Device::Lost));
            }
        }
        self.settle();
        Ok(())
    }

    /// Pictures a second that the app asks for.
    pub(crate) fn frames_per_s(&self) -> u32 {
        self.frames_per_s
    }

    /// Files that wait for the share sheet.
    pub(crate) fn take_shared(&mut self) -> Vec<PathBuf> {
        std::mem::take(&mut self.shared)
    }

    /// A panic has left the app half changed.
    pub(crate) fn panicked(&mut self) {
        self.is_restarted = true;
        self.begins_anew = self.panics.begins_anew(self.start.elapsed().as_secs_f64());
    }

    /// Whether a new app is to be made for the one that a panic ended.
    pub(crate) fn begins_anew(&self) -> bool {
        self.begins_anew
    }

    /// Drops the app with all it holds.
    pub(crate) fn clear(&mut self) {
        self.session.pause();
        self.session.lend_to(None);
        self.stage.clear();
        let _ = self.inbox.take();
    }

    /// Has the camera's pictures lent to the app's device.
    fn lend(&mut self) {
        let device = self.stage.live().and_then(|live| live.core_mut().device());
        self.session.lend_to(device);
    }

    /// Tells what has to be looked for, where it changed.
    fn look(&mut self) {
        let permission = camera::permission();
        if self.permission.replace(permission) != Some(permission) {
            self.inbox.tell(ShellEvent::Permission(permission));
        }
        let thermal = convert::thermal(NSProcessInfo::processInfo().thermalState().0);
        if self.thermal.replace(thermal) != Some(thermal) {
            self.inbox.tell(ShellEvent::Thermal(thermal));
        }
        if self.looked.is_none_or(|looked| looked.elapsed() >= LOOK) {
            self.looked = Some(Instant::now());
            if let Some(free_bytes) = record::free_bytes(&documents()) {
                self.inbox.tell(ShellEvent::FreeSpace(free_bytes));
            }
        }
        while let Some(event) = self.jobs.result() {
            self.inbox.tell(event);
        }
        while let Ok(file) = self.written.1.try_recv() {
            into_photos(&file);
        }
    }

    /// Hands over all that was told, until there is no more.
    fn settle(&mut self) {
        loop {
            let told = self.inbox.take();
            if told.is_empty() {
                return;
            }
            for told in told {
                let Some(live) = self.stage.live() else { return };
                match told {
                    Told::Event(event) => {
                        let commands = live.event(event);
                        self.obey(commands);
                    }
                    Told::Touch(touch) => live.touch(touch),
                }
            }
        }
    }

    fn obey(&mut self, commands: Vec<ShellCommand>) {
        for command in commands {
            match command {
                ShellCommand::AskPermission => camera::ask_permission(),
                ShellCommand::OpenSettings => self.open_settings(),
                ShellCommand::RunTracking {
                    finds_planes,
                    is_new_world,
                } => self.session.run(finds_planes, is_new_world),
                ShellCommand::PauseTracking => self.session.pause(),
                ShellCommand::LockExposure(is_held) => camera::hold_exposure(is_held),
                ShellCommand::Underexpose(true) => self.held_exposure = camera::underexpose(),
                ShellCommand::Underexpose(false) => {
                    if let Some(held) = self.held_exposure.take() {
                        camera::restore(&held);
                    }
                }
                ShellCommand::HoldAnchor {
                    id,
                    world_from_anchor,
                } => self.session.hold(id, &world_from_anchor),
                ShellCommand::KeepAwake(is_kept) => {
                    UIApplication::sharedApplication(self.main_thread).setIdleTimerDisabled(is_kept);
                }
                ShellCommand::FrameRate(frames_per_s) => self.frames_per_s = frames_per_s,
                ShellCommand::Align(job) => self.jobs.start(
                    move || ShellEvent::Aligned(Some(Box::new(job.run()))),
                    || ShellEvent::Aligned(None),
                ),
                ShellCommand::ReopenDevice => self.wants_device = true,
                ShellCommand::SavePhoto => self.save_photo(),
                ShellCommand::Share => self.share(),
                ShellCommand::Record(Some(take)) => self.record(*take),
                ShellCommand::Video(true) => self.begin_video(),
                ShellCommand::Video(false) => self.video = None,
                ShellCommand::Remember(text) => {
                    if let Err(error) = starts::store(&own_folder(), &text) {
                        eprintln!("app-ios: the start is not kept: {error}");
                    }
                }
                ShellCommand::PickToy => self.inbox.tell(ShellEvent::ToyFiles(toys::list(&documents()))),
                ShellCommand::ReadToy(name) => {
                    let file = self.toy_file.clone();
                    let died = || ShellEvent::Toy(Err("it could not be read".to_owned()));
                    self.jobs.start(move || file.read(&documents(), &name), died);
                }
                ShellCommand::Record(None) | ShellCommand::Announce(_) => {}
            }
        }
    }

    fn saved(&self, saved: Saved) {
        self.inbox.tell(ShellEvent::Saved(saved));
    }

    fn begin_video(&mut self) {
        let (done, written) = (self.jobs.teller(), self.written.0.clone());
        // An app that is left in the middle of a video would be stopped before its file is whole.
        let unsuspended = Unsuspended::begin(self.main_thread);
        let tell = move |saved, file: Option<PathBuf>| {
            // Whoever waited may be gone.
            let _ = done.send(ShellEvent::Saved(saved));
            let _ = file.map(|file| written.send(file));
            drop(unsuspended);
        };
        match Video::begin(&documents(), VIDEOS, tell) {
            Ok(video) => self.video = Some(video),
            Err(_) => self.saved(Saved::Failed),
        }
    }

    /// The picture that was just drawn, for a video.
    fn add_to_video(&mut self, time_s: f64) {
        let Some(video) = self.video.as_mut().filter(|video| video.is_due(time_s)) else {
            return;
        };
        if let Some(Ok(picture)) = self.stage.live().map(|live| live.read_picture()) {
            video.add(picture, time_s);
        }
    }

    fn save_photo(&mut self) {
        let Some(Ok(picture)) = self.stage.live().map(|live| live.read_picture()) else {
            return self.saved(Saved::Failed);
        };
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let name = format!("photo_{}.png", since_1970.unwrap_or_default().as_millis());
        let written = self.written.0.clone();
        self.jobs.start(
            move || {
                let saved = save::picture(&documents(), &name, &picture);
                if saved == Saved::Done {
                    // Whoever waited may be gone.
                    let _ = written.send(documents().join(name));
                }
                ShellEvent::Saved(saved)
            },
            || ShellEvent::Saved(Saved::Failed),
        );
    }

    fn share(&mut self) {
        let Some(live) = self.stage.live() else { return };
        let (saved, files) = record::share(live, &documents());
        self.shared = files;
        self.saved(saved);
    }

    fn record(&mut self, take: Take) {
        let (number, toy) = (take.number(), self.toy_file.bytes());
        self.jobs.start(
            move || ShellEvent::Recorded(record::write(take, (APP, &toy), jpeg::codec(), &documents())),
            move || {
                ShellEvent::Recorded(Recorded {
                    file: String::new(),
                    taken: Taken::died(number),
                })
            },
        );
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

/// The folder of what is the app's own; a system makes it with the app's home.
fn own_folder() -> PathBuf {
    PathBuf::from(NSHomeDirectory().to_string()).join("Library")
}

/// The folder that Files shows.
fn documents() -> PathBuf {
    PathBuf::from(NSHomeDirectory().to_string()).join("Documents")
}
