//! `search`: the shadow term of each texel of the new shadows, from the warp or from the concentric
//! ring search.

use wgpu::TextureFormat;

use crate::baseline::plan::BaselinePlan;
use crate::baseline::uniform::{SCENE_SLOTS, Scene};
use crate::gpu::{
    Buffer, Draw, DrawSpec, GROUP_PASS, GROUP_SCENE, Gpu, Recorder, Shader, Slot, Texture, TextureView,
    shader,
};

pub(crate) const SHADER: Shader = shader!("baseline/search");
const SLOTS: &[Slot] = &[
    Slot::Layers,
    Slot::WholeNumbers,
    Slot::Texture,
    Slot::Texture,
    Slot::Read,
];
/// Format of the terms and of their sums.
pub(crate) const TERM_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Format of the number of taps.
const TAPS_FORMAT: TextureFormat = TextureFormat::R16Float;

/// Needed only if the real shadow is sampled.
pub(crate) fn is_needed(plan: &BaselinePlan) -> bool {
    plan.is_sampled
}

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) warp: &'a TextureView,
    pub(crate) labels: &'a TextureView,
    pub(crate) seen_sets: &'a Buffer,
    pub(crate) frame: &'a TextureView,
    pub(crate) plate: &'a TextureView,
}

/// Targets of the region's size.
pub(crate) struct Targets {
    pub(crate) terms: Texture,
    pub(crate) taps: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &BaselinePlan) -> Self {
        let target = |label, format| Texture::target(gpu, label, plan.region.size_px, format);
        Self {
            terms: target("terms", TERM_FORMAT),
            taps: target("taps", TAPS_FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        let formats = [TERM_FORMAT, TAPS_FORMAT];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_search", groups, &formats)),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let resources = [
            inputs.warp.into(),
            inputs.labels.into(),
            inputs.frame.into(),
            inputs.plate.into(),
            inputs.seen_sets.into(),
        ];
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind(&self.draw, GROUP_PASS, &resources),
        ];
        let targets = [&targets.terms.view, &targets.taps.view];
        recorder.fullscreen(&self.draw, &groups, &targets);
    }
}
