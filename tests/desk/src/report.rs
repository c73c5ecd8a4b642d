//! What a replay found out, as it stands in `report.json`: the core's own reports, in their units. The order of the fields is the
//! order in the file, and a number that is not finite is null there.

use app_core::alignment::{AlignmentReport, AlignmentWarning, LensAlignment};
use app_core::frame::{FrameReport, PassGroup, PassTime};
use app_core::reflection::Reflection;
use app_core::scene::MAX_LIGHTS;
use app_core::sharpness::{Sharpness, Spread};
use app_pipeline::model::state::solution::Fit;
use serde::Serialize;

use crate::alignment::{Aligned, LightError};
use crate::metrics::flicker::{Flicker, mean_flicker};
use crate::metrics::{Score, Scores};

/// A replay of one session.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name of the session; may be empty.
    pub session: String,
    /// Name of the preset.
    pub preset: &'static str,
    /// Name of the adapter and of its driver.
    pub adapter: String,
    /// Whether the adapter is a processor: its times then say nothing about a graphics card.
    pub is_software: bool,
    /// Size of every picture, width first.
    pub size_px: [u32; 2],
    /// What was odd about the session as a whole.
    pub warnings: Vec<String>,
    /// Why there are not all frames that were asked for; none if there are.
    pub ended: Option<String>,
    /// The lens that photographs were freed of; none where nobody asked for it.
    pub lens: Option<LensAlignment>,
    /// Means over frames.
    pub mean: Mean,
    /// The same over frames that were worked on: those that passed through, whose error is none of ours, are left out.
    pub mean_of_moving: Mean,
    /// What was learned from the real shadow, as of the last frame; none where nothing was learned.
    pub fit: Option<FitEntry>,
    /// One entry a replayed frame.
    pub frames: Vec<FrameEntry>,
}

/// Means over frames.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Mean {
    /// Frames that have a truth.
    pub n_scored: usize,
    /// Mean of their scores; none where there are none.
    pub scores: Option<Scores>,
    /// Mean flicker over frames of which that before has a truth as well; none where there are none.
    pub flicker: Option<Flicker>,
    /// Mean of their floors; none if there are none.
    pub floor_rmse: Option<f64>,
    /// Steady frames: a region was worked on and nothing was learned anew.
    pub n_steady: usize,
    /// Mean of their device time, where each has one.
    pub gpu_ms: Option<f64>,
    /// Mean of their time on the processor.
    pub cpu_ms: Option<f64>,
    /// Mean of their time until the picture was read back.
    pub wall_ms: Option<f64>,
    /// Mean time that alignment took on the processor, over all frames; none where nothing was aligned.
    pub align_ms: Option<f64>,
}

/// One frame.
#[derive(Clone, Debug, Serialize)]
pub struct FrameEntry {
    /// Its place in the session, from 0.
    pub index: usize,
    /// When it was taken.
    pub time_secs: f64,
    /// File name of its picture; none where pictures are not written.
    pub picture: Option<String>,
    /// File of its false-colour error against the truth, where there is one and pictures are written.
    pub error: Option<String>,
    /// The maps between input and picture, where pictures are written and a region was worked on.
    pub maps: Vec<MapEntry>,
    /// Device time of all passes; none where the device cannot tell.
    pub gpu_ms: Option<f64>,
    /// Time that the core took on the processor to hand the frame to the device.
    pub cpu_ms: f64,
    /// Time until the picture was back in memory, waiting for the device and copying included.
    pub wall_ms: f64,
    /// Device time of each pass; empty where the device cannot tell.
    pub pass_times: Vec<PassTime>,
    /// What was odd about the frame as it was recorded.
    pub session_warnings: Vec<String>,
    /// The core's report.
    #[serde(flatten)]
    pub report: FrameReport,
    /// What alignment found; none where the session is replayed as recorded.
    pub alignment: Option<AlignmentEntry>,
    /// How soft the picture was measured to be.
    pub sharpness: SharpnessEntry,
    /// How the receiver that the toy stands on was found to reflect; none where it is taken for matt.
    pub reflection: Option<ReflectionEntry>,
    /// Error against the truth, where there is one.
    pub scores: Option<Scores>,
    /// RMSE of the camera frame against the truth beyond both shadows, where they show the same: the noise of both and their
    /// rounding, below which no error of a picture that is made of that frame can be expected; none without a truth.
    pub floor_rmse: Option<f64>,
    /// Flicker since the frame before, where both have a truth.
    pub flicker: Option<Flicker>,
}

/// How soft a picture is: deviations of the two axes of a spread, the wider first, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SharpnessEntry {
    /// What makes the plates as soft.
    pub plate_px: [f64; 2],
    /// What makes a sharp outline as soft.
    pub outline_px: [f64; 2],
}

/// How a receiver reflects.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReflectionEntry {
    /// Width of the lobe, as Beckmann's alpha.
    pub roughness: f64,
    /// Linear light of the surroundings that it reflects.
    pub surroundings: [f32; 3],
    /// What the toy's is above it.
    pub toy_above_surroundings: [f32; 3],
}

impl From<Reflection> for ReflectionEntry {
    fn from(reflection: Reflection) -> Self {
        Self {
            roughness: reflection.roughness,
            surroundings: reflection.surroundings,
            toy_above_surroundings: reflection.toy_above_surroundings,
        }
    }
}

impl From<Sharpness> for SharpnessEntry {
    fn from(sharpness: Sharpness) -> Self {
        let axes_px = |spread: Spread| spread.axes_px().map(|axis| axis.length());
        Self {
            plate_px: axes_px(sharpness.plate_spread),
            outline_px: axes_px(sharpness.outline_spread),
        }
    }
}

/// A map as a picture of the whole frame.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MapEntry {
    /// Name of the map.
    pub name: &'static str,
    /// Its file; frames with equal maps share one.
    pub file: String,
}

/// What the fit learned, each as linear red, green and blue.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitEntry {
    /// Frame over plate where nothing changed: the exposure between the two.
    pub gain: [f32; 3],
    /// Light thrown back by the toy where it takes ambient light away, as a fraction of that light.
    pub bounce: [f32; 3],
    /// Each light's share of the plate's radiance at the reference point.
    pub direct_fraction: Vec<[f32; 3]>,
    /// Radiance of the toy over its base colour: from above, from below, and each light's where it falls straight on.
    pub toy: Vec<[f32; 3]>,
}

/// What alignment found in one frame.
#[derive(Clone, Debug, Serialize)]
pub struct AlignmentEntry {
    /// Time that it took on the processor.
    pub cpu_ms: f64,
    /// The core's report.
    #[serde(flatten)]
    pub report: AlignmentReport,
    /// What could not be aligned.
    pub warnings: Vec<AlignmentWarning>,
    /// Lights on the session's list, where that was put aside.
    pub n_listed: usize,
    /// Each light that a probe tells, against the nearest light of that list, as seen from the probe.
    pub probe_against_listed: Vec<Option<LightError>>,
    /// The same of the lights that were found by their shadows, as seen from the toy's middle.
    pub discovered_against_listed: Vec<Option<LightError>>,
}

impl From<&Aligned> for AlignmentEntry {
    fn from(aligned: &Aligned) -> Self {
        let report = &aligned.alignment.report;
        let told = report.probe.iter().flat_map(|probe| &probe.lights);
        let discovered = report.discovered.iter();
        Self {
            cpu_ms: aligned.cpu_ms,
            warnings: aligned.alignment.warnings.clone(),
            n_listed: aligned.put_aside.len(),
            probe_against_listed: told.map(|light| aligned.error_of_told(light)).collect(),
            discovered_against_listed: discovered
                .map(|light| aligned.error_of_discovered(light))
                .collect(),
            report: report.clone(),
        }
    }
}

impl FrameEntry {
    /// Everything that was odd: of the session, of alignment and of the core.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let of_session = self.session_warnings.iter().cloned();
        let of_alignment = self.alignment.iter().flat_map(|aligned| &aligned.warnings);
        of_session
            .chain(of_alignment.map(ToString::to_string))
            .chain(self.report.warnings.iter().map(ToString::to_string))
    }

    /// Whether it was worked on rather than passed through.
    #[must_use]
    pub fn is_retargeted(&self) -> bool {
        self.report.region.is_some()
    }

    /// Why it was passed through; none if it was worked on.
    #[must_use]
    pub fn reason_to_pass(&self) -> Option<&'static str> {
        let reason = self.report.skipped.iter().map(|skipped| skipped.reason).next();
        (!self.is_retargeted()).then(|| reason.unwrap_or("no reason was given"))
    }

    /// Whether nothing was learned anew, so that its times are those of a frame in the long run.
    #[must_use]
    pub fn is_steady(&self) -> bool {
        self.is_retargeted() && self.report.ran.iter().all(|run| run.path != PassGroup::Capture)
    }
}

impl Mean {
    /// Means over `frames`.
    #[must_use]
    pub fn of(frames: &[FrameEntry]) -> Self {
        Self::of_all(&frames.iter().collect::<Vec<_>>())
    }

    /// Means over those of `frames` that were worked on.
    #[must_use]
    pub fn of_moving(frames: &[FrameEntry]) -> Self {
        let moving = frames.iter().filter(|frame| frame.is_retargeted());
        Self::of_all(&moving.collect::<Vec<_>>())
    }

    fn of_all(frames: &[&FrameEntry]) -> Self {
        let scores: Vec<Scores> = frames.iter().filter_map(|frame| frame.scores).collect();
        let flicker: Vec<Flicker> = frames.iter().filter_map(|frame| frame.flicker).collect();
        let floors: Vec<f64> = frames.iter().filter_map(|frame| frame.floor_rmse).collect();
        let steady: Vec<&FrameEntry> = frames.iter().copied().filter(|frame| frame.is_steady()).collect();
        let aligned = frames.iter().filter_map(|frame| frame.alignment.as_ref());
        let align_ms: Vec<f64> = aligned.map(|alignment| alignment.cpu_ms).collect();
        let gpu_ms: Option<Vec<f64>> = steady.iter().map(|frame| frame.gpu_ms).collect();
        Self {
            n_scored: scores.len(),
            scores: mean_scores(&scores),
            flicker: mean_flicker(&flicker),
            floor_rmse: mean(floors.into_iter()),
            n_steady: steady.len(),
            gpu_ms: gpu_ms.and_then(|times| mean(times.into_iter())),
            cpu_ms: mean(steady.iter().map(|frame| frame.cpu_ms)),
            wall_ms: mean(steady.iter().map(|frame| frame.wall_ms)),
            align_ms: mean(align_ms.into_iter()),
        }
    }
}

/// The mean of scores, region by region; none of none.
#[must_use]
pub fn mean_scores(scores: &[Scores]) -> Option<Scores> {
    let region = |region: fn(&Scores) -> Score| {
        Some(Score {
            rmse: mean(scores.iter().map(|scores| region(scores).rmse))?,
            ssim: mean(scores.iter().map(|scores| region(scores).ssim))?,
        })
    };
    Some(Scores {
        shadow: region(|scores| scores.shadow)?,
        toy: region(|scores| scores.toy)?,
        edge: region(|scores| scores.edge)?,
        frame: region(|scores| scores.frame)?,
    })
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> Option<f64> {
    let n_values = values.len() as f64;
    (n_values > 0.0).then(|| values.sum::<f64>() / n_values)
}

impl FitEntry {
    pub(crate) fn new(fit: &Fit, n_lights: usize) -> Self {
        let rgb = |[r, g, b, _]: [f32; 4]| [r, g, b];
        Self {
            gain: rgb(fit.gain),
            bounce: rgb(fit.receivers[0].bounce),
            direct_fraction: fit.receivers[0]
                .direct_fraction
                .iter()
                .take(n_lights.min(MAX_LIGHTS))
                .map(|direct_fraction| rgb(*direct_fraction))
                .collect(),
            toy: fit.toy[..2 + n_lights.min(MAX_LIGHTS)]
                .iter()
                .map(|light| rgb(*light))
                .collect(),
        }
    }
}
