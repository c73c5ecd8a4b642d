//! `estimate`: the plate, completed by an estimate where no plate covers the pixel.

use crate::gpu::bindings::{GROUP_PASS, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::Observed;
use crate::model::plan::Plan;
use crate::model::state::grids::Grids;
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::passes::pictures::ByForm;
use crate::passes::plate::FINE_FORMAT;

pub(crate) const SHADER: Shader = shader!("capture/estimate");
const SLOTS: &[Slot] = &[
    Slot::uniform::<Grids>(),
    Slot::Read,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
];

/// Needed only if plates do not cover the whole region.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.is_plate_estimated
}

pub(crate) struct Pass {
    complete: ByForm<Draw>,
}

pub(crate) struct Inputs<'a> {
    pub(crate) seen: SeenScene<'a>,
    pub(crate) grids: &'a Buffer,
    pub(crate) lit_cells: &'a Buffer,
    pub(crate) photographed: &'a TextureView,
    pub(crate) observed: Observed<'a>,
}

/// Targets of the region's size, if needed.
pub(crate) struct Targets {
    /// The photographed plate, from which the plate for the passes is completed.
    pub(crate) photographed: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "photographed plate", plan.region.size_px, FINE_FORMAT);
        Self {
            photographed: is_needed(plan).then(target),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [SEEN_SLOTS, SLOTS, &[], &[]];
        Self {
            complete: ByForm::new(gpu, move |gpu, form| {
                gpu.draw(&DrawSpec {
                    constants: vec![form],
                    ..DrawSpec::fullscreen(&SHADER, "fs_complete", groups, &[FINE_FORMAT])
                })
            }),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, target: &TextureView) {
        let draw = self.complete.of(recorder.gpu, &inputs.seen.frame);
        let observed = &inputs.observed;
        let resources = [
            inputs.grids.into(),
            inputs.lit_cells.into(),
            inputs.photographed.into(),
            observed.validity.into(),
            observed.visibility.into(),
            observed.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
        ];
        let groups = [
            inputs.seen.bind(recorder, draw),
            recorder.bind(draw, GROUP_PASS, &resources),
        ];
        recorder.fullscreen(draw, &groups, &[target]);
    }
}
