//! `lit`: what the receivers look like in the light, pooled on coarse grids.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::LIT;
use crate::grids::CellBuffers;

/// Workgroups along each side of the largest grid: 64 cells of 8 x 8 invocations.
const WORKGROUPS: u32 = 8;

pub(crate) struct Lit {
    pipeline: wgpu::ComputePipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct LitInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) grids: &'a wgpu::Buffer,
    pub(crate) cells: &'a CellBuffers,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
}

impl Lit {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.compute_pipeline(&LIT, "cs_pool"),
            linear: gpu.linear_sampler(),
        }
    }

    /// Pools the lit colour on `n_receivers` grids.
    pub(crate) fn encode(&self, gpu: &Gpu, encoder: &mut Encoder, inputs: &LitInputs<'_>, n_receivers: u32) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind(
            &layout(GROUP_GLOBALS),
            &[
                (0, inputs.globals.as_entire_binding()),
                (1, inputs.solution.as_entire_binding()),
            ],
        );
        let own = gpu.bind(
            &layout(GROUP_PASS),
            &[
                (0, inputs.grids.as_entire_binding()),
                (1, inputs.cells.cells.as_entire_binding()),
                (2, inputs.cells.kept.as_entire_binding()),
                (3, view(inputs.frame)),
                (4, view(inputs.evidence)),
                (5, view(inputs.visibility)),
                (6, view(inputs.ambient)),
                (7, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        );
        encoder.compute(
            LIT.name,
            &self.pipeline,
            &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
            cell_workgroups(n_receivers),
        );
    }
}

/// Workgroups for every cell of `n_receivers` grids.
pub(crate) fn cell_workgroups(n_receivers: u32) -> [u32; 3] {
    [WORKGROUPS, WORKGROUPS, n_receivers]
}
