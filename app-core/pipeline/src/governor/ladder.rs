//! The quality ladder: quality reductions in the order in which each adds the least error for the time it saves.

use crate::preset::ModelSettings;

/// A setting that a quality step reduces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum QualitySetting {
    /// Region pixels per texel of the ambient map, along each side.
    AmbientDivisor,
    /// Directions of ambient light.
    AmbientDirections,
    /// Points over each light.
    LightPoints,
    /// Number of positions within a pixel at which the toy's outline is sampled.
    CoveragePositions,
    /// Frames a second.
    FramesPerSecond,
}

/// A quality step: one setting and its reduced value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QualityStep {
    /// The setting that is reduced.
    pub setting: QualitySetting,
    /// The setting's value from this step on.
    pub value: u32,
    /// Expected load after the step over the load before it, 0 to 1.
    pub gain: f64,
    /// The text that is shown to a person.
    pub what: &'static str,
}

/// The quality ladder of preset `balanced`.
///
/// The steps are ordered by the error that each adds for the time it saves. The expected gain of a
/// step is the mean of the ledger's ratios of triangles and of bytes, for a new pose, one light
/// with a wide penumbra and 10,000 triangles; once a step was taken, the governor knows its gain
/// better. The step to 32 points has no effect if no light has more.
#[rustfmt::skip] // One step a line.
pub const BALANCED_QUALITY_LADDER: &[QualityStep] = &[
    QualityStep { setting: QualitySetting::AmbientDivisor, value: 8, gain: 0.99, what: "ambient shadow is drawn at an eighth of the resolution" },
    QualityStep { setting: QualitySetting::AmbientDirections, value: 32, gain: 0.90, what: "ambient shadow is drawn from 32 directions" },
    QualityStep { setting: QualitySetting::LightPoints, value: 32, gain: 0.88, what: "shadows are drawn from 32 points of each light" },
    QualityStep { setting: QualitySetting::LightPoints, value: 16, gain: 0.92, what: "shadows are drawn from 16 points of each light" },
    QualityStep { setting: QualitySetting::AmbientDirections, value: 16, gain: 0.91, what: "ambient shadow is drawn from 16 directions" },
    QualityStep { setting: QualitySetting::CoveragePositions, value: 16, gain: 0.95, what: "the toy's outline is drawn from 16 positions in each pixel" },
    QualityStep { setting: QualitySetting::FramesPerSecond, value: 30, gain: 0.5, what: "30 frames are shown a second" },
];

impl QualityStep {
    /// Reduces a setting that is finer than this step; the frame rate is not a setting of the
    /// model.
    pub fn apply(&self, settings: &mut ModelSettings) {
        let points = self.value as usize;
        match self.setting {
            QualitySetting::AmbientDivisor => {
                settings.ambient_divisor = settings.ambient_divisor.max(self.value);
            }
            QualitySetting::AmbientDirections => {
                settings.n_ambient_directions = settings.n_ambient_directions.min(points);
            }
            QualitySetting::LightPoints => {
                settings.n_light_points = settings.n_light_points.min(points);
                settings.n_narrow_light_points = settings.n_narrow_light_points.min(points);
            }
            QualitySetting::CoveragePositions => {
                settings.n_coverage_positions = settings.n_coverage_positions.min(self.value);
            }
            QualitySetting::FramesPerSecond => {}
        }
    }
}
