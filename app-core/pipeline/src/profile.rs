//! Profiles: the times of frames' stages and passes, in one format for all sources.
//!
//! A profile is a trace in Chrome's format, which Perfetto (<https://ui.perfetto.dev>) and
//! `chrome://tracing` open directly: JSON with `traceEvents`, of which those of phase `X` are
//! scopes with a beginning `ts` and a length `dur` in microseconds, and `otherData` with the
//! measured session and device.
//!
//! - Process 1, thread 1, *processor*: a scope `frame` for each frame, within it its stages and,
//!   beside those of the core, the
//!   stages that the caller timed itself, such as `align`.
//! - Thread 2, *device*: a scope for each timed pass. A device measures the duration of passes
//!   rather than their beginning, so they
//!   are placed end to end from the frame's beginning on.
//!
//! `args` of a frame has its `number`, its `kind` (`pose`, `picture`, `view` or `scene`), the
//! `interval_ms` to the previous frame if that is known, `camera_to_present_ms` from the camera's
//! picture until the frame that shows it was submitted to the device, the number of camera pictures
//! since the previous frame that were `dropped`, the `heat` in the phone's own term, and the
//! settings that are `turned_down`; that of a pass its `path`, `runs`, `triangles` and `bytes`.
//!
//! Source: "Trace Event Format", the Chromium project.

use serde::{Deserialize, Serialize};

use crate::frame::FrameReport;
use crate::gpu::{PassTime, StageTime};

/// Version of the format: the names may have other meanings in another one.
pub const VERSION: u32 = 1;

/// A trace, as it is written and read. Events of other phases are ignored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Scopes, and the names of threads.
    #[serde(rename = "traceEvents")]
    pub events: Vec<Event>,
    /// Unit in which viewers show lengths.
    #[serde(rename = "displayTimeUnit", default = "milliseconds")]
    pub unit: String,
    /// Description of the measurement.
    #[serde(rename = "otherData")]
    pub about: About,
}

/// Description of the measurement: session, preset and device.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// [`VERSION`].
    pub version: u32,
    /// Name of the session or of the app's scene.
    pub session: String,
    /// Name of the preset.
    pub preset: String,
    /// Name of the device and its driver.
    pub device: String,
    /// Width and height of the camera's picture.
    pub picture_px: [u32; 2],
    /// Width and height of the screen on which the picture is shown, if it is shown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub screen_px: Option<[u32; 2]>,
}

/// One event of a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Name of the scope.
    pub name: String,
    /// `X` for a scope, `M` for the name of a thread.
    pub ph: String,
    /// Beginning, microseconds.
    #[serde(default)]
    pub ts: f64,
    /// Length, microseconds.
    #[serde(default)]
    pub dur: f64,
    /// Process.
    #[serde(default)]
    pub pid: u32,
    /// Thread.
    #[serde(default)]
    pub tid: u32,
    /// Further values.
    #[serde(default)]
    pub args: Args,
}

/// Values of a scope beside its time; see the module.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[allow(missing_docs, reason = "described in the module's words")]
pub struct Args {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interval_ms: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera_to_present_ms: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dropped: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heat: Option<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub turned_down: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub runs: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bytes: Option<u64>,
}

/// Scopes of the processor.
pub const PROCESSOR: u32 = 1;
/// Scopes of the device.
pub const DEVICE: u32 = 2;
/// Name of the scope around a frame.
pub const FRAME: &str = "frame";

/// A frame with the values that the caller knows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame<'a> {
    /// Beginning of the frame, by the clock of its stages.
    pub begin_ms: f64,
    /// Total time on the processor.
    pub cpu_ms: f64,
    /// Stages that the caller timed itself.
    pub further_stages: &'a [StageTime],
    /// Device times of its passes.
    pub pass_times: &'a [PassTime],
    /// Number, kind, interval and heat, and the settings that are turned down.
    pub args: Args,
}

impl Profile {
    /// A profile without frames.
    #[must_use]
    pub fn new(about: About) -> Self {
        let thread = |tid: u32, name: &str| Event {
            name: "thread_name".to_owned(),
            ph: "M".to_owned(),
            ts: 0.0,
            dur: 0.0,
            pid: 1,
            tid,
            args: Args {
                name: Some(name.to_owned()),
                ..Args::default()
            },
        };
        Self {
            events: vec![thread(PROCESSOR, "processor"), thread(DEVICE, "device")],
            unit: milliseconds(),
            about: About {
                version: VERSION,
                ..about
            },
        }
    }

    /// Adds a frame: the stages and passes of the report, and further values.
    pub fn add(&mut self, report: &FrameReport, frame: Frame<'_>) {
        let begin = frame.begin_ms;
        self.events
            .push(scope(FRAME, PROCESSOR, begin, frame.cpu_ms, frame.args));
        for stage in report.stages.iter().chain(frame.further_stages) {
            let (begin_ms, ms) = (stage.begin_ms, stage.cpu_ms);
            self.events
                .push(scope(stage.stage, PROCESSOR, begin_ms, ms, Args::default()));
        }
        let mut at_ms = begin;
        for time in frame.pass_times {
            let mut runs = report.ran.iter();
            let run = runs.find(|run| (run.path, run.pass) == (time.path, time.pass));
            let args = Args {
                path: Some(time.path.name().to_owned()),
                runs: run.map(|run| run.n_runs),
                triangles: run.map(|run| run.work.triangles()),
                bytes: run.map(|run| run.work.bytes_moved()),
                ..Args::default()
            };
            self.events
                .push(scope(time.pass, DEVICE, at_ms, time.gpu_ms, args));
            at_ms += time.gpu_ms;
        }
    }

    /// Number of frames.
    pub fn n_frames(&self) -> usize {
        self.frame_places().count()
    }

    /// Drops all but the latest `n_frames` frames.
    pub fn keep_latest(&mut self, n_frames: usize) {
        let n_dropped = self.n_frames().saturating_sub(n_frames);
        let kept_from = self.frame_places().nth(n_dropped).unwrap_or(self.events.len());
        let mut place = 0;
        self.events.retain(|event| {
            place += 1;
            event.ph != "X" || place > kept_from
        });
    }

    /// Whether the profile is of the same measurement.
    pub fn is_about(&self, about: &About) -> bool {
        let version = self.about.version;
        self.about
            == About {
                version,
                ..about.clone()
            }
    }

    /// Indices of the frames' scopes; all other scopes of a frame follow its own.
    fn frame_places(&self) -> impl Iterator<Item = usize> {
        let events = self.events.iter().enumerate();
        let frames = events.filter(|(_, event)| event.ph == "X" && event.name == FRAME);
        frames.map(|(place, _)| place)
    }

    /// The scopes of a thread, of all frames.
    pub fn scopes(&self, tid: u32) -> impl Iterator<Item = &Event> {
        let of_thread = move |event: &&Event| event.ph == "X" && event.tid == tid;
        self.events.iter().filter(of_thread)
    }
}

fn scope(name: &str, tid: u32, begin_ms: f64, ms: f64, args: Args) -> Event {
    Event {
        name: name.to_owned(),
        ph: "X".to_owned(),
        ts: 1e3 * begin_ms,
        dur: 1e3 * ms,
        pid: 1,
        tid,
        args,
    }
}

fn milliseconds() -> String {
    "ms".to_owned()
}
