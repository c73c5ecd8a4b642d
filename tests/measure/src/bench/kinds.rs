//! Times of the three kinds of frame: a new pose on a known picture, a new picture of a known view, a new view.

use std::time::Instant;

use app_core::camera_frame::{CameraImage, Display, PlanarImage, Planes};
use app_core::core::{Core, CoreError};
use app_core::frame::{Clock, FrameInput};
use app_core::scene::{Camera, Image};
use app_pipeline::core::inspect::Inspect;
use glam::DMat4;

use crate::count::Counted;
use crate::median::median;

/// Turn of the camera about its own axis that makes a new view, some five pixels to the right, and
/// back.
const TURN_RAD: f64 = 0.005;
/// Largest number of a session's frames that are timed in turn.
pub(super) const MOST_INPUTS: usize = 4;

/// The stage that is timed outside of the core.
const SCREEN: &str = "screen";

/// Milliseconds of passes or stages by name.
type Named = Vec<(&'static str, f64)>;

/// The kind of change in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameKind {
    /// A new shown pose alone: a paused camera.
    Pose,
    /// A new camera picture as well: a phone on a stand.
    Picture,
    /// A new camera pose as well: a hand-held phone.
    View,
}

/// All kinds, the cheapest first.
pub const FRAME_KINDS: [FrameKind; 3] = [FrameKind::Pose, FrameKind::Picture, FrameKind::View];

impl FrameKind {
    /// Name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Pose => "pose",
            Self::Picture => "picture",
            Self::View => "view",
        }
    }
}

/// Medians over frames and repeats.
#[derive(Clone, Debug, PartialEq)]
pub struct KindTimes {
    /// Kind of the frames.
    pub kind: FrameKind,
    /// Processor time until the device has a frame.
    pub cpu_ms: Option<f64>,
    /// Device time; `None` without timestamps.
    pub gpu_ms: Option<f64>,
    /// Processor time of each stage, in order; their sum is that time.
    pub stages: Vec<(&'static str, f64)>,
    /// Device time of each pass, all of its runs in a frame together, in order.
    pub passes: Vec<(&'static str, f64)>,
    /// The counted costs on any device; `None` if not counted.
    pub counted: Option<Counted>,
    /// Number of objects created on the device in all of these frames together.
    pub n_made: u64,
    /// Their size in bytes.
    pub made_bytes: u64,
    /// Half of the interquartile range of the device's time, or else of the processor's.
    pub spread_ms: Option<f64>,
    /// Time of such a frame over the preset `paper`'s on this session in this run.
    pub ratio_to_paper: Option<f64>,
}

impl KindTimes {
    /// Device time, or else processor time.
    pub(super) fn frame_ms(&self) -> Option<f64> {
        self.gpu_ms.or(self.cpu_ms)
    }
}

/// Times each kind on the first frames of `inputs`, whose scene is set.
pub(super) fn measure(
    core: &mut Core,
    inputs: &[FrameInput],
    n_repeats: usize,
) -> Result<Vec<KindTimes>, CoreError> {
    core.time_passes(true)?;
    core.draw_every_pose()?;
    let start = Instant::now();
    core.time_stages(Some(Clock::new(move || start.elapsed().as_secs_f64() * 1e3)));
    let measured = FRAME_KINDS
        .iter()
        .map(|kind| of_kind(core, inputs, *kind, n_repeats));
    let measured = measured.collect();
    core.time_stages(None);
    measured
}

fn of_kind(
    core: &mut Core,
    inputs: &[FrameInput],
    kind: FrameKind,
    n_repeats: usize,
) -> Result<KindTimes, CoreError> {
    let (mut cpu, mut stages, mut device) = (Vec::new(), Vec::new(), Vec::new());
    let (mut n_made, mut made_bytes) = (0, 0);
    let screen = inputs
        .first()
        .and_then(|input| core.hidden_screen(input.image.size_px()));
    for input in inputs.iter().take(MOST_INPUTS) {
        let others = [input.clone(), with_new(input, kind)];
        // With a new picture or view, results of learning about the place stay.
        for known in &others {
            show(core, known, screen.as_ref())?;
        }
        let before = made(core);
        for next in others.iter().cycle().take(2 * n_repeats) {
            core.read_pass_times()?;
            let start = Instant::now();
            stages.push(show(core, next, screen.as_ref())?);
            cpu.push(start.elapsed().as_secs_f64() * 1e3);
            let passes = core.read_pass_times()?;
            device.push(
                passes
                    .iter()
                    .map(|time| (time.pass, time.gpu_ms))
                    .collect::<Named>(),
            );
        }
        let after = made(core);
        // Each reading of timestamps creates one buffer, which is not the frame's.
        n_made += after.0 - before.0 - n_readings(core, 2 * n_repeats);
        made_bytes += after.1 - before.1;
    }
    let gpu: Vec<f64> = device.iter().filter_map(total_ms).collect();
    Ok(KindTimes {
        kind,
        spread_ms: spread(if gpu.is_empty() { &cpu } else { &gpu }),
        cpu_ms: median(cpu),
        gpu_ms: median(gpu),
        counted: None,
        n_made,
        made_bytes,
        stages: medians(&stages),
        passes: medians(&device),
        ratio_to_paper: None,
    })
}

/// Makes a frame and draws it on a screen of the picture's size; returns the times of its stages.
fn show(core: &mut Core, input: &FrameInput, screen: Option<&wgpu::Texture>) -> Result<Named, CoreError> {
    let report = core.frame(input)?;
    let mut stages: Named = report
        .stages
        .iter()
        .map(|stage| (stage.stage, stage.cpu_ms))
        .collect();
    if let Some(screen) = screen {
        let start = Instant::now();
        core.draw_on(screen, Display::default())?;
        stages.push((SCREEN, start.elapsed().as_secs_f64() * 1e3));
    }
    Ok(stages)
}

/// Number and bytes of objects created on the device so far.
fn made(core: &Core) -> (u64, u64) {
    let n_made = core.n_created().iter().map(|(_, n)| n).sum();
    (n_made, core.memory().made_bytes)
}

/// Number of buffers for reading the timestamps of `n_frames` frames.
fn n_readings(core: &Core, n_frames: usize) -> u64 {
    let has_times = core.read_pass_times().is_ok_and(|times| !times.is_empty());
    if has_times { 2 * n_frames as u64 } else { 0 }
}

/// Half of the interquartile range.
fn spread(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |part: usize| sorted.get(part * sorted.len() / 4).copied();
    Some(0.5 * (at(3)? - at(1)?))
}

/// A frame with something new in it.
#[must_use]
pub fn with_new(input: &FrameInput, kind: FrameKind) -> FrameInput {
    let picture = || copied(&input.image);
    let turn = DMat4::from_rotation_x(TURN_RAD);
    match kind {
        FrameKind::Pose => input.clone(),
        FrameKind::Picture => input.clone().with_image(picture()),
        FrameKind::View => input.clone().with_image(picture()).with_camera(Camera {
            world_from_camera: input.camera.world_from_camera * turn,
            ..input.camera
        }),
    }
}

/// A copy of the picture, which the core treats as a new one.
fn copied(image: &CameraImage) -> CameraImage {
    let pixels = |image: &CameraImage| CameraImage::from(Image::clone(image.rgba()));
    let CameraImage::Planes(planes) = image else {
        return pixels(image);
    };
    let [width, _] = planes.size_px().map(|side| side as usize);
    let of_chroma = (planes.chroma(), 2 * width.div_ceil(2));
    let read = Planes::nv12(
        planes.size_px(),
        (planes.luma(), width),
        of_chroma,
        planes.encoding(),
    );
    PlanarImage::new(&read).map_or_else(|_| pixels(image), CameraImage::from)
}

fn total_ms(times: &Named) -> Option<f64> {
    times.iter().map(|(_, ms)| *ms).reduce(|sum, ms| sum + ms)
}

/// Median of each pass or stage, in the order of their first runs.
fn medians(frames: &[Named]) -> Named {
    let mut names: Vec<&'static str> = Vec::new();
    for (name, _) in frames.iter().flatten() {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let in_frame = |frame: &Named, name: &str| {
        let runs = frame.iter().filter(|(run, _)| *run == name);
        runs.map(|(_, ms)| *ms).sum()
    };
    let of_name = |name: &'static str| {
        let each = frames.iter().map(|frame| in_frame(frame, name)).collect();
        median(each).map(|ms| (name, ms))
    };
    names.into_iter().filter_map(of_name).collect()
}
