//! `rim`: the light that a blurred picture adds to the toy's colours at its outline.

use app_scene::sharpness::Spread;
use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::Observed;
use crate::model::plan::Plan;
use crate::model::state::grids::Grids;
use crate::model::state::solution::{SCENE_SLOTS, Scene};

pub(crate) const SHADER: Shader = shader!("capture/rim");
const SLOTS: &[Slot] = &[
    Slot::uniform::<Grids>(),
    Slot::Read,
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
    Slot::Depth,
];
/// Format of the added light: codes, like those of the picture.
const FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// Needed only if the picture is measurably softer than its pixels.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.sharpness.outline_spread != Spread::NONE
}

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) scene: Scene<'a>,
    pub(crate) grids: &'a Buffer,
    pub(crate) cells: &'a Buffer,
    pub(crate) plate: &'a TextureView,
    pub(crate) observed: Observed<'a>,
    pub(crate) gbuffer_depth: &'a TextureView,
}

/// Targets of the physical box's size, if the picture is softer than the renderings.
pub(crate) struct Targets {
    pub(crate) mixed: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "rim", plan.physical_box.size_px, FORMAT);
        Self {
            mixed: plan.is_softened.then(target),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_mix", groups, &[FORMAT])),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let Some(mixed) = &targets.mixed else { return };
        let resources = [
            inputs.grids.into(),
            inputs.cells.into(),
            inputs.plate.into(),
            inputs.observed.visibility.into(),
            inputs.observed.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
            inputs.gbuffer_depth.into(),
        ];
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind(&self.draw, GROUP_PASS, &resources),
        ];
        // No colour has its source beyond the toy.
        let near = inputs.plan.near_physical_toy(0);
        recorder.fullscreen_within(&self.draw, &groups, &[Some(cleared(&mixed.view))], near);
    }
}
