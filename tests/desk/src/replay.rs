//! Replays a session: the core makes a picture of every camera frame; each is written and scored, and all are reported.

use std::iter;
use std::path::PathBuf;
use std::rc::Rc;
use std::time::{Duration, Instant};

use app_core::alignment::LensAlignment;
use app_core::core::{Core, CoreError};
use app_core::frame::FrameInput;
use app_core::governor::QualityStep;
use app_core::preset::Preset;
use app_core::scene::{Image, Scene};
use app_core::session::{GroundTruth, Session, SessionFrame, Truth};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::readback::Map;

use crate::alignment::{Alignments, Asked, Lights, Ratio};
use crate::doubts;
use crate::false_color::{self, ERROR, describe};
use crate::frames::Frames;
use crate::lens::{map_through_lens, through_lens};
use crate::lights_drawn::write_lights;
use crate::metrics::flicker::Follower;
use crate::metrics::{floor, score};
use crate::output::WriteError;
use crate::output::folder::OutputFolder;
use crate::page::pictures::Pictures;
use crate::page::{MAPS_FOLDER, Page, folder_of, values};
use crate::progress::Progress;
use crate::replay_out::take;
use crate::report::{AlignmentEntry, FitEntry, FrameEntry, GlossEntry, MapEntry, Mean, Report};

pub use crate::replay_error::ReplayError;
pub use crate::replay_out::check_out;

/// File name of the report in the output folder.
pub const REPORT_FILE: &str = "report.json";

/// Input and output of a replay.
#[derive(Clone, Debug)]
pub struct Options {
    /// The presets: each makes all frames, and no two are the same.
    pub presets: Vec<Preset>,
    /// Quality steps taken off the presets, as by the governor.
    pub quality_reductions: &'static [QualityStep],
    /// The frames to replay.
    pub frames: Frames,
    /// Folder for pictures, report and page, made if it is missing; without it nothing is written.
    ///
    /// One preset writes its pictures and report there, several presets into a folder of their name each.
    pub out: Option<PathBuf>,
    /// Whether cameras, toy and lights are first aligned by the pictures.
    pub is_aligned: bool,
    /// The source of the lights for alignment.
    pub lights: Lights,
    /// The number that alignment estimates.
    pub ratio: Ratio,
    /// The estimate of the lens that the session was opened with; `None` if it was not asked for.
    pub lens: Option<LensAlignment>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            presets: vec![Preset::default()],
            quality_reductions: &[],
            frames: Frames::ALL,
            out: None,
            is_aligned: true,
            lights: Lights::default(),
            ratio: Ratio::default(),
            lens: None,
        }
    }
}

impl Options {
    /// The quantities to estimate; `None` if frames stay as they were recorded.
    fn asked(&self) -> Option<Asked> {
        self.is_aligned.then_some(Asked {
            lights: self.lights,
            ratio: self.ratio,
        })
    }
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
    let frames = options.frames.within(session.n_frames())?;
    let found = match options.asked() {
        Some(asked) => Alignments::find(session, frames, asked)?,
        None => Alignments::none(),
    };
    Ok(found.with_lens(options.lens))
}

/// Replays `session` on the device of `core` with each preset, scores it against `truth`, and reports each picture to
/// `progress`.
///
/// Each frame is read once, aligned, and made with one preset after the other. Only if a number of the whole session is
/// estimated, all frames are aligned before the first is made.
///
/// The files of all pictures are checked before the first frame. Files of an earlier run in the output folder are
/// removed, so that no old report lies beside new frames.
///
/// # Errors
/// When a frame cannot be read, made or written; earlier frames stay, with a report of the reason.
/// When the output folder contains files that no run wrote, or another run writes into it.
pub fn replay(
    session: &dyn Session,
    truth: Option<&dyn GroundTruth>,
    core: &mut Core,
    options: &Options,
    progress: &mut dyn Progress,
) -> Result<Vec<Report>, ReplayError> {
    session.check_pictures(options.frames.within(session.n_frames())?)?;
    let output = options.out.as_deref().map(take).transpose()?;
    let mut alignments = match options.asked() {
        Some(asked) if asked.ratio == Ratio::Given => {
            Alignments::new(session.scene(), asked).with_lens(options.lens)
        }
        _ => alignments(session, options)?,
    };
    let into = (output, &mut alignments);
    replay_into((session, truth), core, options, into, progress)
}

/// The same with given corrections; further frames are aligned as they come. `core` makes the first preset's pictures.
///
/// # Errors
/// As [`replay`].
pub fn replay_aligned(
    (session, truth): (&dyn Session, Option<&dyn GroundTruth>),
    core: &mut Core,
    options: &Options,
    alignments: &mut Alignments,
    progress: &mut dyn Progress,
) -> Result<Vec<Report>, ReplayError> {
    let output = options.out.as_deref().map(take).transpose()?;
    replay_into((session, truth), core, options, (output, alignments), progress)
}

fn replay_into(
    (session, truth): (&dyn Session, Option<&dyn GroundTruth>),
    core: &mut Core,
    options: &Options,
    (output, alignments): (Option<Rc<OutputFolder>>, &mut Alignments),
    progress: &mut dyn Progress,
) -> Result<Vec<Report>, ReplayError> {
    let indices = options.frames.within(session.n_frames())?;
    let others = options.presets.iter().skip(1);
    let mut others: Vec<Core> = others.map(|_| core.beside()).collect();
    let runs = options.presets.iter().zip(iter::once(core).chain(&mut others));
    let runs = runs
        .map(|(preset, core)| Run::new(*preset, core, options, output.as_ref()))
        .collect::<Result<Vec<_>, _>>()?;
    let presets: Vec<&str> = options.presets.iter().map(|preset| preset.name()).collect();
    let title = format!("{} with {}", session.scene().name, presets.join(", "));
    progress.start(&title, indices.len() * runs.len());
    let mut replay = Replay {
        session,
        truth,
        runs,
        page: output.as_ref().map(Page::new),
    };
    for (n_frames, index) in indices.enumerate() {
        if let Err(reason) = replay.frame(index, alignments, progress) {
            return Err(replay.ended(n_frames, reason, alignments));
        }
    }
    let reports = replay.reports(None, alignments)?;
    progress.finish();
    Ok(reports)
}

/// All presets, and the page of their pictures.
struct Replay<'a> {
    session: &'a dyn Session,
    truth: Option<&'a dyn GroundTruth>,
    runs: Vec<Run<'a>>,
    page: Option<Page>,
}

impl Replay<'_> {
    /// Makes a frame with each preset.
    fn frame(
        &mut self,
        index: usize,
        alignments: &mut Alignments,
        progress: &mut dyn Progress,
    ) -> Result<(), ReplayError> {
        let session = self.session;
        let frame = session.frame(index)?;
        alignments.align(session.scene(), index, &frame)?;
        let photograph = session.photograph(index)?;
        let truth = self.truth.map(|truth| truth.truth(index)).transpose()?.flatten();
        let failed = |reason| ReplayError::Score { index, reason };
        let floor = truth.as_ref().map(|truth| floor(&photograph, truth));
        let shot = Shot {
            floor_rmse: floor.transpose().map_err(failed)?.flatten(),
            session,
            alignments,
            index,
            frame,
            truth,
        };
        let entries = self.runs.iter_mut().map(|run| run.frame(&shot));
        let entries = entries.collect::<Result<Vec<_>, _>>()?;
        if let Some(page) = &mut self.page {
            page.add(index, photograph, shot.truth)?;
        }
        for (run, entry) in self.runs.iter_mut().zip(entries) {
            progress.frame(run.preset, &entry);
            run.frames.push(entry);
        }
        Ok(())
    }

    /// The reports, which are written with the page.
    fn reports(self, ended: Option<String>, alignments: &Alignments) -> Result<Vec<Report>, ReplayError> {
        let runs = self.runs.into_iter();
        let reports = runs.map(|run| run.report(self.session, ended.as_deref(), alignments));
        let reports = reports.collect::<Result<Vec<_>, _>>()?;
        if let Some(page) = self.page {
            page.write(self.session.scene(), &reports)?;
        }
        Ok(reports)
    }

    /// Writes report and page of the frames before an error, if possible.
    fn ended(self, n_frames: usize, reason: ReplayError, alignments: &Alignments) -> ReplayError {
        if n_frames == 0 || self.page.is_none() {
            return reason;
        }
        match self.reports(Some(reason.to_string()), alignments) {
            Ok(_) => ReplayError::Ended {
                n_frames,
                reason: Box::new(reason),
            },
            Err(_) => reason,
        }
    }
}

/// A frame as all presets receive it.
pub(crate) struct Shot<'a> {
    pub(crate) session: &'a dyn Session,
    pub(crate) alignments: &'a Alignments,
    pub(crate) index: usize,
    pub(crate) frame: SessionFrame,
    pub(crate) truth: Option<Truth>,
    /// The part of an error that is noise and rounding alone.
    floor_rmse: Option<f64>,
}

impl Shot<'_> {
    /// The core's input.
    pub(crate) fn input(&self, preset: Preset) -> FrameInput {
        self.alignments.input(self.index, &self.frame, preset)
    }

    fn failed(&self, reason: CoreError) -> ReplayError {
        ReplayError::Frame {
            index: self.index,
            reason,
        }
    }
}

/// Destination of one preset's pictures.
struct Out {
    output: Rc<OutputFolder>,
    /// Prefix of file names; empty, or ends in `/`.
    prefix: String,
    maps: Pictures,
}

impl Out {
    fn new(output: &Rc<OutputFolder>, prefix: String) -> Self {
        Self {
            output: Rc::clone(output),
            maps: Pictures::new(output, &prefix, MAPS_FOLDER),
            prefix,
        }
    }

    fn write_picture(&self, name: &str, picture: &Image) -> Result<(), WriteError> {
        let file = format!("{}{name}", self.prefix);
        let png = self.output.write_png(&file, picture)?;
        values::write(&self.output, &file, &png)
    }

    fn write_report(&self, report: &Report) -> Result<(), WriteError> {
        let file = format!("{}{REPORT_FILE}", self.prefix);
        let mut json = serde_json::to_vec_pretty(report).map_err(|error| WriteError {
            path: self.output.root().join(&file),
            reason: error.to_string(),
        })?;
        json.push(b'\n');
        self.output.write(&file, &json)
    }
}

/// The replay with one preset.
struct Run<'a> {
    preset: Preset,
    core: &'a mut Core,
    quality_reductions: &'static [QualityStep],
    out: Option<Out>,
    follower: Follower,
    frames: Vec<FrameEntry>,
}

impl<'a> Run<'a> {
    fn new(
        preset: Preset,
        core: &'a mut Core,
        options: &Options,
        output: Option<&Rc<OutputFolder>>,
    ) -> Result<Self, ReplayError> {
        core.time_passes(true)?;
        let prefix = folder_of(preset.name(), options.presets.len());
        Ok(Self {
            preset,
            core,
            quality_reductions: options.quality_reductions,
            out: output.map(|output| Out::new(output, prefix)),
            follower: Follower::default(),
            frames: Vec::new(),
        })
    }

    fn set_scene(&mut self, scene: Scene) -> Result<(), CoreError> {
        self.core.set_scene(scene, self.preset)?;
        self.core.set_quality_reductions(self.quality_reductions)
    }

    fn frame(&mut self, shot: &Shot<'_>) -> Result<FrameEntry, ReplayError> {
        let scene = shot.session.scene();
        if let Some(changed) = shot.alignments.changed_scene(scene, shot.index) {
            self.set_scene(changed)?;
        } else if self.frames.is_empty() {
            self.set_scene(shot.alignments.scene(scene))?;
        }
        let (mut entry, picture) = self.make(shot)?;
        if let Some(truth) = &shot.truth {
            let index = shot.index;
            let failed = |reason| ReplayError::Score { index, reason };
            entry.scores = Some(score(&picture, truth).map_err(failed)?);
            entry.flicker = self.follower.next(index, &picture, truth).map_err(failed)?;
        }
        self.write(shot, &mut entry, &picture)?;
        Ok(entry)
    }

    /// Makes the picture and the part of its entry that needs no truth.
    fn make(&mut self, shot: &Shot<'_>) -> Result<(FrameEntry, Image), ReplayError> {
        let failed = |reason| shot.failed(reason);
        let input = shot.input(self.preset);
        let start = Instant::now();
        let report = self.core.frame(&input).map_err(failed)?;
        let cpu = start.elapsed();
        let picture = self.core.read_picture().map_err(failed)?;
        let wall = start.elapsed();
        let times = self.core.read_pass_times().map_err(failed)?;
        let warnings = shot.frame.warnings.iter().map(ToString::to_string);
        let doubts = doubts::of_frame(shot.session.scene(), shot.index, &shot.frame);
        let entry = FrameEntry {
            index: shot.index,
            time_secs: shot.frame.time_secs,
            picture: None,
            error: None,
            maps: Vec::new(),
            gpu_ms: (!times.is_empty()).then(|| times.iter().map(|time| time.gpu_ms).sum()),
            cpu_ms: ms(cpu),
            wall_ms: ms(wall),
            pass_times: times,
            session_warnings: warnings.chain(doubts).collect(),
            report,
            alignment: shot.alignments.of(shot.index).map(AlignmentEntry::from),
            sharpness: input.sharpness.into(),
            gloss: GlossEntry::of(&input.gloss),
            reflection: input.reflection.map(Into::into),
            scores: None,
            floor_rmse: shot.floor_rmse,
            flicker: None,
        };
        Ok((entry, through_lens(shot.session, shot.index, picture)?))
    }

    /// Writes the picture, its error and the maps, if pictures are written.
    fn write(&mut self, shot: &Shot<'_>, entry: &mut FrameEntry, picture: &Image) -> Result<(), ReplayError> {
        let Some(out) = &mut self.out else {
            return Ok(());
        };
        let name = picture_file(shot.index);
        out.write_picture(&name, picture)?;
        entry.picture = Some(name);
        if let Some(truth) = &shot.truth {
            let error = false_color::error(picture, &truth.image);
            entry.error = Some(out.maps.write(ERROR.name, shot.index, error.into())?);
        }
        entry.maps = write_lights(&mut out.maps, shot, self.preset)?;
        if let Some(region) = entry.report.region {
            entry
                .maps
                .extend(write_maps(&mut out.maps, shot, self.core, region)?);
        }
        Ok(())
    }

    fn report(
        self,
        session: &dyn Session,
        ended: Option<&str>,
        alignments: &Alignments,
    ) -> Result<Report, ReplayError> {
        let scene = session.scene();
        let fit = of_core(self.core.read_fit(), ended)?.flatten();
        let report = Report {
            session: scene.name.clone(),
            preset: self.preset.name(),
            adapter: self.core.adapter_name(),
            is_software: self.core.is_software(),
            size_px: [scene.width_px, scene.height_px],
            warnings: warnings_of(session, self.core, ended)?,
            ended: ended.map(str::to_owned),
            lens: alignments.lens().copied(),
            mean: Mean::of(&self.frames),
            mean_of_moving: Mean::of_moving(&self.frames),
            fit: fit.map(|fit| FitEntry::new(&fit, alignments.n_lights(scene, self.preset))),
            frames: self.frames,
        };
        if let Some(out) = &self.out {
            out.write_report(&report)?;
        }
        Ok(report)
    }
}

fn write_maps(
    pictures: &mut Pictures,
    shot: &Shot<'_>,
    core: &Core,
    region: PixelRect,
) -> Result<Vec<MapEntry>, ReplayError> {
    let mut entries = Vec::new();
    let scene = shot.session.scene();
    for map in Map::ALL {
        let values = core.read_map(*map).map_err(|reason| shot.failed(reason))?;
        if let (Some(shown), Some(values)) = (describe(*map), values) {
            let picture = false_color::picture(*map, &values, region, [scene.width_px, scene.height_px]);
            let picture = map_through_lens(shot.session, shot.index, picture)?;
            let file = pictures.write(shown.name, shot.index, picture.into())?;
            entries.push(MapEntry {
                name: shown.name,
                file,
            });
        }
    }
    Ok(entries)
}

fn warnings_of(session: &dyn Session, core: &Core, ended: Option<&str>) -> Result<Vec<String>, CoreError> {
    let of_fit = of_core(core.read_fit_warnings(), ended)?;
    let ended = ended.map(|reason| format!("the replay ended before its last frame: {reason}"));
    let of_session = session.warnings().iter().map(ToString::to_string);
    let of_values = doubts::of_scene(session.scene());
    Ok(ended
        .into_iter()
        .chain(of_session)
        .chain(of_values)
        .chain(of_fit.iter().flatten().map(ToString::to_string))
        .collect())
}

/// The answer of a core; empty if it fails after the replay has ended, for example because the device is lost.
fn of_core<T>(answer: Result<T, CoreError>, ended: Option<&str>) -> Result<Option<T>, CoreError> {
    answer.map(Some).or_else(|error| ended.map(|_| None).ok_or(error))
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
