//! The times of the latest frames, as an app's own profile.

use serde_json::{Value, json};

use app_pipeline::core::{Core, CoreError};
use app_pipeline::frame::{Clock, FrameReport, PassTime};
use app_pipeline::governor::{Governor, Thermal};
use app_pipeline::profile::{About, Args, Frame, Profile};
use app_scene::camera_frame::CameraFrame;
use app_scene::frame::FrameInput;

/// Number of kept frames, at most twice as many: some seconds.
const N_FRAMES: usize = 300;

/// Times frames, once the shell has supplied a clock.
#[derive(Debug, Default)]
pub(super) struct Profiler {
    clock: Option<Clock>,
    profile: Option<Profile>,
    times_passes: bool,
    n_frames: u64,
    before_ms: Option<f64>,
    delivered: Option<Delivered>,
    /// The camera's number of the picture that was shown last.
    shown_id: Option<u64>,
    n_dropped: u64,
    latest: Option<Latest>,
    /// Time at which the shell began work for the next picture.
    early_ms: Option<f64>,
    /// Start of the present picture, and the previous one's duration until it was submitted to the
    /// display.
    begun_ms: Option<f64>,
    busy_ms: Option<f64>,
}

/// A picture of the camera.
#[derive(Clone, Copy, Debug)]
struct Delivered {
    id: u64,
    /// Time of arrival by the shell's clock.
    at_ms: f64,
    /// Its age at that time.
    age_ms: Option<f64>,
}

/// The latest frame.
#[derive(Clone, Copy, Debug)]
struct Latest {
    cpu_ms: f64,
    /// Time on the device, if it was measured.
    gpu_ms: Option<f64>,
    camera_to_present_ms: Option<f64>,
    /// Number of camera pictures before it that were never shown.
    n_dropped: u64,
}

impl Profiler {
    pub(super) fn set_clock(&mut self, clock: Clock, core: &mut Core) {
        core.time_stages(Some(clock.clone()));
        self.clock = Some(clock);
    }

    /// Another device has no timer yet.
    pub(super) fn reopen(&mut self, core: &mut Core) {
        core.time_stages(self.clock.clone());
        self.times_passes = false;
    }

    /// The shell begins work that may result in a picture.
    pub(super) fn begin_early(&mut self) {
        self.early_ms = self.clock.as_ref().map(Clock::now_ms);
    }

    /// A picture begins, unless the shell has reported that before.
    pub(super) fn begin_picture(&mut self) {
        let now_ms = self.clock.as_ref().map(Clock::now_ms);
        self.begun_ms = self.early_ms.take().or(now_ms);
    }

    /// It was submitted to the display: if the device is behind, that took as long as the device
    /// needs for one.
    pub(super) fn presented(&mut self) {
        let now_ms = self.clock.as_ref().map(Clock::now_ms);
        self.busy_ms = now_ms
            .zip(self.begun_ms)
            .map(|(now_ms, begun_ms)| now_ms - begun_ms);
    }

    /// Duration of the latest picture that was submitted to the display; `None` without a clock, or
    /// if there is no such picture.
    pub(super) fn busy_ms(&self) -> Option<f64> {
        self.busy_ms
    }

    /// Whether camera pictures before the latest frame were never shown.
    pub(super) fn has_dropped(&self) -> bool {
        self.latest.is_some_and(|latest| latest.n_dropped > 0)
    }

    /// The device's time for the latest frame, while passes are timed.
    pub(super) fn gpu_ms(&self) -> Option<f64> {
        self.latest?.gpu_ms
    }

    /// A picture of the camera has arrived.
    pub(super) fn deliver(&mut self, frame: &CameraFrame) {
        self.delivered = self.clock.as_ref().map(|clock| Delivered {
            id: frame.stamp.id,
            at_ms: clock.now_ms(),
            age_ms: frame.age_ms,
        });
    }

    /// Something else is shown: the next frame has no predecessor.
    pub(super) fn interrupt(&mut self) {
        self.before_ms = None;
        self.shown_id = None;
    }

    /// Number of camera pictures since the one that was shown last, which will never be shown; 0 if
    /// there is no last one, or if the camera has restarted its count.
    fn drop_before(&mut self, shown_id: u64) -> u64 {
        let before = self.shown_id.replace(shown_id);
        let step = before.and_then(|before| shown_id.checked_sub(before));
        let n_dropped = step.map_or(0, |step| step.saturating_sub(1));
        self.n_dropped += n_dropped;
        n_dropped
    }

    /// Makes a frame, and stores its times. Passes are timed if their times are shown: the
    /// processor then waits for the device.
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
        let end_ms = clock.now_ms();
        let cpu_ms = end_ms - begin_ms;
        let age_at = |delivered: Delivered| Some(delivered.age_ms? + end_ms - delivered.at_ms);
        let camera_to_present_ms = self.delivered.and_then(age_at);
        let pass_times = core.read_pass_times()?;
        let (about, args) = about(core);
        let dropped = self.delivered.map(|delivered| self.drop_before(delivered.id));
        let args = Args {
            number: Some(self.n_frames),
            kind: report.change.map(|change| change.name().to_owned()),
            interval_ms: self.before_ms.map(|before_ms| begin_ms - before_ms),
            camera_to_present_ms,
            dropped,
            ..args
        };
        self.n_frames += 1;
        self.before_ms = Some(begin_ms);
        let gpu_ms = (!pass_times.is_empty()).then(|| sum_ms(&pass_times));
        self.latest = Some(Latest {
            cpu_ms,
            gpu_ms,
            camera_to_present_ms,
            n_dropped: dropped.unwrap_or(0),
        });
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

    /// Times of the latest frame, for a recording.
    pub(super) fn latest(&self) -> Option<Value> {
        let latest = self.latest?;
        Some(json!({
            "cpu_ms": latest.cpu_ms,
            "gpu_ms": latest.gpu_ms,
            "camera_to_present_ms": latest.camera_to_present_ms,
            "dropped": self.n_dropped,
        }))
    }

    /// Times of the latest frame as text.
    pub(super) fn words(&self) -> Option<String> {
        let latest = self.latest?;
        let after = |name: &str, ms: Option<f64>| ms.map_or(String::new(), |ms| format!("{name} {ms:.1} ms"));
        let (device, camera) = (
            after(", device", latest.gpu_ms),
            after("camera to present", latest.camera_to_present_ms),
        );
        let dropped = match self.n_dropped {
            0 => String::new(),
            n_dropped => format!("{n_dropped} pictures dropped"),
        };
        let lines = [
            format!("processor {:.1} ms{device}", latest.cpu_ms),
            camera,
            dropped,
        ];
        let told = lines.into_iter().filter(|line| !line.is_empty());
        Some(told.collect::<Vec<_>>().join("\n"))
    }
}

/// The part of a frame's scope about heat and settings.
pub(super) fn args(thermal: Thermal, governor: Option<&Governor>) -> Args {
    let quality_reductions = governor.iter().flat_map(|governor| governor.quality_reductions());
    Args {
        heat: Some(format!("{thermal:?}")),
        turned_down: quality_reductions.map(|step| step.what.to_owned()).collect(),
        ..Args::default()
    }
}

fn sum_ms(times: &[PassTime]) -> f64 {
    times.iter().map(|time| time.gpu_ms).sum()
}
