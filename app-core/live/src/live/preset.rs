//! The preset in use: it is compiled, tested, and lowered if it is too slow or too warm.

use std::sync::Arc;

use super::Live;
use crate::app::{GraphicsState, ShellCommand, ShellEvent, Show, WorkCommand};
use crate::self_test;
use app_pipeline::core::CoreError;
use app_pipeline::governor::{BALANCED_QUALITY_LADDER, Exhausted, Governor, LATE, Measured, Thermal};
use app_pipeline::preset::Preset;
use app_scene::toy::Toy;

/// Time for which a phone must be cool before it gets back a preset for which it was too warm.
const COOL_S: f64 = 120.0;

impl Live {
    /// Compiles the next pass. If the device refuses one, the preset counts as one that failed its
    /// test, and nothing more is compiled.
    pub(super) fn compile_next(&mut self) -> Result<(), CoreError> {
        let Some(left) = &mut self.warm_up else {
            return Ok(());
        };
        let tested = match left.next().map(|compiled| compiled.map_err(CoreError::from)) {
            Some(Ok(_)) => return Ok(()),
            Some(Err(error)) if error.is_loss() => return Err(error),
            Some(Err(error)) => self
                .app
                .self_tested(&self.tested_device(), Err(error.to_string())),
            None => {
                self.n_warm_ups = self.n_warm_ups.saturating_add(1);
                self.test_device()
            }
        };
        self.warm_up = None;
        self.owed.extend(tested.map(ShellCommand::from));
        let commands = self.app.event(ShellEvent::Graphics(GraphicsState::Ready));
        self.owed.extend(commands);
        Ok(())
    }

    /// Changes to another preset if the app wants one.
    pub(super) fn follow_preset(&mut self) -> Vec<ShellCommand> {
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
    pub(super) fn govern_preset(&mut self) {
        let target_fps = self.target_fps.filter(|_| self.preset == Preset::Balanced);
        self.governor = target_fps.map(|fps| Governor::new(BALANCED_QUALITY_LADDER, fps));
    }

    /// Makes the device draw its test picture, once for each driver and version of this crate.
    fn test_device(&mut self) -> Option<WorkCommand> {
        let device = self.tested_device();
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

    /// Name of the device in its test.
    fn tested_device(&self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        format!("{version} {} {}", self.preset, self.core.adapter_name())
    }

    /// Reduces or restores settings by the duration of pictures while the toy moves.
    pub(super) fn govern(&mut self, time_s: f64) -> Result<(), CoreError> {
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
}
