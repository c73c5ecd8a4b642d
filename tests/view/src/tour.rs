//! A tour through every screen of the app by a simulated person: the screens are written as
//! pictures.

use std::path::{Path, PathBuf};
use std::time::Instant;

use app_core::app::{Permission, PhoneQuestion, Placing, ShellEvent, Step};
use app_core::core::CoreError;
use app_core::interface::{Screen, Touch, TouchPhase};
use glam::{DVec2, DVec3};
use thiserror::Error;

use super::desktop::Desk;
use super::fault::Fault;
use desk::output::{WriteError, make_folder, write_png};

/// Time between two frames, in seconds.
const FRAME_S: f64 = 1.0 / 30.0;
/// Number of frames until a screen is stable: menus open, messages appear.
const N_SETTLE: usize = 4;
/// Number of frames to wait for a step.
const N_PATIENCE: usize = 60;
/// Number of recorded frames, which the screens meanwhile take.
const N_RECORDED: usize = 24;
/// Frames of a video.
const N_VIDEO: usize = 15;
/// Number of frames after which the search for the toy has failed.
const N_SEARCHED: usize = 150;
/// Number of drags after which a button that is still out of sight is touched at its place.
const N_SCROLLS: usize = 6;
/// A shorter drag counts as a touch, in points.
const LEAST_DRAG_POINTS: f64 = 16.0;
/// Free margin of a sheet below its controls, in points.
const SHEET_MARGIN_POINTS: f64 = 28.0;

/// A tour that ended early.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TourError {
    /// The core refused.
    #[error(transparent)]
    Core(#[from] CoreError),
    /// A picture cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A button is missing.
    #[error("at {at}: no button «{label}»; there are {found:?}")]
    NoButton {
        /// The step.
        at: String,
        /// The label.
        label: String,
        /// The existing buttons.
        found: Vec<String>,
    },
    /// The toy that was put down was not found.
    #[error("the toy was not found: {0:?}")]
    NotFound(Placing),
    /// The app is at the wrong step.
    #[error("after {after}: the step is {is:?}, not {expected:?}")]
    Astray {
        /// The last action.
        after: String,
        /// The present step.
        is: Step,
        /// The expected step.
        expected: Step,
    },
}

/// A person on a tour, with a screen.
pub struct Tour<'a> {
    desk: &'a mut Desk,
    screen: Screen,
    out: PathBuf,
    time_s: f64,
    n_touches: u32,
    written: Vec<PathBuf>,
}

/// The straight way from the first screen to the toy that moves.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Touches of the screen.
    pub n_touches: u32,
    /// Time of the camera's pictures until then, in seconds: a thread's work takes none of it here.
    pub camera_s: f64,
    /// Time of threads and pictures on this machine, in seconds: from putting down the toy to the
    /// first ghost, from there to the end of the search, and from there to the moving toy.
    pub machine_s: [f64; 3],
}

impl<'a> Tour<'a> {
    /// A person who has just opened the app.
    ///
    /// # Errors
    /// When `out` cannot be made.
    pub fn new(desk: &'a mut Desk, screen: Screen, out: &Path) -> Result<Self, TourError> {
        make_folder(out)?;
        desk.tell(ShellEvent::Foreground(true));
        desk.tell(ShellEvent::Surface(Some(screen.size_px)));
        Ok(Self {
            desk,
            screen,
            out: out.to_owned(),
            time_s: 0.0,
            n_touches: 0,
            written: Vec::new(),
        })
    }

    /// Makes the whole tour, and returns the pictures in their order.
    ///
    /// # Errors
    /// When the app reaches a wrong step.
    pub fn go(mut self) -> Result<Vec<PathBuf>, TourError> {
        self.welcome()?;
        self.find_table()?;
        self.take_plate()?;
        self.place_toy()?;
        self.play()?;
        self.faults()?;
        Ok(self.written)
    }

    /// Takes the shortest way to the moving toy.
    ///
    /// # Errors
    ///
    /// When the app does not go where it should.
    pub fn straight(mut self) -> Result<Way, TourError> {
        self.desk.answer = Permission::Granted;
        self.shoot_nothing()?;
        self.press("Begin")?;
        // A device compiles while the person looks around.
        for _ in 0..N_PATIENCE {
            if self.button("Here").is_ok() {
                break;
            }
            self.frame()?;
        }
        self.press("Here")?;
        self.wait_for(Step::PlaceToy, "the place was photographed")?;
        let mut since = Instant::now();
        let mut lap_s = || {
            std::mem::replace(&mut since, Instant::now())
                .elapsed()
                .as_secs_f64()
        };
        let mut machine_s = [0.0; 3];
        self.desk.feed.is_toy_there = true;
        self.search(|placing| matches!(placing, Placing::Asked { .. }))?;
        machine_s[0] = lap_s();
        self.search(|placing| placing == Placing::Asked { is_searching: false })?;
        machine_s[1] = lap_s();
        self.press("Yes")?;
        self.wait_for(Step::Play, "the toy was found")?;
        machine_s[2] = lap_s();
        Ok(Way {
            n_touches: self.n_touches,
            camera_s: self.time_s,
            machine_s,
        })
    }

    /// Waits until the search is so far.
    fn search(&mut self, is_so_far: impl Fn(Placing) -> bool) -> Result<(), TourError> {
        for _ in 0..N_SEARCHED {
            if is_so_far(self.desk.live.app().placing()) {
                return Ok(());
            }
            self.frame()?;
        }
        Err(TourError::NotFound(self.desk.live.app().placing()))
    }

    fn welcome(&mut self) -> Result<(), TourError> {
        self.shoot("welcome")?;
        self.desk.answer = Permission::Denied;
        self.press("Begin")?;
        self.shoot("camera_denied")?;
        self.desk.tell(ShellEvent::Permission(Permission::Barred));
        self.shoot("camera_barred")?;
        self.desk.tell(ShellEvent::Permission(Permission::Denied));
        self.desk.answer = Permission::Granted;
        self.shoot_nothing()?;
        self.press("Allow the camera")?;
        self.wait_for(Step::FindTable, "the camera was allowed")
    }

    fn find_table(&mut self) -> Result<(), TourError> {
        // A device compiles while the person looks around.
        for _ in 0..N_PATIENCE {
            self.frame()?;
        }
        for fault in [Fault::TooFast, Fault::TooPlain, Fault::TooDark] {
            self.during(fault)?;
        }
        self.shoot("find_table")?;
        self.check_phone()?;
        let at = self.toy_px(DVec3::ZERO);
        self.desk.feed.hides_planes = true;
        self.frame()?;
        self.tap(at)?;
        self.shoot("no_table_there")?;
        self.desk.feed.hides_planes = false;
        self.frame()?;
        self.tap(at)?;
        self.frame()?;
        self.expect(Step::TakePlate, "the table was tapped")
    }

    /// All questions of a new phone.
    fn check_phone(&mut self) -> Result<(), TourError> {
        self.press("Check this phone")?;
        for number in 1..=PhoneQuestion::ALL.len() {
            self.shoot(&format!("check_{number}"))?;
            self.press(if number == 3 { "No" } else { "Yes" })?;
        }
        self.shoot("checked")
    }

    fn take_plate(&mut self) -> Result<(), TourError> {
        self.shoot("take_plate")?;
        self.wait_for(Step::PlaceToy, "the place was photographed")
    }

    fn place_toy(&mut self) -> Result<(), TourError> {
        self.shoot("put_toy")?;
        self.desk.feed.is_toy_there = true;
        self.search(|placing| matches!(placing, Placing::Asked { .. }))?;
        self.shoot("first_ghost")?;
        self.search(|placing| placing == Placing::Asked { is_searching: false })?;
        self.shoot("asked")?;
        self.press("Turn it")?;
        self.shoot("turned")?;
        self.press("Find it for me")?;
        self.search(|placing| placing == Placing::Asked { is_searching: false })?;
        if self.desk.live.app().sees_card() {
            self.take_lens()?;
        }
        self.press("Yes")?;
        self.frame()?;
        self.expect(Step::Align, "the ghost was placed")?;
        self.shoot("align")?;
        self.desk.align();
        self.wait_for(Step::Play, "the toy was found")
    }

    /// For a session that has a picture of a lens.
    fn take_lens(&mut self) -> Result<(), TourError> {
        // A camera takes some frames to darken.
        self.press("Light from the lens")?;
        self.shoot_nothing()?;
        self.shoot("lens_taken")
    }

    fn play(&mut self) -> Result<(), TourError> {
        self.shoot("fade_in")?;
        for _ in 0..12 {
            self.frame()?;
        }
        self.shoot("play")?;
        self.press("Photo")?;
        self.shoot("photo_saved")?;
        self.press("Pause")?;
        self.shoot("paused")?;
        self.desk.look_into();
        self.desk.wait_for_page();
        self.press("More")?;
        self.shoot("menu")?;
        // Each of these changes the contents of the sheet, and so the places of its buttons.
        for label in ["Show times", "Record the session", "Close", "Play"] {
            self.press(label)?;
            self.shoot_nothing()?;
        }
        self.shoot("times")?;
        self.make_video()?;
        self.record()
    }

    /// A video of half a second.
    fn make_video(&mut self) -> Result<(), TourError> {
        self.press("Video")?;
        for _ in 0..N_VIDEO {
            self.frame()?;
        }
        self.shoot("video")?;
        self.press("End video")?;
        self.shoot_nothing()
    }

    /// Ends the recording after a second, and shares it.
    fn record(&mut self) -> Result<(), TourError> {
        for _ in 0..N_RECORDED {
            self.frame()?;
        }
        self.press("More")?;
        self.shoot_nothing()?;
        self.press("End the recording")?;
        self.desk.wait_for_recording();
        self.shoot("recorded")?;
        self.press("Share log and recording")?;
        self.shoot("shared")?;
        if self
            .desk
            .keeping
            .toy_to_pick
            .as_ref()
            .is_some_and(|path| path.is_dir())
        {
            self.press("Another toy")?;
            self.shoot("choose_toy")?;
            self.press("Back")?;
            self.shoot_nothing()?;
        }
        // A picture is no toy.
        self.desk.keeping.toy_to_pick = self.written.first().cloned();
        self.press("Another toy")?;
        self.shoot("toy_refused")?;
        self.press("Close")?;
        Ok(())
    }

    fn faults(&mut self) -> Result<(), TourError> {
        for fault in [
            Fault::Relocalising,
            Fault::Interrupted,
            Fault::Hot,
            Fault::DeviceLost,
            Fault::ArFailed,
        ] {
            self.during(fault)?;
        }
        let _ = Fault::NewWorld.strikes(&mut self.desk.feed);
        self.wait_for(Step::FindTable, "the world was lost")?;
        self.shoot("new_world")?;
        self.during(Fault::NoAr)
    }

    /// The screen during a fault, until it has passed.
    fn during(&mut self, fault: Fault) -> Result<(), TourError> {
        if let Some(event) = fault.strikes(&mut self.desk.feed) {
            self.desk.tell(event);
        }
        self.shoot(&format!("fault_{fault:?}").to_lowercase())?;
        if let Some(event) = fault.passes(&mut self.desk.feed) {
            self.desk.tell(event);
        }
        for _ in 0..2 * N_SETTLE {
            self.frame()?;
        }
        Ok(())
    }

    /// The image of the toy's origin, moved in the world, in pixels.
    fn toy_px(&self, moved_m: DVec3) -> DVec2 {
        let (world_from_object, camera) = self.desk.feed.toy();
        let at = world_from_object.w_axis.truncate() + moved_m;
        camera.pixel_of(at).unwrap_or(DVec2::ZERO)
    }

    /// Touches a pixel of the camera's picture.
    fn tap(&mut self, pixel: DVec2) -> Result<(), TourError> {
        let (picture_px, display) = self
            .desk
            .live
            .app()
            .picture()
            .unwrap_or(([1, 1], self.desk.feed.display));
        let picture_from_screen = display.image_from_screen(picture_px, self.screen.size_px);
        self.touch(picture_from_screen.inverse().transform_point2(pixel).to_array())
    }

    fn touch(&mut self, at_px: [f64; 2]) -> Result<(), TourError> {
        self.n_touches += 1;
        for phase in [TouchPhase::Began, TouchPhase::Ended] {
            self.desk.live.touch(Touch { id: 1, phase, at_px });
            self.frame()?;
        }
        Ok(())
    }

    /// Touches a button by its accessibility label, after scrolling if needed.
    fn press(&mut self, label: &str) -> Result<(), TourError> {
        for _ in 0..N_SCROLLS {
            let [left, top, right, bottom] = self.button(label)?;
            let height = f64::from(self.screen.size_px[1]);
            let margin_px = SHEET_MARGIN_POINTS * self.screen.pixels_per_point;
            let least_px = LEAST_DRAG_POINTS * self.screen.pixels_per_point;
            let below_px = bottom - (height - margin_px);
            let above_px = margin_px - top;
            let by_px = if below_px > 0.0 {
                below_px.max(least_px).min(0.4 * height)
            } else if above_px > 0.0 {
                -above_px.max(least_px).min(0.25 * height)
            } else {
                break;
            };
            self.drag_up([0.5 * (left + right), 0.7 * height], by_px)?;
        }
        let [left, top, right, bottom] = self.button(label)?;
        self.touch([0.5 * (left + right), 0.5 * (top + bottom)])
    }

    /// Scrolls the contents below a finger, which then rests for a while so that the scrolling
    /// stops.
    fn drag_up(&mut self, [x, y]: [f64; 2], by_px: f64) -> Result<(), TourError> {
        let phases = [
            (TouchPhase::Began, 0.0),
            (TouchPhase::Moved, 0.5),
            (TouchPhase::Moved, 1.0),
            (TouchPhase::Moved, 1.0),
            (TouchPhase::Moved, 1.0),
            (TouchPhase::Ended, 1.0),
        ];
        for (phase, part) in phases {
            let at_px = [x, y - part * by_px];
            self.desk.live.touch(Touch { id: 1, phase, at_px });
            self.frame()?;
        }
        self.shoot_nothing()
    }

    /// Left, top, right and bottom of a button, in pixels.
    fn button(&self, label: &str) -> Result<[f64; 4], TourError> {
        let widgets = self.desk.live.widgets();
        let button = widgets
            .iter()
            .find(|widget| widget.label == label && widget.role == "Button");
        let Some(button) = button else {
            let buttons = widgets.iter().filter(|widget| widget.role == "Button");
            return Err(TourError::NoButton {
                at: format!("{:?}", self.desk.live.app().step()),
                label: label.to_owned(),
                found: buttons.map(|widget| widget.label.clone()).collect(),
            });
        };
        Ok(button.bounds_px)
    }

    fn wait_for(&mut self, step: Step, after: &str) -> Result<(), TourError> {
        for _ in 0..N_PATIENCE {
            if self.desk.live.app().step() == step {
                return Ok(());
            }
            self.frame()?;
            self.desk.align();
        }
        self.expect(step, after)
    }

    fn expect(&self, expected: Step, after: &str) -> Result<(), TourError> {
        let is = self.desk.live.app().step();
        let after = after.to_owned();
        if is == expected {
            Ok(())
        } else {
            Err(TourError::Astray { after, is, expected })
        }
    }

    fn frame(&mut self) -> Result<(), TourError> {
        self.time_s += FRAME_S;
        self.desk.tick(FRAME_S);
        self.desk.screenshot(&self.screen, self.time_s)?;
        Ok(())
    }

    fn shoot_nothing(&mut self) -> Result<(), TourError> {
        for _ in 0..N_SETTLE {
            self.frame()?;
        }
        Ok(())
    }

    /// Writes the screen as a picture.
    fn shoot(&mut self, name: &str) -> Result<(), TourError> {
        self.shoot_nothing()?;
        self.time_s += FRAME_S;
        let image = self.desk.screenshot(&self.screen, self.time_s)?;
        let path = self.out.join(format!("{:02}_{name}.png", self.written.len()));
        write_png(&path, &image)?;
        self.written.push(path);
        Ok(())
    }
}
