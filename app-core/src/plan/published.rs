//! The plan of the published method.

use wgpu::TextureFormat;

use crate::gpu::layout::MAX_LIGHTS;
use crate::preset::PublishedSettings;
use crate::region::PixelRect;

use super::passes::{PUBLISHED_PASSES, PlannedPass, SAMPLING_PASSES};
use super::{LeftOut, SceneFacts, visibility_format};

/// A plan of the published method.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedPlan {
    /// The work region.
    pub region: PixelRect,
    /// Lights whose shadows are moved, at most four.
    pub n_lights: u32,
    /// Receivers that they are moved on, each by itself.
    pub n_receivers: u32,
    /// Sets of these lights, the empty one left out: each has an appearance of its own where its shadows overlap.
    pub n_sets: u32,
    /// Format of the visibility map, one channel a light.
    pub visibility_format: TextureFormat,
    /// The passes in the order they run.
    pub passes: Vec<PlannedPass>,
    /// What the scene does not need.
    pub left_out: Vec<LeftOut>,
}

impl PublishedPlan {
    /// Plans a scene. Lights beyond the fourth are left out.
    #[must_use]
    pub fn new(facts: &SceneFacts, settings: &PublishedSettings) -> Self {
        let is_constant = settings.constant_ratio.is_some();
        let mut left_out = Vec::new();
        if is_constant {
            left_out.push(LeftOut {
                what: "samples of the real shadow",
                why: "the preset's shadow is constant",
            });
        }
        let lights = facts.penumbra_px.iter().take(MAX_LIGHTS);
        let n_lights = lights.fold(0, |n_lights, _| n_lights + 1);
        Self {
            region: facts.region,
            n_lights,
            n_receivers: facts.n_receivers,
            n_sets: (1 << n_lights) - 1,
            visibility_format: visibility_format(facts.penumbra_px.len()),
            passes: PUBLISHED_PASSES
                .iter()
                .filter(|pass| !(is_constant && SAMPLING_PASSES.contains(&pass.name)))
                .copied()
                .collect(),
            left_out,
        }
    }
}
