//! `validity`: mask of the pixels that show the receiver alone, and of those that show one surface of the toy.

use wgpu::{Color, TextureFormat};

use crate::gpu::bindings::{GROUP_PASS, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared_to};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::plan::Plan;

pub(crate) const SHADER: Shader = shader!("capture/validity", constants: [BLEED_PX]);
const SLOTS: &[Slot] = &[Slot::Depth];
/// Format of the mask: r for the receiver, g for the toy, b for the receiver well clear of the toy.
pub(crate) const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

/// Farthest that the toy is looked for around a pixel.
const BLEED_PX: u32 = 8;
/// Marks of pixels farther from it.
pub(crate) const FAR_MARKS: [f32; 4] = [1.0, 0.0, 1.0, 1.0];

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) gbuffer_depth: &'a TextureView,
}

/// Of the physical box's size.
pub(crate) struct Targets {
    pub(crate) marks: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            marks: Texture::target(gpu, "validity", plan.physical_box.size_px, FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [&[][..], SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_mark", groups, &[FORMAT])),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let own = recorder.bind(&self.draw, GROUP_PASS, &[inputs.gbuffer_depth.into()]);
        let [r, g, b, a] = FAR_MARKS.map(f64::from);
        let far = Color { r, g, b, a };
        let marks = Some(cleared_to(&targets.marks.view, far));
        let near = inputs.plan.near_physical_toy(BLEED_PX);
        recorder.fullscreen_within(&self.draw, &[own], &[marks], near);
    }
}
