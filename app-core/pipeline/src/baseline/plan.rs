//! The plan of the baseline.

use crate::geometry::rect::PixelRect;
use crate::plan::{SceneFacts, SkippedWork};
use crate::preset::BaselineSettings;
use app_scene::scene::MAX_LIGHTS;

/// A plan of the baseline.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BaselinePlan {
    /// The work region.
    pub(crate) region: PixelRect,
    /// Number of lights whose shadows are retargeted, at most four.
    pub(crate) n_lights: u32,
    /// Number of receivers, each of which is retargeted separately.
    pub(crate) n_receivers: u32,
    /// Number of non-empty sets of these lights. If the shadows of a set overlap, the overlap has
    /// an appearance of its own.
    pub(crate) n_sets: u32,
    /// Whether the real shadow is sampled: not if there is none, or for a shadow of constant strength.
    pub(crate) is_sampled: bool,
    /// Work that the scene does not need.
    pub(crate) skipped: Vec<SkippedWork>,
}

impl BaselinePlan {
    /// Plans a scene. Lights beyond the fourth are left out.
    pub(crate) fn new(facts: &SceneFacts, settings: &BaselineSettings) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "at most four")]
        let n_lights = facts.penumbrae_px.len().min(MAX_LIGHTS) as u32;
        let not_sampled = match (settings.constant_ratio, n_lights) {
            (Some(_), _) => Some("the preset's shadow is constant"),
            (None, 0) => Some("there is no light"),
            (None, _) => None,
        };
        let skipped = not_sampled.map(|reason| SkippedWork {
            what: "samples of the real shadow",
            reason,
        });
        Self {
            region: facts.region,
            n_lights,
            n_receivers: facts.n_receivers,
            n_sets: (1 << n_lights) - 1,
            is_sampled: not_sampled.is_none(),
            skipped: skipped.into_iter().collect(),
        }
    }
}
