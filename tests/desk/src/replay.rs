//! Replays a session: every camera frame through the core, each picture written and scored, the whole reported.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use app_core::alignment::{AlignError, LensAlignment};
use app_core::camera_frame::PlaneError;
use app_core::core::{Core, CoreError};
use app_core::governor::QualityStep;
use app_core::preset::Preset;
use app_core::scene::{Image, Scene};
use app_core::session::{GroundTruth, Session, SessionError};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::readback::Map;
use thiserror::Error;

use crate::alignment::{Alignments, Asked, Lights, Ratio};
use crate::false_color;
use crate::false_color::{ERROR, describe};
use crate::files::SESSION_FILE;
use crate::lights_drawn::write_lights;
use crate::metrics::flicker::Follower;
use crate::metrics::{SizeError, score};
use crate::output::{WriteError, make_folder, remove_file, write_png, write_whole};
use crate::page;
use crate::page::pictures::Pictures;
use crate::page::{MAPS_FOLDER, PAGE_FILE};
use crate::progress::Progress;
use crate::report::alignment::{AlignmentEntry, LensEntry};
use crate::report::{FitEntry, FrameEntry, MapEntry, Mean, Report, pass_entries};

/// File name of the report in the output folder.
pub const REPORT_FILE: &str = "report.json";

/// What to replay and where to put it.
#[derive(Clone, Debug)]
pub struct Options {
    /// How much work a frame may cost: all frames with each, and no two the same.
    pub presets: Vec<Preset>,
    /// What is turned down of the presets, as the governor does it.
    pub turned_down: &'static [QualityStep],
    /// The frames to replay, all without it.
    pub frames: Option<Range<usize>>,
    /// Folder for pictures, report and page, made where it is missing; without it nothing is written.
    ///
    /// One preset writes its pictures and report right there, several each into a folder of its name.
    pub out: Option<PathBuf>,
    /// Whether cameras, toy and lights are first aligned by the pictures.
    pub is_aligned: bool,
    /// Where the lights come from then.
    pub lights: Lights,
    /// The number that is looked for then.
    pub ratio: Ratio,
    /// What was found of the lens that the session was opened with; none where nobody asked.
    pub lens: Option<LensAlignment>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            presets: vec![Preset::default()],
            turned_down: &[],
            frames: None,
            out: None,
            is_aligned: true,
            lights: Lights::default(),
            ratio: Ratio::default(),
            lens: None,
        }
    }
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
    /// A frame cannot be aligned.
    #[error("aligning frame {index}: {reason}")]
    Align {
        /// The frame, from 0.
        index: usize,
        /// What is wrong with it.
        reason: Box<AlignError>,
    },
    /// A frame cannot be had as planes.
    #[error(transparent)]
    Planes(#[from] PlaneError),
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

/// Corrections of the frames that the options ask for.
///
/// # Errors
/// When there are no such frames, or one cannot be read or aligned.
pub fn alignments(session: &dyn Session, options: &Options) -> Result<Alignments, ReplayError> {
    if options.is_aligned {
        let asked = Asked {
            lights: options.lights,
            ratio: options.ratio,
        };
        let found = Alignments::find(session, frames_of(session, options)?, asked)?;
        Ok(found.with_lens(options.lens))
    } else {
        Ok(Alignments::none())
    }
}

/// Replays `session` on `core` with each preset, scores it against `truth`, and tells `progress` about each frame.
///
/// Report and page left by an earlier run are removed first, so that one in the output folder means that all frames
/// were written.
///
/// # Errors
/// When a frame cannot be read, made or written; those before it stay.
pub fn replay(
    session: &dyn Session,
    truth: Option<&dyn GroundTruth>,
    core: &mut Core,
    options: &Options,
    progress: &mut dyn Progress,
) -> Result<Vec<Report>, ReplayError> {
    let alignments = alignments(session, options)?;
    replay_aligned((session, truth), core, options, &alignments, progress)
}

/// The same with corrections that were found before.
///
/// # Errors
/// As [`replay`].
pub fn replay_aligned(
    (session, truth): (&dyn Session, Option<&dyn GroundTruth>),
    core: &mut Core,
    options: &Options,
    alignments: &Alignments,
    progress: &mut dyn Progress,
) -> Result<Vec<Report>, ReplayError> {
    core.time_passes(true)?;
    let frames = frames_of(session, options)?;
    let out = options.out.as_deref();
    let folders: Vec<String> = options
        .presets
        .iter()
        .map(|preset| match options.presets.len() {
            1 => String::new(),
            _ => format!("{}/", preset.name()),
        })
        .collect();
    for folder in folders.iter().map(String::as_str).chain([""]) {
        out.map(|out| prepare(&out.join(folder))).transpose()?;
    }
    let mut reports = Vec::with_capacity(folders.len());
    for (preset, folder) in options.presets.iter().zip(folders) {
        let mut run = Run {
            session,
            truth,
            core,
            alignments,
            out: out.map(|out| Out::new(out.join(&folder))),
            follower: Follower::default(),
            turned_down: options.turned_down,
        };
        let report = run.replay(*preset, frames.clone(), progress)?;
        reports.push((folder, report));
    }
    if let Some(out) = out {
        page::write(out, (session, truth), frames, &reports)?;
    }
    Ok(reports.into_iter().map(|(_, report)| report).collect())
}

/// Where one preset's pictures go.
struct Out {
    folder: PathBuf,
    maps: Pictures,
}

impl Out {
    fn new(folder: PathBuf) -> Self {
        Self {
            maps: Pictures::new(&folder, MAPS_FOLDER),
            folder,
        }
    }
}

/// The replay with one preset.
struct Run<'a> {
    session: &'a dyn Session,
    truth: Option<&'a dyn GroundTruth>,
    core: &'a mut Core,
    alignments: &'a Alignments,
    out: Option<Out>,
    follower: Follower,
    turned_down: &'static [QualityStep],
}

impl Run<'_> {
    fn set_scene(&mut self, scene: Scene, preset: Preset) -> Result<(), CoreError> {
        self.core.set_scene(scene, preset)?;
        self.core.set_quality_reductions(self.turned_down)
    }

    fn replay(
        &mut self,
        preset: Preset,
        indices: Range<usize>,
        progress: &mut dyn Progress,
    ) -> Result<Report, ReplayError> {
        let scene = self.session.scene();
        self.set_scene(self.alignments.scene(scene), preset)?;
        progress.start(&format!("{} with {preset}", scene.name), indices.len());
        let mut frames = Vec::with_capacity(indices.len());
        for index in indices {
            if let Some(relit) = self.alignments.relit_scene(scene, index) {
                self.set_scene(relit, preset)?;
            }
            let entry = self.frame(index, preset)?;
            progress.frame(&entry);
            frames.push(entry);
        }
        let report = Report {
            session: scene.name.clone(),
            preset: preset.name(),
            adapter: self.core.adapter_name(),
            is_software: self.core.is_software(),
            size_px: [scene.width_px, scene.height_px],
            warnings: warnings_of(self.session, self.core)?,
            lens: self.alignments.lens().map(LensEntry::from),
            mean: Mean::of(&frames),
            fit: self
                .core
                .read_fit()?
                .map(|fit| FitEntry::new(&fit, self.alignments.n_lights(scene, preset))),
            frames,
        };
        if let Some(out) = &self.out {
            write_report(&out.folder, &report)?;
        }
        progress.finish();
        Ok(report)
    }

    fn frame(&mut self, index: usize, preset: Preset) -> Result<FrameEntry, ReplayError> {
        let (mut entry, region, picture) =
            run_frame(self.session, self.alignments, self.core, (index, preset))?;
        let truth = match self.truth {
            Some(truth) => truth.truth(index)?,
            None => None,
        };
        if let Some(truth) = &truth {
            let failed = |reason| ReplayError::Score { index, reason };
            entry.scores = Some(score(&picture, truth).map_err(failed)?);
            entry.flicker = self.follower.next(index, &picture, truth).map_err(failed)?;
        }
        if let Some(out) = &mut self.out {
            let name = picture_file(index);
            write_png(&out.folder.join(&name), &picture)?;
            entry.picture = Some(name);
            let error = truth.map(|truth| false_color::error(&picture, &truth.image));
            entry.error = error
                .map(|error| out.maps.write(ERROR.name, index, error.into()))
                .transpose()?;
            let drawn = (self.session, self.alignments, index);
            entry.maps = write_lights(&mut out.maps, drawn, preset)?;
            if let Some(region) = region {
                let maps = write_maps(&mut out.maps, (self.session, self.core), (index, region))?;
                entry.maps.extend(maps);
            }
        }
        Ok(entry)
    }
}

fn write_maps(
    pictures: &mut Pictures,
    (session, core): (&dyn Session, &Core),
    (index, region): (usize, PixelRect),
) -> Result<Vec<MapEntry>, ReplayError> {
    let mut entries = Vec::new();
    let size_px = [session.scene().width_px, session.scene().height_px];
    for map in Map::ALL {
        let values = core
            .read_map(*map)
            .map_err(|reason| ReplayError::Frame { index, reason })?;
        if let (Some(shown), Some(values)) = (describe(*map), values) {
            let picture = false_color::picture(*map, &values, region, size_px);
            let picture = session.map_through_lens(index, picture)?;
            let file = pictures.write(shown.name, index, picture.into())?;
            entries.push(MapEntry {
                name: shown.name,
                file,
            });
        }
    }
    Ok(entries)
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
    remove_file(&folder.join(PAGE_FILE))?;
    Ok(remove_file(&folder.join(REPORT_FILE))?)
}

/// Makes one picture and what can be told of it without a truth.
fn run_frame(
    session: &dyn Session,
    alignments: &Alignments,
    core: &mut Core,
    (index, preset): (usize, Preset),
) -> Result<(FrameEntry, Option<PixelRect>, Image), ReplayError> {
    let failed = |reason| ReplayError::Frame { index, reason };
    let frame = session.frame(index)?;
    let input = alignments.input(index, &frame, preset);
    let aligned = alignments.of(index);
    let start = Instant::now();
    let report = core.frame(&input).map_err(failed)?;
    let cpu = start.elapsed();
    let picture = core.read_picture().map_err(failed)?;
    let wall = start.elapsed();
    let times = core.read_pass_times().map_err(failed)?;
    let picture = session.through_lens(index, picture)?;
    let warnings = frame.warnings.iter().map(ToString::to_string);
    let entry = FrameEntry {
        index,
        time_secs: frame.time_secs,
        picture: None,
        error: None,
        maps: Vec::new(),
        region: report.region.map(Into::into),
        gpu_ms: (!times.is_empty()).then(|| times.iter().map(|time| time.gpu_ms).sum()),
        cpu_ms: ms(cpu),
        wall_ms: ms(wall),
        passes: pass_entries(&report, &times),
        skipped: report.skipped.iter().map(Into::into).collect(),
        warnings: warnings
            .chain(
                aligned
                    .iter()
                    .flat_map(|aligned| &aligned.alignment.warnings)
                    .map(ToString::to_string),
            )
            .chain(report.warnings.iter().map(ToString::to_string))
            .collect(),
        alignment: aligned.map(AlignmentEntry::from),
        scores: None,
        flicker: None,
    };
    Ok((entry, report.region, picture))
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
