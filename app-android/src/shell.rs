//! The shell: what the app asks for is done, and what happens is told. All but Android itself, so that it runs in tests.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use app_core::app::{AlignJob, Device, Saved, ShellCommand, ShellEvent};
use app_core::interface::Screen;
use app_core::live::Live;
use app_core::toy::{Toy, ToyError};

use crate::arcore::feed::Feed;
use crate::arcore::tracker::{Geometry, Run};
use crate::phone::Phone;
use crate::save;

/// `Surface.ROTATION_90`: the manifest keeps the activity in landscape.
const LANDSCAPE: i32 = 1;

/// The toy that the app comes with: the bundled session's, this project's own.
///
/// # Errors
/// If it cannot be read.
pub fn bundled_toy() -> Result<Arc<Toy>, ToyError> {
    let bytes = include_bytes!("../../tests/sessions/llama/toy.glb");
    Ok(Arc::new(Toy::from_glb("toy.glb", bytes)?))
}

/// An app and the phone that it runs on.
pub struct Shell<P> {
    live: Live,
    phone: P,
    feed: Feed,
    /// What other threads tell.
    done: (Sender<ShellEvent>, Receiver<ShellEvent>),
    wants_device: bool,
}

impl<P: Phone> Shell<P> {
    /// A shell that has just been started.
    pub fn new(live: Live, phone: P, feed: Feed) -> Self {
        let mut shell = Self {
            live,
            phone,
            feed,
            done: channel(),
            wants_device: false,
        };
        let event = shell.feed.come_back();
        shell.tell_some(event);
        shell
    }

    /// The app.
    pub fn live(&mut self) -> &mut Live {
        &mut self.live
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
        let event = self.feed.poll(&mut self.phone);
        self.tell_some(event);
    }

    /// Draws on the core's surface. A device or surface that is lost is to be brought anew.
    pub fn present(&mut self, screen: &Screen, time_s: f64) {
        match self.live.present(screen, time_s) {
            Ok(commands) => self.obey(commands),
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

    fn obey(&mut self, commands: Vec<ShellCommand>) {
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
                ShellCommand::Share => {
                    let log = self.live.app().log().text();
                    let saved = self.phone.folder().map_or(Saved::NotAllowed, |folder| {
                        save::bytes(&folder, "log.txt", log.as_bytes())
                    });
                    self.tell(ShellEvent::Saved(saved));
                }
                // Not there yet, and said so.
                ShellCommand::Video(true) | ShellCommand::Record(true) => {
                    self.tell(ShellEvent::Saved(Saved::Failed));
                }
                ShellCommand::PickToy => {
                    let reason = "toys cannot be chosen on Android yet".to_owned();
                    self.tell(ShellEvent::Toy(Err(reason)));
                }
                ShellCommand::Announce(step) => eprintln!("app-android: {step:?}"),
                // ARCore keeps exposure and frame rate to itself.
                ShellCommand::LockExposure(_)
                | ShellCommand::FrameRate(_)
                | ShellCommand::Video(false)
                | ShellCommand::Record(false) => {}
            }
        }
    }

    /// On a thread of its own; one that panics or cannot be started is told as well.
    fn align(&mut self, job: Box<AlignJob>) {
        self.on_thread("align", ShellEvent::Aligned(None), move || {
            ShellEvent::Aligned(Some(Box::new(job.run())))
        });
    }

    fn save_photo(&mut self) {
        let (Ok(picture), Some(folder)) = (self.live.read_picture(), self.phone.folder()) else {
            return self.tell(ShellEvent::Saved(Saved::Failed));
        };
        // A clock that is set before 1970 makes every photo the same file.
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let name = format!("photo_{}.png", since.as_millis());
        self.on_thread("photo", ShellEvent::Saved(Saved::Failed), move || {
            ShellEvent::Saved(save::picture(&folder, &name, &picture))
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
            let event = catch_unwind(AssertUnwindSafe(work)).unwrap_or(otherwise);
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
}
