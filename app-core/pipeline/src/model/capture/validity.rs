//! `validity`: mask of the pixels that show the receiver alone, and of those that show a single
//! surface of the toy.

use wgpu::{Color, TextureFormat};

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared_to};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::plan::{AROUND_TOY_PX, Plan};

pub(crate) const SHADER: Shader = shader!("capture/validity", constants: [EDGE_PX, BLEED_PX]);
const SLOTS: &[Slot] = &[Slot::Depth, Slot::per_use::<i32>()];
/// Format of the mask: r for the receiver, g for the toy (`common/mixed`), b for the receiver well clear of the toy.
pub(crate) const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

/// Distance from the toy's outline in a sharp picture.
const EDGE_PX: u32 = 2;
/// Largest distance of the search for the toy around a pixel in a sharp picture.
const BLEED_PX: u32 = 8;
/// Marks of pixels farther from the toy.
pub(crate) const FAR_MARKS: [f32; 4] = [1.0, 0.0, 1.0, 1.0];

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) gbuffer_depth: &'a TextureView,
    /// Largest reach of a soft picture's blur.
    pub(crate) soft_reach_px: f32,
}

/// Targets of the physical box's size.
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
        // The physical box contains no more.
        #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
        let soft_px = (inputs.soft_reach_px.ceil() as i32).min((AROUND_TOY_PX - EDGE_PX) as i32);
        let resources = [inputs.gbuffer_depth.into(), Resource::PerUse];
        let own = recorder.bind_with(&self.draw, GROUP_PASS, &soft_px, &resources);
        let [r, g, b, a] = FAR_MARKS.map(f64::from);
        let far = Color { r, g, b, a };
        let marks = Some(cleared_to(&targets.marks.view, far));
        let near = inputs
            .plan
            .near_physical_toy(BLEED_PX.max(EDGE_PX + soft_px.unsigned_abs()));
        recorder.fullscreen_within(&self.draw, &[own], &[marks], near);
    }
}
