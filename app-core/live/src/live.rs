//! An app with its picture: its logic, its interface and the core that draws both.
//!
//! A shell owns one [`Live`]. It passes on the platform's reports and touches, requests a picture
//! whenever the screen wants one, and executes the returned commands.

mod preset;
mod profiler;
mod screen_reader;

use std::sync::Arc;

use wgpu::LoadOp;

use crate::app::{App, ShellCommand, ShellEvent, Show, Translated};
use crate::interface::{Interface, Painter, Painting, Screen, Touch};
use app_pipeline::core::{Canvas, Core, CoreError, WarmUp};
use app_pipeline::frame::{Clock, Warning};
use app_pipeline::governor::{Exhausted, Governor};
use app_pipeline::gpu::ShaderTexts;
use app_pipeline::preset::Preset;
use app_pipeline::profile::{About, Profile};
use app_scene::camera_frame::Display;
use app_scene::scene::{Image, Scene};
use app_scene::toy::Toy;

use profiler::Profiler;

/// An app on a device.
pub struct Live {
    app: App,
    interface: Interface,
    core: Core,
    /// The shell's choice.
    chosen: Preset,
    /// The preset in use.
    preset: Preset,
    /// Remaining compilation: one pass per picture.
    warm_up: Option<WarmUp>,
    painter: Option<Painter>,
    /// The core's scene for the preset.
    scene: Option<Arc<Scene>>,
    display: Display,
    warnings: Vec<Warning>,
    /// Commands of pictures that failed: the shell gets them with the next call.
    owed: Vec<ShellCommand>,
    /// Target frame rate.
    target_fps: Option<u32>,
    governor: Option<Governor>,
    /// The reason why `fast` replaces `balanced`: the whole quality ladder was not enough.
    lowered: Option<Exhausted>,
    /// The toy at that time.
    lowered_toy: Option<Arc<Toy>>,
    /// Seconds for which a phone that was too warm has been cool.
    cool_s: f64,
    profiler: Profiler,
    n_warm_ups: u32,
    /// Time of the latest picture.
    time_s: f64,
}

impl Live {
    /// An app that draws with `core`, and with an initial toy.
    #[must_use]
    pub fn new(core: Core, toy: Arc<Toy>, preset: Preset) -> Self {
        Self {
            app: App::new(toy),
            interface: Interface::default(),
            warm_up: Some(core.warm_up(preset)),
            core,
            chosen: preset,
            preset,
            painter: None,
            scene: None,
            display: Display::default(),
            warnings: Vec::new(),
            owed: Vec::new(),
            target_fps: None,
            governor: None,
            lowered: None,
            lowered_toy: None,
            cool_s: 0.0,
            profiler: Profiler::default(),
            n_warm_ups: 0,
            time_s: 0.0,
        }
    }

    /// Sets the target frame rate: settings of preset `balanced` are reduced if pictures take too
    /// long, and finally `fast` replaces it; the other presets stay unchanged.
    pub fn set_target_fps(&mut self, fps: u32) {
        self.target_fps = Some(fps);
        self.govern_preset();
    }

    /// Times frames by a clock of the shell's from now on: for [`Live::times`], for the display of
    /// times, and for recordings.
    pub fn set_clock(&mut self, clock: Clock) {
        self.profiler.set_clock(clock, &mut self.core);
    }

    /// The times of the latest frames in which the toy moved; `None` without a clock.
    #[must_use]
    pub fn times(&self) -> Option<&Profile> {
        self.profiler.profile()
    }

    /// Continues with another device after the previous one was lost.
    pub fn reopen(&mut self, mut core: Core) {
        self.warm_up = Some(core.warm_up(self.preset));
        self.profiler.reopen(&mut core);
        self.core = core;
        self.painter = None;
        // Another device has none of its textures.
        self.interface = Interface::default();
        self.scene = None;
    }

    /// Like [`Core::replace_shaders`]; the scene is set again with the next picture. With shaders
    /// other than the built-in ones the device draws no test picture. A core that is
    /// [reopened](Live::reopen) begins with the built-in ones.
    ///
    /// # Errors
    /// If the device refuses a pass: shaders and picture then stay unchanged.
    pub fn replace_shaders(&mut self, texts: ShaderTexts) -> Result<(), CoreError> {
        self.core.replace_shaders(texts)?;
        self.scene = None;
        Ok(())
    }

    /// Starts the time of a picture before [`Live::present`], for a shell that first does other
    /// work for it, such as reading the camera's picture.
    pub fn begin_picture(&mut self) {
        self.profiler.begin_early();
    }

    /// Processes an event, and returns the resulting commands.
    #[must_use]
    pub fn event(&mut self, event: ShellEvent) -> Vec<ShellCommand> {
        if let ShellEvent::Frame(frame) = &event {
            self.profiler.deliver(frame);
        }
        let mut commands = std::mem::take(&mut self.owed);
        commands.extend(self.app.event(event));
        commands
    }

    /// Processes a touch, or a mouse in its place.
    pub fn touch(&mut self, touch: Touch) {
        self.interface.touch(touch);
    }

    /// A mouse's wheel, in steps.
    pub fn wheel(&mut self, steps: f64) {
        self.interface.wheel(steps);
    }

    /// Draws on the core's surface at `time_s`, which must increase from call to call, and returns
    /// the resulting commands. If the toy's picture fails for another reason than a loss, the
    /// camera's is drawn, and the person is told.
    ///
    /// # Errors
    /// If the surface or the device is lost: a shell then reports
    /// [`GraphicsState::Lost`](crate::app::GraphicsState::Lost) and supplies another core. The
    /// commands come with the next call.
    pub fn present(&mut self, screen: &Screen, time_s: f64) -> Result<Vec<ShellCommand>, CoreError> {
        let painting = self.prepare(screen, time_s)?;
        let (painter, interface) = (&mut self.painter, &mut self.interface);
        self.core.present_with(self.display, |canvas| {
            paint(painter, interface, canvas, &painting, LoadOp::Load);
        })?;
        self.profiler.presented();
        Ok(std::mem::take(&mut self.owed))
    }

    /// The same on a target of the caller's, whose format stores sRGB codes unchanged.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn draw_on(
        &mut self,
        target: &wgpu::Texture,
        screen: &Screen,
        time_s: f64,
    ) -> Result<Vec<ShellCommand>, CoreError> {
        let painting = self.prepare(screen, time_s)?;
        let below = match self.core.draw_on(target, self.display) {
            Ok(()) => LoadOp::Load,
            Err(CoreError::NoScene) => LoadOp::Clear(wgpu::Color::BLACK),
            Err(error) => return Err(error),
        };
        // Nothing is painted if costs are only counted.
        if let Some(canvas) = self.core.canvas(target) {
            paint(&mut self.painter, &mut self.interface, &canvas, &painting, below);
        }
        Ok(std::mem::take(&mut self.owed))
    }

    /// The same on an off-screen target, whose picture is returned.
    ///
    /// # Errors
    /// If the device is lost.
    pub fn screenshot(
        &mut self,
        screen: &Screen,
        time_s: f64,
    ) -> Result<(Image, Vec<ShellCommand>), CoreError> {
        let target = self
            .core
            .hidden_screen(screen.size_px)
            .ok_or(CoreError::NoScene)?;
        self.owed = self.draw_on(&target, screen, time_s)?;
        let image = self.core.read_screen(&target)?;
        Ok((image, std::mem::take(&mut self.owed)))
    }

    /// The finished picture without the interface.
    ///
    /// # Errors
    /// As [`Core::read_picture`].
    pub fn read_picture(&self) -> Result<Image, CoreError> {
        self.core.read_picture()
    }

    /// The phone's own way back, such as a button or a gesture. Returns the commands; `None` if it
    /// leaves the app.
    #[must_use]
    pub fn back(&mut self) -> Option<Vec<ShellCommand>> {
        if self.interface.close_menu() {
            return Some(Vec::new());
        }
        let action = self.app.back()?;
        Some(self.event(ShellEvent::User(action)))
    }

    /// Shows this text on the first screen, as required by the terms of the platform's services.
    pub fn disclose(&mut self, words: Translated) {
        self.app.disclose(words);
    }

    /// Frame rate worth drawing: the target, or less if the governor has reduced it; `None` without
    /// a target.
    #[must_use]
    pub fn frames_per_s(&self) -> Option<u32> {
        let governed = self.governor.as_ref().map(Governor::frames_per_second);
        governed.or(self.target_fps)
    }

    /// Number of times that all passes of a preset were compiled: if it has grown, so has the
    /// content of the driver's cache.
    #[must_use]
    pub fn n_warm_ups(&self) -> u32 {
        self.n_warm_ups
    }

    /// The core.
    #[must_use]
    pub fn core(&self) -> &Core {
        &self.core
    }

    /// The preset in use.
    #[must_use]
    pub fn preset(&self) -> Preset {
        self.preset
    }

    /// The logic.
    #[must_use]
    pub fn app(&self) -> &App {
        &self.app
    }

    /// The core, for setting or removing its surface.
    pub fn core_mut(&mut self) -> &mut Core {
        &mut self.core
    }

    /// The core's warnings for the latest frame.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Processes the person's input to the interface, and makes the picture below it. The commands
    /// are owed to the shell.
    fn prepare(&mut self, screen: &Screen, time_s: f64) -> Result<Painting, CoreError> {
        self.profiler.begin_picture();
        let commands = self.follow_preset();
        self.owed.extend(commands);
        self.compile_next()?;
        let profile = self.profile();
        let (actions, painting) = self.interface.run(&self.app, screen, time_s, &profile);
        for action in actions {
            let commands = self.app.event(ShellEvent::User(action));
            self.owed.extend(commands);
        }
        let made = self.govern(time_s).and_then(|()| self.make_picture());
        match made {
            Ok(true) => self.owed.extend(self.app.drawn().map(ShellCommand::from)),
            Ok(false) => {}
            Err(error) if error.is_loss() => return Err(error),
            Err(error) => self.show_camera_for(&error)?,
        }
        Ok(painting)
    }

    /// Draws the camera's picture in place of the toy's, which failed on a device that works.
    fn show_camera_for(&mut self, error: &CoreError) -> Result<(), CoreError> {
        if matches!(error, CoreError::Gpu(_)) {
            // It may have been refused in the middle of its work.
            self.scene = None;
        }
        let commands = self.app.event(ShellEvent::PictureFailed(error.to_string()));
        self.owed.extend(commands);
        match self.make_picture() {
            Err(error) if error.is_loss() => Err(error),
            // Not even the camera's picture can be drawn: the interface is.
            Ok(_) | Err(_) => Ok(()),
        }
    }

    /// Returns whether the picture is one of the moving toy.
    fn make_picture(&mut self) -> Result<bool, CoreError> {
        match self.app.show() {
            Show::Nothing => self.profiler.interrupt(),
            Show::Camera(frame) => {
                self.profiler.interrupt();
                self.display = frame.display;
                self.core.show_camera(&frame.image)?;
            }
            Show::Toy {
                scene,
                input,
                display,
            } => {
                self.display = display;
                if !self.scene.as_ref().is_some_and(|set| Arc::ptr_eq(set, scene)) {
                    self.scene = None;
                    self.core.set_scene(Arc::clone(scene), self.preset)?;
                    self.scene = Some(Arc::clone(scene));
                    if let Some(governor) = &self.governor {
                        self.core.set_quality_reductions(governor.quality_reductions())?;
                    }
                }
                let (preset, app) = (self.preset, &self.app);
                let about = |core: &Core| {
                    let about = About {
                        session: "live".to_owned(),
                        preset: preset.name().to_owned(),
                        device: core.adapter_name(),
                        picture_px: input.image.size_px(),
                        ..About::default()
                    };
                    (about, profiler::args(app.thermal(), self.governor.as_ref()))
                };
                let frame = (&mut self.core, &*input);
                let report = self.profiler.frame(frame, app.shows_profile(), about)?;
                self.warnings = report.warnings;
                if let Some(times) = self.profiler.latest() {
                    self.app.record_profile(&times);
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn profile(&self) -> String {
        let mut lines = format!("{} {:?}", self.preset, self.app.thermal());
        if let Some(words) = self.profiler.words() {
            lines.push('\n');
            lines.push_str(&words);
        }
        for step in self.governor.iter().flat_map(Governor::quality_reductions) {
            lines.push('\n');
            lines.push_str(step.what);
        }
        for warning in &self.warnings {
            lines.push('\n');
            lines.push_str(&warning.to_string());
        }
        lines
    }
}

impl std::fmt::Debug for Live {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Live")
            .field("app", &self.app)
            .finish_non_exhaustive()
    }
}

fn paint(
    painter: &mut Option<Painter>,
    interface: &mut Interface,
    canvas: &Canvas<'_>,
    painting: &Painting,
    below: LoadOp<wgpu::Color>,
) {
    let painter = painter.get_or_insert_with(|| Painter::new(canvas));
    painter.paint(canvas, (painting, &interface.take_textures()), below);
}
