//! What `lit` and `residual` share: pooling pictures in the cells of coarse grids.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::Shader;
use crate::grids::CellBuffers;

/// Workgroups along each side of the largest grid: 64 cells of 8 x 8 invocations.
const WORKGROUPS: u32 = 8;

pub(crate) struct Pool {
    shader: &'static Shader,
    pipeline: wgpu::ComputePipeline,
    linear: wgpu::Sampler,
}

/// Where is pooled.
pub(crate) struct PoolGrids<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) grids: &'a wgpu::Buffer,
    pub(crate) cells: &'a CellBuffers,
    pub(crate) n_receivers: u32,
}

impl Pool {
    pub(crate) fn new(gpu: &Gpu, shader: &'static Shader) -> Self {
        Self {
            shader,
            pipeline: gpu.compute_pipeline(shader, "cs_pool"),
            linear: gpu.linear_sampler(),
        }
    }

    /// Pools `pictures`, which are in the order of the shader's bindings, the sampler after them.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        on: &PoolGrids<'_>,
        pictures: &[&wgpu::TextureView],
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind_buffers(&layout(GROUP_GLOBALS), &[on.globals, on.solution]);
        let buffers = [on.grids, &on.cells.cells, &on.cells.kept].map(wgpu::Buffer::as_entire_binding);
        let resources = buffers
            .into_iter()
            .chain(pictures.iter().map(|picture| view(picture)))
            .chain([wgpu::BindingResource::Sampler(&self.linear)]);
        let own = gpu.bind(&layout(GROUP_PASS), &(0..).zip(resources).collect::<Vec<_>>());
        encoder.compute(
            self.shader.name,
            &self.pipeline,
            &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
            [WORKGROUPS, WORKGROUPS, on.n_receivers],
        );
    }
}
