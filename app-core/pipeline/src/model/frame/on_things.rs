//! `on_things`: the toy's shadow on things that stand on the first receiver.

use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::plan::Plan;
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::passes::pictures::ByForm;
use crate::passes::plate::FINE_FORMAT;
use crate::passes::thing_marks::{Things, ThingsView};

pub(crate) const SHADER: Shader = shader!("frame/on_things");
const SLOTS: &[Slot] = &[
    Slot::uniform::<ThingsView>(),
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
];
/// Format of what is shown: more precise than codes, since its alpha is.
const FORMAT: TextureFormat = FINE_FORMAT;

/// Needed only if the points of things are known.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.has_raised_things
}

pub(crate) struct Pass {
    draw: ByForm<Draw>,
}

pub(crate) struct Inputs<'a> {
    pub(crate) seen: SeenScene<'a>,
    pub(crate) things: &'a Things,
    pub(crate) plate: &'a TextureView,
    pub(crate) validity: &'a TextureView,
    pub(crate) physical_visibility: &'a TextureView,
    pub(crate) visibility: &'a TextureView,
}

/// Targets of the region's size, if needed.
pub(crate) struct Targets {
    /// The plate, with what is shown of things in the toy's shadow.
    pub(crate) plate: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "on_things", plan.region.size_px, FORMAT);
        Self {
            plate: is_needed(plan).then(target),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SEEN_SLOTS, SLOTS, &[], &[]];
        Self {
            draw: ByForm::new(gpu, move |gpu, form| {
                gpu.draw(&DrawSpec {
                    constants: vec![form],
                    ..DrawSpec::fullscreen(&SHADER, "fs_shade", groups, &[FORMAT])
                })
            }),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let Some(plate) = &targets.plate else { return };
        let draw = self.draw.of(recorder.gpu, &inputs.seen.frame);
        let [view, codes] = inputs.things.resources();
        let resources = [
            view,
            codes,
            inputs.plate.into(),
            inputs.physical_visibility.into(),
            inputs.visibility.into(),
            inputs.validity.into(),
        ];
        let groups = [
            inputs.seen.bind(recorder, draw),
            recorder.bind(draw, GROUP_PASS, &resources),
        ];
        recorder.fullscreen_onto(draw, &groups, &[Some(cleared(&plate.view))]);
    }
}
