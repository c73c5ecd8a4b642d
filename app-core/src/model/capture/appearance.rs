//! `appearance`: the toy's own colours from the camera frame, carried a little past its outline.

use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Shader, part};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::gbuffer::{self, BASE_FORMAT};
use crate::model::parts::{HEMISPHERES, TOY_RADIANCE};
use crate::model::plan::Plan;
use crate::model::state::solution::{FIT, SCENE_SLOTS, Scene};
use crate::passes::globals::GLOBALS;
use crate::passes::parts::{DEPTH, FULLSCREEN};

pub(crate) const SHADER: Shader = Shader::new(&[
    &GLOBALS,
    &FIT,
    &HEMISPHERES,
    &TOY_RADIANCE,
    &DEPTH,
    &FULLSCREEN,
    &part!("capture/appearance", constants: [REACH_PX]),
]);
const SLOTS: &[Slot] = &[
    Slot::Texture,
    Slot::Texture,
    Slot::Depth,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
];
/// Format of the colours: as the camera's, so that its codes come through unrounded.
const COLOR_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Format of the light that they were seen under.
const LIT_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// How far past the toy its colours are extrapolated.
const REACH_PX: u32 = 3;

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) scene: Scene<'a>,
    pub(crate) frame: &'a TextureView,
    pub(crate) validity: &'a TextureView,
    pub(crate) gbuffer: &'a gbuffer::Targets,
}

/// Of the region's size.
pub(crate) struct Targets {
    pub(crate) color: Texture,
    /// Fitted radiance over base colour at the pixels that a colour is from.
    pub(crate) lit: Texture,
    /// Base colour of these pixels.
    pub(crate) base: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = |label, format| Texture::target(gpu, label, plan.region.size_px, format);
        Self {
            color: target("appearance", COLOR_FORMAT),
            lit: target("appearance lit", LIT_FORMAT),
            base: target("appearance base", BASE_FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SCENE_SLOTS, SLOTS, &[], &[]];
        let targets = [COLOR_FORMAT, LIT_FORMAT, BASE_FORMAT];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_clean", groups, &targets)),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let gbuffer = inputs.gbuffer;
        let textures = [
            inputs.frame,
            inputs.validity,
            &gbuffer.depth.view,
            &gbuffer.normal.view,
            &gbuffer.received.view,
            &gbuffer.base.view,
        ];
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &inputs.scene.resources()),
            recorder.bind(&self.draw, GROUP_PASS, &textures.map(Into::into)),
        ];
        let colors = [&targets.color, &targets.lit, &targets.base];
        let colors = colors.map(|texture| Some(cleared(&texture.view)));
        let near = inputs.plan.near_physical_toy(REACH_PX);
        recorder.fullscreen_within(&self.draw, &groups, &colors, near);
    }
}
