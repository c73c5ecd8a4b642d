//! `eligible`: the paper's masks 3b and 3c: the real shadow, and the part of it that is sampled.

use wgpu::TextureFormat;

use crate::baseline::plan::BaselinePlan;
use crate::baseline::uniform::{SCENE_SLOTS, Scene};
use crate::gpu::{
    Draw, DrawSpec, GROUP_PASS, GROUP_SCENE, Gpu, Recorder, Shader, Slot, Texture, TextureView, shader,
};

pub(crate) const SHADER: Shader = shader!("baseline/eligible");
const SLOTS: &[Slot] = &[Slot::Texture, Slot::Texture];
/// Format of the masks: r is 3c as a label of receiver and lights, g is 3b.
const FORMAT: TextureFormat = TextureFormat::Rg8Uint;

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) mask: &'a TextureView,
    pub(crate) visibility: &'a TextureView,
}

/// Targets of the region's size.
pub(crate) struct Targets {
    pub(crate) labels: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &BaselinePlan) -> Self {
        Self {
            labels: Texture::target(gpu, "eligible", plan.region.size_px, FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_mark", groups, &[FORMAT])),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind(
                &self.draw,
                GROUP_PASS,
                &[inputs.mask.into(), inputs.visibility.into()],
            ),
        ];
        recorder.fullscreen(&self.draw, &groups, &[&targets.labels.view]);
    }
}
