//! Replays a session: every camera frame through the core, each picture written and scored, the whole reported.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use app_core::core::{Core, CoreError};
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::session::{GroundTruth, Session, SessionError};
use thiserror::Error;

use crate::metrics::{Regions, Scores, SizeError, measure};
use crate::output::{WriteError, make_folder, remove_file, write_png, write_whole};
use crate::progress::Progress;
use crate::report::{FitEntry, FrameEntry, Mean, Report, pass_entries};

/// File name of the report in the output folder.
pub const REPORT_FILE: &str = "report.json";
/// What makes a folder a session.
const SESSION_FILE: &str = "capture.json";

/// What to replay and where to put it.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// How much work a frame may cost.
    pub preset: Preset,
    /// The frames to replay, all without it.
    pub frames: Option<Range<usize>>,
    /// Folder for pictures and report, made where it is missing; without it nothing is written.
    pub out: Option<PathBuf>,
}

/// A replay that did not come to its end.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The session, or one of its frames, cannot be read.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The core cannot take the session.
    #[error(transparent)]
    Core(#[from] CoreError),
    /// The core cannot make a frame.
    #[error("frame {index}: {reason}")]
    Frame {
        /// The frame, from 0.
        index: usize,
        /// What the core said.
        reason: CoreError,
    },
    /// A picture does not fit its truth.
    #[error("scoring frame {index}: {reason}")]
    Score {
        /// The frame, from 0.
        index: usize,
        /// What differs.
        reason: SizeError,
    },
    /// A picture or the report cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Frames that the session does not have.
    #[error("frames {}..{} are asked for, but the session has {n_frames}, counted from 0", frames.start, frames.end)]
    NoSuchFrames {
        /// The frames asked for.
        frames: Range<usize>,
        /// Number of frames that there are.
        n_frames: usize,
    },
    /// An output folder whose files are someone's photographs.
    #[error("{}: holds a session, whose camera frames would be overwritten", folder.display())]
    OutIsSession {
        /// The folder.
        folder: PathBuf,
    },
}

/// File name of the picture of frame `index`.
#[must_use]
pub fn picture_file(index: usize) -> String {
    format!("frame_{index:04}.png")
}

/// Replays `session` on `core`, scores it against `truth`, and tells `progress` about each frame.
///
/// A report left by an earlier run is removed first, so that one in the output folder means that all frames were
/// written.
///
/// # Errors
/// When a frame cannot be read, made or written; those before it stay.
pub fn replay(
    session: &dyn Session,
    truth: Option<&dyn GroundTruth>,
    core: &mut Core,
    options: &Options,
    progress: &mut dyn Progress,
) -> Result<Report, ReplayError> {
    let indices = frames_of(session, options)?;
    let out = options.out.as_deref();
    if let Some(folder) = out {
        prepare(folder)?;
    }
    let scene = session.scene();
    core.set_scene(scene.clone(), options.preset)?;
    progress.start(&scene.name, indices.len());
    let mut frames = Vec::with_capacity(indices.len());
    for index in indices {
        let (mut entry, picture) = run_frame(session, core, index)?;
        if let Some(truth) = truth {
            entry.scores = score(truth, index, &picture)?;
        }
        if let Some(folder) = out {
            let name = picture_file(index);
            write_png(&folder.join(&name), &picture)?;
            entry.picture = Some(name);
        }
        progress.frame(&entry);
        frames.push(entry);
    }
    let report = Report {
        session: scene.name.clone(),
        preset: options.preset.name(),
        adapter: core.gpu().adapter_name(),
        is_software: core.gpu().is_software(),
        size_px: [scene.width_px, scene.height_px],
        warnings: warnings_of(session, core)?,
        mean: Mean::of(&frames),
        fit: core
            .read_fit()?
            .map(|fit| FitEntry::new(&fit, scene.lights.len())),
        frames,
    };
    if let Some(folder) = out {
        write_report(folder, &report)?;
    }
    progress.finish();
    Ok(report)
}

fn warnings_of(session: &dyn Session, core: &Core) -> Result<Vec<String>, CoreError> {
    let of_session = session.warnings().iter().map(ToString::to_string);
    Ok(of_session
        .chain(core.read_fit_warnings()?.iter().map(ToString::to_string))
        .collect())
}

fn frames_of(session: &dyn Session, options: &Options) -> Result<Range<usize>, ReplayError> {
    let n_frames = session.n_frames();
    match options.frames.clone() {
        None => Ok(0..n_frames),
        Some(frames) if frames.end <= n_frames && !frames.is_empty() => Ok(frames),
        Some(frames) => Err(ReplayError::NoSuchFrames { frames, n_frames }),
    }
}

fn prepare(folder: &Path) -> Result<(), ReplayError> {
    make_folder(folder)?;
    if folder.join(SESSION_FILE).exists() {
        return Err(ReplayError::OutIsSession {
            folder: folder.to_owned(),
        });
    }
    Ok(remove_file(&folder.join(REPORT_FILE))?)
}

/// Makes one picture and what can be told of it without a truth.
fn run_frame(
    session: &dyn Session,
    core: &mut Core,
    index: usize,
) -> Result<(FrameEntry, Image), ReplayError> {
    let failed = |reason| ReplayError::Frame { index, reason };
    let frame = session.frame(index)?;
    let input = FrameInput::from(&frame);
    let start = Instant::now();
    let report = core.frame(&input).map_err(failed)?;
    let cpu = start.elapsed();
    let picture = core.read_picture().map_err(failed)?;
    let wall = start.elapsed();
    let times = core.take_pass_times().map_err(failed)?;
    let warnings = frame.warnings.iter().map(ToString::to_string);
    let entry = FrameEntry {
        index,
        time_secs: frame.time_secs,
        picture: None,
        region: report.region.map(Into::into),
        gpu_ms: (!times.is_empty()).then(|| times.iter().map(|time| time.gpu_ms).sum()),
        cpu_ms: ms(cpu),
        wall_ms: ms(wall),
        passes: pass_entries(&report, &times),
        skipped: report.skipped.iter().map(Into::into).collect(),
        warnings: warnings
            .chain(report.warnings.iter().map(ToString::to_string))
            .collect(),
        scores: None,
    };
    Ok((entry, picture))
}

fn score(truth: &dyn GroundTruth, index: usize, picture: &Image) -> Result<Option<Scores>, ReplayError> {
    let Some(truth) = truth.truth(index)? else {
        return Ok(None);
    };
    measure(picture, &truth.image, &Regions::from_mask(&truth.mask))
        .map(Some)
        .map_err(|reason| ReplayError::Score { index, reason })
}

fn write_report(folder: &Path, report: &Report) -> Result<(), WriteError> {
    let path = folder.join(REPORT_FILE);
    let mut json = serde_json::to_vec_pretty(report).map_err(|error| WriteError {
        path: path.clone(),
        reason: error.to_string(),
    })?;
    json.push(b'\n');
    write_whole(&path, &json)
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
