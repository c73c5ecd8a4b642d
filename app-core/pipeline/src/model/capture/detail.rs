//! `detail`: each pixel's own residual, with the noise of the shadow removed.

use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::Observed;
use crate::model::plan::Plan;
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::passes::pictures::ByForm;

pub(crate) const SHADER: Shader = shader!("capture/detail");
const SLOTS: &[Slot] = &[
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Filtered,
    Slot::Sampler,
];
/// Format of residuals, in units of the plate.
const FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// Needed only if the real shadow is denoised.
pub(crate) fn is_needed(plan: &Plan) -> bool {
    plan.is_noise_removed
}

pub(crate) struct Pass {
    draw: ByForm<Draw>,
}

pub(crate) struct Inputs<'a> {
    pub(crate) seen: SeenScene<'a>,
    pub(crate) observed: Observed<'a>,
    pub(crate) plate: &'a TextureView,
}

/// Targets of the region's size, if needed.
pub(crate) struct Targets {
    pub(crate) residual: Option<Texture>,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = || Texture::target(gpu, "detail", plan.region.size_px, FORMAT);
        Self {
            residual: is_needed(plan).then(target),
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
                    ..DrawSpec::fullscreen(&SHADER, "fs_separate", groups, &[FORMAT])
                })
            }),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let Some(target) = &targets.residual else { return };
        let draw = self.draw.of(recorder.gpu, &inputs.seen.frame);
        let observed = &inputs.observed;
        let resources = [
            inputs.plate.into(),
            observed.validity.into(),
            observed.visibility.into(),
            observed.ambient.into(),
            (&recorder.gpu.samplers.linear).into(),
        ];
        let groups = [
            inputs.seen.bind(recorder, draw),
            recorder.bind(draw, GROUP_PASS, &resources),
        ];
        recorder.fullscreen(draw, &groups, &[&target.view]);
    }
}
