//! The results of a replay as `report.json` has them: the core's own reports, in their units. The
//! order of the fields is the order in the file, and a number that is not finite is null there.

use app_core::alignment::{AlignmentReport, AlignmentWarning, LensAlignment};
use app_core::frame::{FrameReport, PassGroup, PassTime};
use app_core::gloss::{Gloss, N_GLOSSES};
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
    /// Name of the session, or empty.
    pub session: String,
    /// Name of the preset.
    pub preset: &'static str,
    /// Name of the adapter and of its driver.
    pub adapter: String,
    /// Whether the adapter is a software renderer, whose times do not apply to a graphics card.
    pub is_software: bool,
    /// Size of every picture, width first.
    pub size_px: [u32; 2],
    /// Warnings about the session as a whole.
    pub warnings: Vec<String>,
    /// The reason why frames are missing; `None` if the replay is complete.
    pub ended: Option<String>,
    /// The estimate of the lens that is removed from photographs; `None` if it was not asked for.
    pub lens: Option<LensAlignment>,
    /// Means over frames.
    pub mean: Mean,
    /// Means over retargeted frames: frames that passed through have no error of ours, and are left
    /// out.
    pub mean_of_moving: Mean,
    /// Parameters learned from the real shadow, as of the last frame; `None` if nothing was
    /// learned.
    pub fit: Option<FitEntry>,
    /// One entry per replayed frame.
    pub frames: Vec<FrameEntry>,
}

/// Means over frames.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Mean {
    /// Frames that have a truth.
    pub n_scored: usize,
    /// Mean of their scores; `None` if there are none.
    pub scores: Option<Scores>,
    /// Mean flicker over frames of which the previous one has a truth as well; `None` if there are
    /// none.
    pub flicker: Option<Flicker>,
    /// Mean of their floors; `None` if there are none.
    pub floor_rmse: Option<f64>,
    /// Number of steady frames: a region was retargeted and nothing was learned anew.
    pub n_steady: usize,
    /// Mean of their device time, if each has one.
    pub gpu_ms: Option<f64>,
    /// Mean of their time on the processor.
    pub cpu_ms: Option<f64>,
    /// Mean of their time until the picture was read back.
    pub wall_ms: Option<f64>,
    /// Mean processor time of alignment over all frames; `None` if nothing was aligned.
    pub align_ms: Option<f64>,
}

/// One frame.
#[derive(Clone, Debug, Serialize)]
pub struct FrameEntry {
    /// Its place in the session, from 0.
    pub index: usize,
    /// Time of the photograph.
    pub time_secs: f64,
    /// File name of its picture; `None` if pictures are not written.
    pub picture: Option<String>,
    /// File of its false-colour error against the truth, if there is one and pictures are written.
    pub error: Option<String>,
    /// The maps between input and picture, if pictures are written and a region was retargeted.
    pub maps: Vec<MapEntry>,
    /// Device time of all passes; `None` if the device has no timestamps.
    pub gpu_ms: Option<f64>,
    /// Processor time of the core until the device has the frame.
    pub cpu_ms: f64,
    /// Time until the picture was back in memory, including waiting for the device and copying.
    pub wall_ms: f64,
    /// Device time of each pass; empty if the device has no timestamps.
    pub pass_times: Vec<PassTime>,
    /// Warnings about the frame as it was recorded.
    pub session_warnings: Vec<String>,
    /// The core's report.
    #[serde(flatten)]
    pub report: FrameReport,
    /// The alignment's results; `None` if the session is replayed as recorded.
    pub alignment: Option<AlignmentEntry>,
    /// Measured softness of the picture.
    pub sharpness: SharpnessEntry,
    /// Measured gloss of the toy; `None` if it is matt.
    pub gloss: Option<GlossEntry>,
    /// Estimated reflection of the receiver below the toy; `None` if it counts as matt.
    pub reflection: Option<ReflectionEntry>,
    /// Error against the truth, if there is one.
    pub scores: Option<Scores>,
    /// RMSE of the camera frame against the truth outside of both shadows, where they show the
    /// same: the noise of both and their rounding, which is a lower bound of the error of any
    /// picture made from that frame; `None` without a truth.
    pub floor_rmse: Option<f64>,
    /// Flicker since the previous frame, if both have a truth.
    pub flicker: Option<Flicker>,
}

/// Softness of a picture: standard deviations along the two axes of the blur, the wider first, in
/// pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SharpnessEntry {
    /// The blur that makes the plates as soft.
    pub plate_px: [f64; 2],
    /// The blur that makes a sharp outline as soft.
    pub outline_px: [f64; 2],
}

/// Reflection of a receiver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReflectionEntry {
    /// Width of the lobe, as Beckmann's alpha.
    pub roughness: f64,
    /// Linear light of the surroundings that it reflects.
    pub surroundings: [f32; 3],
    /// Light of the toy less that of the surroundings.
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

/// Gloss of a toy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GlossEntry {
    /// Roughness of its surface: root mean square slope of its facets, times the square root of 2.
    pub roughness: f32,
    /// Reflectance of each of its first materials, relative to smooth plastic.
    pub strengths: [f32; N_GLOSSES],
}

impl GlossEntry {
    /// The entry of a toy; `None` if it is matt.
    #[must_use]
    pub fn of(gloss: &Gloss) -> Option<Self> {
        let Gloss { roughness, strengths } = *gloss;
        (!gloss.is_none()).then_some(Self { roughness, strengths })
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

/// Parameters of the fit, each as linear red, green and blue.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FitEntry {
    /// Frame over plate at unchanged places: the exposure ratio.
    pub gain: [f32; 3],
    /// Light reflected by the toy at places where it blocks ambient light, as a fraction of the
    /// blocked light.
    pub bounce: [f32; 3],
    /// Each light's share of the plate's radiance at the reference point.
    pub direct_fraction: Vec<[f32; 3]>,
    /// Radiance of the toy over its base colour: from above, from below, and from each light at
    /// normal incidence.
    pub toy: Vec<[f32; 3]>,
}

/// Results of alignment in one frame.
#[derive(Clone, Debug, Serialize)]
pub struct AlignmentEntry {
    /// Processor time of alignment.
    pub cpu_ms: f64,
    /// The core's report.
    #[serde(flatten)]
    pub report: AlignmentReport,
    /// Failures of parts of the alignment.
    pub warnings: Vec<AlignmentWarning>,
    /// Number of lights on the session's list, if that was ignored.
    pub n_listed: usize,
    /// Each light estimated from a probe, against the nearest light of that list, as seen from the
    /// probe.
    pub probe_against_listed: Vec<Option<LightError>>,
    /// The same for the lights that were found by their shadows, as seen from the toy's centre.
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
            probe_against_listed: told.map(|light| aligned.error_of_probe_light(light)).collect(),
            discovered_against_listed: discovered
                .map(|light| aligned.error_of_estimated(light))
                .collect(),
            report: report.clone(),
        }
    }
}

impl FrameEntry {
    /// All warnings: of the session, of alignment and of the core.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let of_session = self.session_warnings.iter().cloned();
        let of_alignment = self.alignment.iter().flat_map(|aligned| &aligned.warnings);
        of_session
            .chain(of_alignment.map(ToString::to_string))
            .chain(self.report.warnings.iter().map(ToString::to_string))
    }

    /// Whether it was retargeted rather than passed through.
    #[must_use]
    pub fn is_retargeted(&self) -> bool {
        self.report.region.is_some()
    }

    /// The reason why it was passed through; `None` if it was retargeted.
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

    /// Means over the retargeted ones of `frames`.
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

/// The mean of scores, region by region; `None` of an empty list.
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
