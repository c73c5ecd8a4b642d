//! `residual`: what the model leaves unexplained, pooled on a coarse grid.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::RESIDUAL;
use crate::grids::CellBuffers;
use crate::passes::lit::cell_workgroups;

pub(crate) struct Residual {
    pipeline: wgpu::ComputePipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct ResidualInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) grids: &'a wgpu::Buffer,
    pub(crate) cells: &'a CellBuffers,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plate: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
}

impl Residual {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.compute_pipeline(&RESIDUAL, "cs_pool"),
            linear: gpu.linear_sampler(),
        }
    }

    /// Pools the residual on `n_receivers` grids.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &ResidualInputs<'_>,
        n_receivers: u32,
    ) {
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
                (4, view(inputs.plate)),
                (5, view(inputs.evidence)),
                (6, view(inputs.visibility)),
                (7, view(inputs.ambient)),
                (8, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        );
        encoder.compute(
            RESIDUAL.name,
            &self.pipeline,
            &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
            cell_workgroups(n_receivers),
        );
    }
}
