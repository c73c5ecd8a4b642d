//! `appearance`: the camera's pixels from which the toy's own colours are taken, also slightly
//! beyond its outline.

use glam::IVec2;
use wgpu::{Color, TextureFormat};

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared, cleared_to};
use crate::gpu::shader::{Mirrors, Shader, mirrors, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::gbuffer;
use crate::model::capture::gbuffer::{BASE_FORMAT, RECEIVED_FORMAT};
use crate::model::plan::Plan;
use crate::passes::globals::GLOBALS_GROUP;

/// Codes of the source pixels of colours.
pub(crate) const SOURCE: Mirrors = mirrors!("common/source", constants: [REACH_PX, N_IN_ROW]);
pub(crate) const SHADER: Shader = shader!("capture/appearance");
const SLOTS: &[Slot] = &[Slot::Texture, Slot::Depth, Slot::Texture, Slot::Texture];
/// Format of the codes of source pixels.
const SOURCE_FORMAT: TextureFormat = TextureFormat::R8Unorm;

/// Distance beyond the toy up to which its colours are extrapolated.
const REACH_PX: u32 = 3;
/// Length of a row in the numbering of the pixels around a pixel.
const N_IN_ROW: i32 = 8;

pub(crate) struct Pass {
    draw: Draw,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) globals: &'a Buffer,
    pub(crate) validity: &'a TextureView,
    pub(crate) gbuffer: &'a gbuffer::Targets,
}

/// Targets of the physical box's size.
pub(crate) struct Targets {
    /// Each light's cosine times its visibility at the source pixels.
    pub(crate) received: Texture,
    /// Base colour of the source pixels, and their upward orientation.
    pub(crate) base: Texture,
    /// The codes of the source pixels.
    pub(crate) source: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = |label, format| Texture::target(gpu, label, plan.physical_box.size_px, format);
        Self {
            received: target("appearance received", RECEIVED_FORMAT),
            base: target("appearance base", BASE_FORMAT),
            source: target("appearance source", SOURCE_FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, SLOTS, &[], &[]];
        let targets = [RECEIVED_FORMAT, BASE_FORMAT, SOURCE_FORMAT];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_clean", groups, &targets)),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let gbuffer = inputs.gbuffer;
        let resources = [
            inputs.validity.into(),
            (&gbuffer.depth.view).into(),
            (&gbuffer.received.view).into(),
            (&gbuffer.base.view).into(),
        ];
        let groups = [
            recorder.bind(&self.draw, GROUP_SCENE, &[inputs.globals.into()]),
            recorder.bind(&self.draw, GROUP_PASS, &resources),
        ];
        // Beyond the drawn part no colour has a source.
        let written = [
            cleared(&targets.received.view),
            cleared(&targets.base.view),
            cleared_to(&targets.source.view, Color::WHITE),
        ];
        let near = inputs.plan.near_physical_toy(REACH_PX);
        recorder.fullscreen_within(&self.draw, &groups, &written.map(Some), near);
    }
}

/// The source pixel of a texel's colour; `None` if it has none.
pub(crate) fn source_texel(texel: IVec2, source: f32) -> Option<IVec2> {
    #[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
    let number = (255.0 * source).round() as i32;
    let offset = IVec2::new(number % N_IN_ROW, number / N_IN_ROW) - REACH_PX as i32;
    (number < N_IN_ROW * N_IN_ROW).then_some(texel + offset)
}
