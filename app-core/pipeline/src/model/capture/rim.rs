//! `rim`: the light that a blurred picture adds to the toy's colours at its outline, and the part of
//! one of its surfaces in them.

use app_scene::sharpness::Spread;
use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::{Observed, gbuffer};
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
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
];
/// Format of the added light: codes, like those of the picture.
const FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Format of factors, which may exceed 1.
const FACTOR_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

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
    pub(crate) gbuffer: &'a gbuffer::Targets,
}

/// Targets of the physical box's size, if the picture is softer than the renderings.
pub(crate) struct Targets {
    pub(crate) mixed: Option<Texture>,
    /// The factor from the toy's colour in a pixel to that of the surface at its centre.
    pub(crate) unmixed: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = |label, format| Texture::target(gpu, label, plan.physical_box.size_px, format);
        Self {
            mixed: plan.is_softened.then(|| target("rim", FORMAT)),
            unmixed: plan.is_softened.then(|| target("rim unmixed", FACTOR_FORMAT)),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(
                &SHADER,
                "fs_mix",
                groups,
                &[FORMAT, FACTOR_FORMAT],
            )),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let (Some(mixed), Some(unmixed)) = (&targets.mixed, &targets.unmixed) else {
            return;
        };
        let gbuffer = inputs.gbuffer;
        let resources = [
            inputs.grids.into(),
            inputs.cells.into(),
            inputs.plate.into(),
            inputs.observed.visibility.into(),
            inputs.observed.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
            (&gbuffer.depth.view).into(),
            (&gbuffer.normal.view).into(),
            (&gbuffer.received.view).into(),
            (&gbuffer.base.view).into(),
        ];
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind(&self.draw, GROUP_PASS, &resources),
        ];
        let written = [cleared(&mixed.view), cleared(&unmixed.view)];
        // No colour has its source beyond the toy.
        let near = inputs.plan.near_physical_toy(0);
        recorder.fullscreen_within(&self.draw, &groups, &written.map(Some), near);
    }
}
