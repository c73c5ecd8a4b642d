//! The times of the latest frames, as an app's own profile.

use serde_json::{Value, json};

use crate::core::{Core, CoreError};
use crate::frame::{Clock, FrameInput, FrameReport, PassTime};
use crate::governor::{Governor, Heat};
use crate::profile::{About, Args, Frame, Profile};

/// Frames that are kept, twice as many at most: some seconds.
const N_FRAMES: usize = 300;

/// Times frames, once the shell has lent a clock.
#[derive(Debug, Default)]
pub(super) struct Profiler {
    clock: Option<Clock>,
    profile: Option<Profile>,
    times_passes: bool,
    n_frames: u64,
    before_ms: Option<f64>,
    /// Of the latest frame: on the processor and, where that is known, on the device.
    latest_ms: Option<(f64, Option<f64>)>,
}

impl Profiler {
    pub(super) fn time_by(&mut self, clock: Clock, core: &mut Core) {
        core.time_stages(Some(clock.clone()));
        self.clock = Some(clock);
    }

    /// Another device knows nothing of clocks.
    pub(super) fn reopen(&mut self, core: &mut Core) {
        core.time_stages(self.clock.clone());
        self.times_passes = false;
    }

    /// Makes a frame, and keeps what it took. Passes are timed where they are shown: the processor waits for the device then.
    pub(super) fn frame(
        &mut self,
        (core, input): (&mut Core, &FrameInput),
        shows_times: bool,
        about: impl FnOnce(&Core) -> (About, Args),
    ) -> Result<FrameReport, CoreError> {
        let Some(clock) = &self.clock else {
            return core.frame(input);
        };
        if shows_times != self.times_passes {
            core.time_passes(shows_times)?;
            self.times_passes = shows_times;
        }
        let begin_ms = clock.now_ms();
        let report = core.frame(input)?;
        let cpu_ms = clock.now_ms() - begin_ms;
        let pass_times = core.read_pass_times()?;
        let (about, args) = about(core);
        let args = Args {
            number: Some(self.n_frames),
            kind: report.change.map(|change| change.name().to_owned()),
            interval_ms: self.before_ms.map(|before_ms| begin_ms - before_ms),
            ..args
        };
        self.n_frames += 1;
        self.before_ms = Some(begin_ms);
        let gpu_ms = (!pass_times.is_empty()).then(|| sum_ms(&pass_times));
        self.latest_ms = Some((cpu_ms, gpu_ms));
        let frame = Frame {
            begin_ms,
            cpu_ms,
            pass_times: &pass_times,
            args,
            ..Frame::default()
        };
        let kept = self.profile.take().filter(|kept| kept.is_about(&about));
        let profile = self.profile.insert(kept.unwrap_or_else(|| Profile::new(about)));
        profile.add(&report, frame);
        if profile.n_frames() >= 2 * N_FRAMES {
            profile.keep_latest(N_FRAMES);
        }
        Ok(report)
    }

    /// The times of the latest frames.
    pub(super) fn profile(&self) -> Option<&Profile> {
        self.profile.as_ref()
    }

    /// Of the latest frame, for a recording.
    pub(super) fn latest(&self) -> Option<Value> {
        let (cpu_ms, gpu_ms) = self.latest_ms?;
        Some(json!({ "cpu_ms": cpu_ms, "gpu_ms": gpu_ms }))
    }

    /// Of the latest frame, in words.
    pub(super) fn words(&self) -> Option<String> {
        let (cpu_ms, gpu_ms) = self.latest_ms?;
        let device = gpu_ms.map_or(String::new(), |gpu_ms| format!(", device {gpu_ms:.1} ms"));
        Some(format!("processor {cpu_ms:.1} ms{device}"))
    }
}

/// What a frame's scope has of heat and settings.
pub(super) fn args(heat: Heat, governor: Option<&Governor>) -> Args {
    let turned_down = governor.iter().flat_map(|governor| governor.turned_down());
    Args {
        heat: Some(format!("{heat:?}")),
        turned_down: turned_down.map(|step| step.what.to_owned()).collect(),
        ..Args::default()
    }
}

fn sum_ms(times: &[PassTime]) -> f64 {
    times.iter().map(|time| time.gpu_ms).sum()
}
