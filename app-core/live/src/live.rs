//! An app with its picture: its logic, its interface and the core that draws both.
//!
//! A shell owns one [`Live`]. It passes on the platform's reports and touches, requests a picture
//! whenever the screen wants one, and executes the returned commands.

mod profiler;
mod screen_reader;

use std::sync::Arc;

use wgpu::LoadOp;

use crate::app::{App, GraphicsState, ShellCommand, ShellEvent, Show, Translated, WorkCommand};
use crate::interface::{Interface, Painter, Painting, Screen, Touch};
use crate::self_test;
use app_pipeline::core::{Canvas, Core, CoreError, WarmUp};
use app_pipeline::frame::{Clock, Warning};
use app_pipeline::governor::{BALANCED_QUALITY_LADDER, Exhausted, Governor, LATE, Measured, Thermal};
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

/// Time for which a phone must be cool before it gets back a preset for which it was too warm.
const COOL_S: f64 = 120.0;

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
        self.app.event(event)
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
    /// the resulting commands.
    ///
    /// # Errors
    /// If the surface or the device is lost: a shell then reports [`GraphicsState::Lost`] and
    /// supplies another core.
    pub fn present(&mut self, screen: &Screen, time_s: f64) -> Result<Vec<ShellCommand>, CoreError> {
        let (commands, painting) = self.prepare(screen, time_s)?;
        let (painter, interface) = (&mut self.painter, &mut self.interface);
        self.core.present_with(self.display, |canvas| {
            paint(painter, interface, canvas, &painting, LoadOp::Load);
        })?;
        self.profiler.presented();
        Ok(commands)
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
        let (commands, painting) = self.prepare(screen, time_s)?;
        let below = match self.core.draw_on(target, self.display) {
            Ok(()) => LoadOp::Load,
            Err(CoreError::NoScene) => LoadOp::Clear(wgpu::Color::BLACK),
            Err(error) => return Err(error),
        };
        // Nothing is painted if costs are only counted.
        if let Some(canvas) = self.core.canvas(target) {
            paint(&mut self.painter, &mut self.interface, &canvas, &painting, below);
        }
        Ok(commands)
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
        let commands = self.draw_on(&target, screen, time_s)?;
        let image = self.core.read_screen(&target)?;
        Ok((image, commands))
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
        Some(self.app.event(ShellEvent::User(action)))
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

    /// Processes the person's input to the interface, and makes the picture below it.
    fn prepare(&mut self, screen: &Screen, time_s: f64) -> Result<(Vec<ShellCommand>, Painting), CoreError> {
        self.profiler.begin_picture();
        let mut commands = self.follow_preset();
        commands.extend(self.compile_next()?);
        let profile = self.profile();
        let (actions, painting) = self.interface.run(&self.app, screen, time_s, &profile);
        for action in actions {
            commands.extend(self.app.event(ShellEvent::User(action)));
        }
        self.govern(time_s)?;
        if self.make_picture()? {
            commands.extend(self.app.drawn().map(ShellCommand::from));
        }
        Ok((commands, painting))
    }

    fn compile_next(&mut self) -> Result<Vec<ShellCommand>, CoreError> {
        let Some(left) = &mut self.warm_up else {
            return Ok(Vec::new());
        };
        if let Some(compiled) = left.next() {
            compiled?;
            return Ok(Vec::new());
        }
        self.warm_up = None;
        self.n_warm_ups = self.n_warm_ups.saturating_add(1);
        let mut commands: Vec<_> = self.test_device().map(ShellCommand::from).into_iter().collect();
        commands.extend(self.app.event(ShellEvent::Graphics(GraphicsState::Ready)));
        Ok(commands)
    }

    /// Changes to another preset if the app wants one.
    fn follow_preset(&mut self) -> Vec<ShellCommand> {
        let is_same_toy = |toy: &Arc<Toy>| Arc::ptr_eq(toy, self.app.toy());
        if self.lowered == Some(Exhausted::Slow) && !self.lowered_toy.as_ref().is_some_and(is_same_toy) {
            // Another toy may be cheaper.
            self.lowered = None;
            self.govern_preset();
        }
        let is_exchanged = self.lowered.is_some() && !self.app.is_for_engineers();
        let is_lowered = is_exchanged && self.chosen == Preset::Balanced;
        let preset = self
            .app
            .preset(if is_lowered { Preset::Fast } else { self.chosen });
        if preset == self.preset {
            return Vec::new();
        }
        self.preset = preset;
        self.warm_up = Some(self.core.warm_up(preset));
        self.scene = None;
        self.govern_preset();
        self.app.event(ShellEvent::Graphics(GraphicsState::Starting))
    }

    /// Creates the governor of the preset in use.
    fn govern_preset(&mut self) {
        let target_fps = self.target_fps.filter(|_| self.preset == Preset::Balanced);
        self.governor = target_fps.map(|fps| Governor::new(BALANCED_QUALITY_LADDER, fps));
    }

    /// Makes the device draw its test picture, once for each driver and version of this crate.
    fn test_device(&mut self) -> Option<WorkCommand> {
        let version = env!("CARGO_PKG_VERSION");
        let device = format!("{version} {} {}", self.preset, self.core.adapter_name());
        let is_usual = self.core.device().is_some() && self.core.has_built_in_shaders();
        if !is_usual || !self.app.wants_self_test(&device) {
            return None;
        }
        let tested = self_test::run(&mut self.core, self.preset);
        self.scene = None;
        let words = match &tested {
            Ok(off) => format!(
                "{:.2} codes off in its worst block, {:.3} on average",
                off.worst_codes, off.mean_codes
            ),
            Err(error) => error.to_string(),
        };
        self.app.note_self_test(&words);
        let outcome = tested.map(|_| ()).map_err(|error| error.to_string());
        self.app.self_tested(&device, outcome)
    }

    /// Reduces or restores settings by the duration of pictures while the toy moves.
    fn govern(&mut self, time_s: f64) -> Result<(), CoreError> {
        let interval_ms = 1e3 * (time_s - self.time_s);
        self.cool_down(time_s - self.time_s);
        self.time_s = time_s;
        let shown_fps = self
            .app
            .frames_per_s()
            .min(self.frames_per_s().unwrap_or(u32::MAX));
        // The device may be fast although not all pictures of the camera are shown.
        let is_late = self.profiler.has_dropped() && interval_ms > LATE * 1e3 / f64::from(shown_fps.max(1));
        let is_moving = self.scene.is_some() && matches!(self.app.show(), Show::Toy { .. });
        let Some(governor) = self.governor.as_mut().filter(|_| is_moving) else {
            return Ok(());
        };
        let turned = governor.take(&Measured {
            gpu_ms: self.profiler.gpu_ms(),
            // A shell that draws one picture per camera picture waits for the camera; that time is
            // not the device's.
            interval_ms: self
                .profiler
                .busy_ms()
                .filter(|_| !is_late)
                .unwrap_or(interval_ms),
            thermal: self.app.thermal(),
        });
        if let Some(exhausted) = governor.exhausted().filter(|_| self.lowered.is_none()) {
            self.lowered = Some(exhausted);
            self.lowered_toy = Some(Arc::clone(self.app.toy()));
            self.app.note_lowered(exhausted);
        }
        if turned.is_some() {
            self.core.set_quality_reductions(governor.quality_reductions())?;
        }
        Ok(())
    }

    /// Returns to the chosen preset, if heat alone has lowered it and has passed.
    fn cool_down(&mut self, elapsed_s: f64) {
        let is_cooling = self.lowered == Some(Exhausted::Warm) && self.app.thermal() == Thermal::Nominal;
        self.cool_s = if is_cooling { self.cool_s + elapsed_s } else { 0.0 };
        if self.cool_s >= COOL_S {
            self.lowered = None;
            self.cool_s = 0.0;
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
