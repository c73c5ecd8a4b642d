//! `unmix`: the part of one of the toy's surfaces in each colour that a blurred picture mixes.

use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::Texture;
use crate::model::capture::gbuffer;
use crate::model::plan::Plan;
use crate::model::state::solution::{SCENE_SLOTS, Scene};

pub(crate) const SHADER: Shader = shader!("capture/unmix");
const SLOTS: &[Slot] = &[Slot::Depth, Slot::Texture, Slot::Texture];
/// Format of factors as codes of ten bits (`common/factor_code`).
const FORMAT: TextureFormat = TextureFormat::Rgb10a2Unorm;

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) scene: Scene<'a>,
    pub(crate) gbuffer: &'a gbuffer::Targets,
}

/// A target of the physical box's size, if the picture is softer than the renderings.
pub(crate) struct Targets {
    pub(crate) factor: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "unmix", plan.physical_box.size_px, FORMAT);
        Self {
            factor: plan.is_softened.then(target),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_unmix", groups, &[FORMAT])),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let Some(factor) = &targets.factor else { return };
        let gbuffer = inputs.gbuffer;
        let resources = [
            (&gbuffer.depth.view).into(),
            (&gbuffer.received.view).into(),
            (&gbuffer.base.view).into(),
        ];
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind(&self.draw, GROUP_PASS, &resources),
        ];
        let written = [cleared(&factor.view)];
        // No colour has its source beyond the toy.
        let near = inputs.plan.near_physical_toy(0);
        recorder.fullscreen_within(&self.draw, &groups, &written.map(Some), near);
    }
}
