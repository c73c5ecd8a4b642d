//! `gloss`: reflected radiance of a glossy toy in its physical pose, and the share of its paint
//! that is visible below it.

use wgpu::{Color, TextureFormat};

use crate::gpu::bindings::{GROUP_PASS, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared_to};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::gbuffer;
use crate::model::plan::Plan;
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::passes::pictures::ByForm;
use crate::passes::specular::Specular;

pub(crate) const SHADER: Shader = shader!("capture/gloss");
const SLOTS: &[Slot] = &[
    Slot::uniform::<Specular>(),
    Slot::Depth,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
];
/// Format of reflected radiance, which a lamp's highlight makes larger than any code.
const FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// Whether any part of the toy is glossy.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.specular.is_glossy()
}

pub(crate) struct Pass {
    draw: ByForm<Draw>,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) seen: SeenScene<'a>,
    pub(crate) specular: &'a Buffer,
    pub(crate) gbuffer: &'a gbuffer::Targets,
}

/// Targets of the physical box's size; present if any part of the toy is glossy.
pub(crate) struct Targets {
    pub(crate) reflected: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "gloss", plan.physical_box.size_px, FORMAT);
        Self {
            reflected: is_needed(plan).then(target),
        }
    }

    pub(crate) fn view(&self) -> Option<&TextureView> {
        self.reflected.as_ref().map(|texture| &texture.view)
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            draw: ByForm::new(gpu, |gpu, form| {
                gpu.draw(&DrawSpec {
                    constants: vec![form],
                    ..DrawSpec::fullscreen(&SHADER, "fs_reflect", [SEEN_SLOTS, SLOTS, &[], &[]], &[FORMAT])
                })
            }),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let Some(reflected) = &targets.reflected else {
            return;
        };
        let draw = self.draw.of(recorder.gpu, &inputs.seen.frame);
        let gbuffer = inputs.gbuffer;
        let resources = [
            inputs.specular.into(),
            (&gbuffer.depth.view).into(),
            (&gbuffer.normal.view).into(),
            (&gbuffer.received.view).into(),
            (&gbuffer.base.view).into(),
        ];
        let groups = [
            inputs.seen.bind(recorder, draw),
            recorder.bind(draw, GROUP_PASS, &resources),
        ];
        // Nothing is reflected beyond the toy, and every pixel depends on itself alone.
        let near = inputs.plan.near_physical_toy(0);
        recorder.fullscreen_within(
            draw,
            &groups,
            &[Some(cleared_to(&reflected.view, Color::BLACK))],
            near,
        );
    }
}
