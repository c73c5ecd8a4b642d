//! `tint`: shown and expected colours of the toy's visible paint, summed in cells.

use std::sync::OnceLock;

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Compute, ComputeSpec};
use crate::gpu::recorder::{Recorder, n_pixels};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::TextureView;
use crate::model::capture::gbuffer;
use crate::model::plan::Plan;
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::model::state::tints::{TintGrid, Tints};
pub(crate) use crate::passes::list::NoTargets as Targets;
use crate::passes::pictures::ByForm;

pub(crate) const SHADER: Shader = shader!("capture/tint");
/// The sampling stride, in region pixels; then the grid, the sums and their inputs.
const SLOTS: &[Slot] = &[
    Slot::per_use::<u32>(),
    Slot::uniform::<TintGrid>(),
    Slot::ReadWrite,
    Slot::Texture,
    Slot::Depth,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
];
/// Invocations of a workgroup along each side.
const WORKGROUP_PX: u32 = 8;

pub(crate) struct Pass {
    matt: ByForm<Compute>,
    /// Pipelines for a glossy toy, made on first use.
    glossy: OnceLock<ByForm<Compute>>,
}

fn summing(gpu: &Gpu, is_glossy: bool) -> ByForm<Compute> {
    ByForm::new(gpu, move |gpu, form| {
        gpu.compute(&ComputeSpec {
            shader: &SHADER,
            entry_point: "cs_add",
            groups: [SEEN_SLOTS, SLOTS, &[], &[]],
            constants: vec![form, ("IS_GLOSSY", u32::from(is_glossy))],
        })
    })
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) seen: SeenScene<'a>,
    pub(crate) validity: &'a TextureView,
    pub(crate) gbuffer: &'a gbuffer::Targets,
    /// Radiance that a glossy toy reflects.
    pub(crate) reflected: Option<&'a TextureView>,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            matt: summing(gpu, false),
            glossy: OnceLock::new(),
        }
    }

    /// Sums the shown and expected colours of a frame.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, tints: &Tints) {
        recorder.clear(&tints.sums);
        let gpu = recorder.gpu;
        let by_form = match inputs.reflected {
            Some(_) => self.glossy.get_or_init(|| summing(gpu, true)),
            None => &self.matt,
        };
        let compute = by_form.of(gpu, &inputs.seen.frame);
        let gbuffer = inputs.gbuffer;
        let resources = [
            Resource::PerUse,
            (&tints.grid).into(),
            (&tints.sums).into(),
            inputs.validity.into(),
            (&gbuffer.depth.view).into(),
            (&gbuffer.normal.view).into(),
            (&gbuffer.received.view).into(),
            (&gbuffer.base.view).into(),
            // A matt toy binds a placeholder that is not read.
            inputs.reflected.unwrap_or(&gbuffer.base.view).into(),
        ];
        let stride_px = inputs.plan.fit_stride_px;
        let groups = [
            inputs.seen.bind(recorder, compute),
            recorder.bind_with(compute, GROUP_PASS, &stride_px, &resources),
        ];
        // The number of steps that can begin in the box.
        let size_px = inputs.plan.physical_box.size_px;
        let sampled_px = size_px.map(|side_px| side_px.div_ceil(stride_px));
        let workgroups = sampled_px.map(|side_px| side_px.div_ceil(WORKGROUP_PX)).extend(1);
        recorder.compute_over(compute, &groups, workgroups.to_array(), n_pixels(sampled_px));
    }
}
