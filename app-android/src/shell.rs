//! The shell: what the app asks for is done, and what happens is told. All but Android itself, so that it runs in tests.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use app_core::app::{AlignJob, Device, Recorded, Saved, ShellCommand, ShellEvent};
use app_core::interface::Screen;
use app_core::live::Live;
use app_core::recording::{PictureCodec, Take, Taken};
use app_core::toy::{Toy, ToyError};
use app_files::toys::{self, BUNDLED, ToyFile};
use app_files::video::{Video, VideoFormat};
use app_files::{record, save, starts};

use crate::arcore::feed::Feed;
use crate::arcore::tracker::{Geometry, Run};
use crate::convert;
use crate::guard::{Callback, guarded};
use crate::phone::Phone;

/// `Surface.ROTATION_90`: the manifest keeps the activity in landscape.
const LANDSCAPE: i32 = 1;

/// The app with its version, as recordings name it.
const APP: &str = concat!("app-android ", env!("CARGO_PKG_VERSION"));
/// Time after which heat and free space are looked at anew.
const LOOK: Duration = Duration::from_secs(1);
/// Of videos, the better first.
#[cfg(target_os = "android")]
const VIDEOS: &[VideoFormat] = &[crate::video::H264, app_files::video::MOTION_JPEG];
#[cfg(not(target_os = "android"))]
const VIDEOS: &[VideoFormat] = &[app_files::video::MOTION_JPEG];

/// The toy that the app comes with: the bundled session's, this project's own.
///
/// # Errors
/// If it cannot be read.
pub fn bundled_toy() -> Result<Arc<Toy>, ToyError> {
    Ok(Arc::new(Toy::from_glb("toy.glb", BUNDLED)?))
}

/// An app and the phone that it runs on.
pub struct Shell<P> {
    live: Live,
    phone: P,
    feed: Feed,
    toy_file: ToyFile,
    video: Option<Video>,
    /// Photos and videos that threads have written.
    written: (Sender<PathBuf>, Receiver<PathBuf>),
    /// What other threads tell.
    done: (Sender<ShellEvent>, Receiver<ShellEvent>),
    wants_device: bool,
    /// When heat and free space were looked at.
    looked: Option<Instant>,
}

impl<P: Phone> Shell<P> {
    /// A shell that has just been started.
    pub fn new(mut live: Live, phone: P, feed: Feed) -> Self {
        live.time_by(record::clock());
        let mut shell = Self {
            live,
            phone,
            feed,
            toy_file: ToyFile::default(),
            video: None,
            written: channel(),
            done: channel(),
            wants_device: false,
            looked: None,
        };
        let event = shell.feed.come_back();
        shell.tell_some(event);
        shell
    }

    /// The app.
    pub fn live(&mut self) -> &mut Live {
        &mut self.live
    }

    /// The phone.
    #[cfg(test)]
    pub(crate) fn phone(&self) -> &P {
        &self.phone
    }

    /// Tells the app, and does what it asks for.
    pub fn tell(&mut self, event: ShellEvent) {
        let commands = self.live.event(event);
        self.obey(commands);
    }

    /// The activity came to the front, where the camera's permission may have become another, or left it.
    pub fn set_foreground(&mut self, is_foreground: bool) {
        if is_foreground {
            let permission = self.phone.permission();
            self.tell(ShellEvent::Permission(permission));
            let event = self.feed.come_back();
            self.tell_some(event);
        }
        self.tell(ShellEvent::Foreground(is_foreground));
    }

    /// There is a window of so many pixels, or none.
    pub fn set_surface(&mut self, size_px: Option<[u32; 2]>) {
        if let Some([width, height]) = size_px.map(|size| size.map(|side| i32::try_from(side).unwrap_or(0))) {
            self.feed.set_display(Geometry {
                quarter_turns: LANDSCAPE,
                size_px: [width, height],
            });
        }
        self.tell(ShellEvent::Surface(size_px));
    }

    /// Tells what other threads have done, and the camera's latest frame.
    pub fn tick(&mut self) {
        while let Ok(event) = self.done.1.try_recv() {
            self.tell(event);
        }
        while let Ok(file) = self.written.1.try_recv() {
            self.phone.show_in_gallery(file);
        }
        if self.looked.is_none_or(|looked| looked.elapsed() >= LOOK) {
            self.looked = Some(Instant::now());
            if let Some(status) = self.phone.thermal_status() {
                self.tell(ShellEvent::Thermal(convert::thermal(status)));
            }
            let free = self.phone.folder().and_then(|folder| record::free_bytes(&folder));
            self.tell_some(free.map(ShellEvent::FreeSpace));
        }
        let event = self.feed.poll(&mut self.phone);
        self.tell_some(event);
    }

    /// Draws on the core's surface. A device or surface that is lost is to be brought anew.
    pub fn present(&mut self, screen: &Screen, time_s: f64) {
        match self.live.present(screen, time_s) {
            Ok(commands) => {
                self.add_to_video(time_s);
                self.obey(commands);
            }
            Err(error) => {
                eprintln!("app-android: nothing drawn: {error}");
                self.tell(ShellEvent::Device(Device::Lost));
            }
        }
    }

    /// Whether another core is to be brought; asked once.
    pub fn take_wants_device(&mut self) -> bool {
        std::mem::take(&mut self.wants_device)
    }

    fn tell_some(&mut self, event: Option<ShellEvent>) {
        event.into_iter().for_each(|event| self.tell(event));
    }

    pub(crate) fn obey(&mut self, commands: Vec<ShellCommand>) {
        for command in commands {
            match command {
                ShellCommand::AskPermission => self.phone.ask_for_camera(),
                ShellCommand::OpenSettings => self.phone.open_settings(),
                ShellCommand::RunTracking {
                    finds_planes,
                    is_new_world,
                } => {
                    let run = Run {
                        finds_planes,
                        is_new_world,
                    };
                    let event = self.feed.run(&mut self.phone, run);
                    self.tell_some(event);
                }
                ShellCommand::PauseTracking => self.feed.pause(),
                ShellCommand::HoldAnchor {
                    id,
                    world_from_anchor,
                } => self.feed.hold(id, &world_from_anchor),
                ShellCommand::KeepAwake(is_awake) => self.phone.keep_awake(is_awake),
                ShellCommand::Align(job) => self.align(job),
                ShellCommand::ReopenDevice => self.wants_device = true,
                ShellCommand::SavePhoto => self.save_photo(),
                ShellCommand::Share => self.share(),
                ShellCommand::Record(Some(take)) => self.record(*take),
                ShellCommand::Video(true) => self.begin_video(),
                ShellCommand::Video(false) => self.video = None,
                ShellCommand::PickToy => {
                    let folder = self.phone.folder();
                    let files = toys::list(&folder.unwrap_or_default());
                    self.tell(ShellEvent::ToyFiles(files));
                }
                ShellCommand::ReadToy(name) => {
                    let (file, folder) = (self.toy_file.clone(), self.phone.folder().unwrap_or_default());
                    let died = ShellEvent::Toy(Err("it could not be read".to_owned()));
                    self.on_thread("toy", died, move || file.read(&folder, &name));
                }
                ShellCommand::Remember(text) => {
                    let kept = self
                        .phone
                        .own_folder()
                        .map(|folder| starts::store(&folder, &text));
                    if let Some(Err(error)) = kept {
                        eprintln!("app-android: the start is not kept: {error}");
                    }
                }
                ShellCommand::Announce(step) => eprintln!("app-android: {step:?}"),
                // ARCore keeps exposure and frame rate to itself.
                ShellCommand::LockExposure(_)
                | ShellCommand::Underexpose(_)
                | ShellCommand::FrameRate(_)
                | ShellCommand::Record(None) => {}
            }
        }
    }

    /// On a thread of its own; one that panics or cannot be started is told as well.
    fn align(&mut self, job: Box<AlignJob>) {
        self.on_thread("align", ShellEvent::Aligned(None), move || {
            ShellEvent::Aligned(Some(Box::new(job.run())))
        });
    }

    fn record(&mut self, take: Take) {
        let Some(folder) = self.phone.folder() else {
            let taken = take.without_file(&std::io::ErrorKind::PermissionDenied.into());
            let file = String::new();
            return self.tell(ShellEvent::Recorded(Recorded { file, taken }));
        };
        let died = ShellEvent::Recorded(Recorded {
            file: folder.display().to_string(),
            taken: Taken::died(take.number()),
        });
        let toy = self.toy_file.bytes();
        self.on_thread("record", died, move || {
            ShellEvent::Recorded(record::write(take, (APP, &toy), PictureCodec::PHONE, &folder))
        });
    }

    fn share(&mut self) {
        let Some(folder) = self.phone.folder() else {
            return self.tell(ShellEvent::Saved(Saved::NotAllowed));
        };
        let (saved, files) = record::share(&self.live, &folder);
        if !files.is_empty() {
            self.phone.share(files);
        }
        self.tell(ShellEvent::Saved(saved));
    }

    fn begin_video(&mut self) {
        let (done, written) = (self.done.0.clone(), self.written.0.clone());
        let tell = move |saved, file: Option<PathBuf>| {
            // The activity may be gone by then.
            let _ = done.send(ShellEvent::Saved(saved));
            let _ = file.map(|file| written.send(file));
        };
        let begun = self
            .phone
            .folder()
            .map(|folder| Video::begin(&folder, VIDEOS, tell));
        match begun {
            Some(Ok(video)) => self.video = Some(video),
            Some(Err(_)) => self.tell(ShellEvent::Saved(Saved::Failed)),
            None => self.tell(ShellEvent::Saved(Saved::NotAllowed)),
        }
    }

    /// The picture that was just drawn, for a video.
    fn add_to_video(&mut self, time_s: f64) {
        let Some(video) = self.video.as_mut().filter(|video| video.is_due(time_s)) else {
            return;
        };
        if let Ok(picture) = self.live.read_picture() {
            video.add(picture, time_s);
        }
    }

    fn save_photo(&mut self) {
        let (Ok(picture), Some(folder)) = (self.live.read_picture(), self.phone.folder()) else {
            return self.tell(ShellEvent::Saved(Saved::Failed));
        };
        // A clock that is set before 1970 makes every photo the same file.
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let name = format!("photo_{}.png", since.as_millis());
        let written = self.written.0.clone();
        self.on_thread("photo", ShellEvent::Saved(Saved::Failed), move || {
            let saved = save::picture(&folder, &name, &picture);
            if saved == Saved::Done {
                // The activity may be gone by then.
                let _ = written.send(folder.join(name));
            }
            ShellEvent::Saved(saved)
        });
    }

    /// Runs `work` on a thread and tells its outcome, or `otherwise` where there is none.
    fn on_thread(
        &mut self,
        name: &str,
        otherwise: ShellEvent,
        work: impl FnOnce() -> ShellEvent + Send + 'static,
    ) {
        let done = self.done.0.clone();
        let (hand_over, taken) = channel();
        let thread = thread::Builder::new().name(name.to_owned()).spawn(move || {
            let Ok(otherwise) = taken.recv() else { return };
            let event = guarded(Callback::Thread, work).unwrap_or(otherwise);
            // The activity may be gone by now.
            let _ = done.send(event);
        });
        match thread {
            Ok(_) => {
                let _ = hand_over.send(otherwise);
            }
            Err(_) => self.tell(otherwise),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use app_core::Core;
    use app_core::preset::Preset;

    use super::*;
    use crate::tests::Desk;

    #[test]
    fn a_thread_that_panics_is_told() {
        let toy = bundled_toy().expect("the bundled toy");
        let live = Live::new(Core::counting(), toy, Preset::Balanced);
        let mut shell = Shell::new(live, Desk::default(), Feed::new(None));
        shell.on_thread("panics", ShellEvent::Aligned(None), || panic!("planted"));
        let told = shell.done.1.recv_timeout(Duration::from_secs(60));
        assert!(matches!(told, Ok(ShellEvent::Aligned(None))), "{told:?}");
    }

    #[test]
    fn what_was_written_is_shown_in_the_gallery() {
        let toy = bundled_toy().expect("the bundled toy");
        let live = Live::new(Core::counting(), toy, Preset::Balanced);
        let mut shell = Shell::new(live, Desk::default(), Feed::new(None));
        shell
            .written
            .0
            .send(PathBuf::from("photo_1.png"))
            .expect("a receiver");
        shell.tick();
        assert_eq!(shell.phone.shown, ["photo_1.png"]);
    }
}
