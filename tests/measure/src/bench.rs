//! Speed against error: presets over sessions, timed by the kind of change in a frame, without
//! compilation.

mod basin;
mod claims;
mod exact;
mod front;
mod kinds;
mod names;
mod pull;
mod table;
mod withheld;

use app_core::camera_frame::PlaneError;
use app_core::core::{Core, CoreError};
use app_core::frame::FrameInput;
use app_core::governor::QualityStep;
use app_core::preset::Preset;
use app_core::scene::Scene;
use app_core::session::{Capture, Session};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::Map;

use crate::count::count;
use crate::planar::{BT601_FULL, planar};
use crate::sized::{SizePx, sized_input, sized_scene};
use desk::alignment::{Alignments, Lights, Ratio};
use desk::frames::Frames;
use desk::metrics::Scores;
use desk::metrics::flicker::Flicker;
use desk::progress::Quiet;
use desk::replay;
use desk::replay::{ReplayError, replay_aligned};
use desk::report::Report;

pub use basin::{Draw, PoseAndLightErrors, basin, basin_csv, basin_drawing, basin_table};
pub use claims::{claims_drawing, claims_summary};
pub use front::{Point, front, front_drawing, points};
pub use kinds::{FRAME_KINDS, FrameKind, KindTimes, with_new};
pub use names::file_names;
pub use pull::Pull;
pub(crate) use table::{aligned, quoted};
pub use table::{csv, json, table};
pub use withheld::{Rebuilt, rebuild, rebuilt_table};

/// Presets that are also measured with exact visibility, which separates errors of visibility from
/// all others.
const EXACT_PRESETS: &[Preset] = &[Preset::Paper, Preset::Balanced];

/// Options of a measurement.
#[derive(Clone, Debug)]
pub struct Options {
    /// The presets, in the order of the rows.
    pub presets: Vec<Preset>,
    /// Whether to add rows with the governor's quality steps off `balanced`, one after the other.
    pub with_front: bool,
    /// Number of timings of each frame; at least 1.
    pub n_repeats: usize,
    /// The frames to measure.
    pub frames: Frames,
    /// Size of the pictures that are timed and counted, by default the session's own; errors are
    /// always the session's.
    pub size_px: Option<SizePx>,
    /// Whether pictures are planes, as on phones, rather than pixels.
    pub as_planes: bool,
    /// Whether to add rows with ray-traced visibility, which takes minutes.
    pub with_exact: bool,
    /// Whether cameras, toy and lights are first aligned by the pictures; never with exact
    /// visibility.
    pub is_aligned: bool,
    /// The source of the lights for alignment.
    pub lights: Lights,
    /// The number that alignment estimates.
    pub ratio: Ratio,
}

/// The result of one preset on one session.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the session.
    pub session: String,
    /// Name of the preset, followed by `+exact` for exact visibility.
    pub preset: String,
    /// Number of frames.
    pub n_frames: usize,
    /// Mean scores over those frames that have a truth.
    pub scores: Option<Scores>,
    /// Mean flicker over those frames whose previous frame has a truth as well.
    pub flicker: Option<Flicker>,
    /// Mean processor time of alignment per frame; `None` if nothing was aligned.
    pub align_ms: Option<f64>,
    /// Width and height of the pictures.
    pub size_px: [u32; 2],
    /// Times of each kind of frame; `None` with exact visibility, or if no frame was retargeted.
    pub times: Vec<KindTimes>,
    /// Mean number of candidates of the ring search for a texel that needed it; `None` without a
    /// search.
    pub n_taps: Option<f64>,
}

/// Measures all presets on one session.
///
/// # Errors
/// When a frame cannot be read, made or scored.
pub fn bench(session: &Capture, core: &mut Core, options: &Options) -> Result<Vec<Row>, ReplayError> {
    let mut rows = Vec::new();
    let mut alignments = replay::alignments(session, &replay_options(options))?;
    for &preset in &options.presets {
        rows.push(measure(session, core, (preset, &[]), (options, &mut alignments))?);
    }
    for steps in front::quality_reductions().filter(|_| options.with_front) {
        let setting = (Preset::Balanced, steps);
        rows.push(measure(session, core, setting, (options, &mut alignments))?);
    }
    compare_with_paper(&mut rows);
    if options.with_exact {
        let presets = options
            .presets
            .iter()
            .filter(|preset| EXACT_PRESETS.contains(preset));
        for &preset in presets {
            rows.push(exact::measure(session, core, preset, options)?);
        }
    }
    Ok(rows)
}

/// Divides the time of each kind of frame by the published method's.
fn compare_with_paper(rows: &mut [Row]) {
    let Some(paper) = rows.iter().find(|row| row.preset == Preset::Paper.name()) else {
        return;
    };
    let paper = paper.times.clone();
    for times in rows.iter_mut().flat_map(|row| &mut row.times) {
        let same = paper.iter().find(|paper| paper.kind == times.kind);
        let both = times.frame_ms().zip(same.and_then(KindTimes::frame_ms));
        times.ratio_to_paper = both.map(|(own, paper)| own / paper);
    }
}

fn measure(
    session: &Capture,
    core: &mut Core,
    (preset, quality_reductions): (Preset, &'static [QualityStep]),
    (options, alignments): (&Options, &mut Alignments),
) -> Result<Row, ReplayError> {
    let asked = replay::Options {
        presets: vec![preset],
        quality_reductions,
        ..replay_options(options)
    };
    // Scores do not vary between runs. Pipelines compiled here stay compiled for the timings.
    let mut reports = replay_aligned((session, Some(session)), core, &asked, alignments, &mut Quiet)?;
    // One preset, one report.
    let report = reports.swap_remove(0);
    let inputs = inputs(session, (&report, preset), alignments)?;
    let scene = latest_scene(session.scene(), &report, alignments);
    Ok(Row {
        session: report.session,
        preset: front::named(preset, quality_reductions),
        n_frames: report.frames.len(),
        scores: report.mean.scores,
        flicker: report.mean.flicker,
        align_ms: report.mean.align_ms,
        n_taps: mean_taps(core, &inputs)?,
        size_px: options.size_px.unwrap_or(own_px(session)),
        times: times(scene, core, (preset, quality_reductions), (options, &inputs))?,
    })
}

/// The scene of the last frames of a replay: with the planes that were found, and with the toy and
/// the plates as they were adapted.
fn latest_scene(given: &Scene, report: &Report, alignments: &Alignments) -> Scene {
    let latest_first = report.frames.iter().rev();
    let mut changed = latest_first.filter_map(|frame| alignments.changed_scene(given, frame.index));
    changed.next().unwrap_or_else(|| alignments.scene(given))
}

/// Times and costs in pictures of the requested size.
fn times(
    scene: Scene,
    core: &mut Core,
    (preset, quality_reductions): (Preset, &[QualityStep]),
    (options, inputs): (&Options, &[FrameInput]),
) -> Result<Vec<KindTimes>, ReplayError> {
    let (scene, inputs): (_, Vec<FrameInput>) = match options.size_px {
        Some(size_px) => {
            let inputs = inputs.iter().take(kinds::MOST_INPUTS);
            let scene = sized_scene(&scene, size_px);
            core.set_scene(scene.clone(), preset)?;
            core.set_quality_reductions(quality_reductions)?;
            (scene, inputs.map(|input| sized_input(input, size_px)).collect())
        }
        None => (scene, inputs.to_vec()),
    };
    let inputs = if options.as_planes {
        as_planes(inputs)?
    } else {
        inputs
    };
    let mut times = kinds::measure(core, &inputs, options.n_repeats)?;
    if let Some(first) = inputs.first() {
        for (times, counted) in times
            .iter_mut()
            .zip(count(&scene, (preset, quality_reductions), first)?)
        {
            times.counted = Some(counted);
        }
    }
    Ok(times)
}

/// The same frames as planes.
fn as_planes(inputs: Vec<FrameInput>) -> Result<Vec<FrameInput>, PlaneError> {
    let planes = |input: FrameInput| {
        let image = planar(input.image.rgba(), BT601_FULL)?;
        Ok(input.with_image(image))
    };
    inputs.into_iter().map(planes).collect()
}

fn own_px(session: &Capture) -> SizePx {
    [session.scene().width_px, session.scene().height_px]
}

fn replay_options(options: &Options) -> replay::Options {
    replay::Options {
        presets: options.presets.clone(),
        quality_reductions: &[],
        frames: options.frames,
        out: None,
        is_aligned: options.is_aligned,
        lights: options.lights,
        ratio: options.ratio,
        lens: None,
    }
}

/// The core's inputs of the retargeted frames.
fn inputs(
    session: &Capture,
    (report, preset): (&Report, Preset),
    alignments: &Alignments,
) -> Result<Vec<FrameInput>, ReplayError> {
    let worked = report.frames.iter().filter(|frame| frame.report.region.is_some());
    worked
        .map(|frame| Ok(alignments.input(frame.index, &session.frame(frame.index)?, preset)))
        .collect()
}

fn mean_taps(core: &mut Core, inputs: &[FrameInput]) -> Result<Option<f64>, CoreError> {
    let mut taps = Vec::new();
    for input in inputs {
        core.frame(input)?;
        let map = core.read_map(Map::SearchTaps)?;
        let texels = map.iter().flat_map(|map| &map.texels);
        taps.extend(texels.map(|texel| f64::from(texel[0])).filter(|taps| *taps > 0.0));
    }
    let n_texels = taps.len() as f64;
    Ok((!taps.is_empty()).then(|| taps.iter().sum::<f64>() / n_texels))
}
