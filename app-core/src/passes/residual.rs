//! `residual`: what the model leaves unexplained, pooled on a coarse grid.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::RESIDUAL;

/// Invocations of a workgroup along each side.
const WORKGROUP: u32 = 8;

pub(crate) struct Residual {
    pipeline: wgpu::ComputePipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct ResidualInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) grid: &'a wgpu::Buffer,
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

    /// Fills the finest level of `cells`, of `size` cells.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &ResidualInputs<'_>,
        size: [u32; 2],
        cells: &wgpu::Buffer,
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
                (0, inputs.grid.as_entire_binding()),
                (1, cells.as_entire_binding()),
                (2, view(inputs.frame)),
                (3, view(inputs.plate)),
                (4, view(inputs.evidence)),
                (5, view(inputs.visibility)),
                (6, view(inputs.ambient)),
                (7, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        );
        let workgroups = [size[0].div_ceil(WORKGROUP), size[1].div_ceil(WORKGROUP), 1];
        encoder.compute(
            RESIDUAL.name,
            &self.pipeline,
            &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
            workgroups,
        );
    }
}
