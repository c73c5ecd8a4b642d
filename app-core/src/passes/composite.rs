//! `composite`: plate times new shadow, real toy and real shadow gone, the animated toy laid over it.

use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::COMPOSITE;

use super::toy::ToyTargets;

/// Format of the picture.
pub(crate) const PICTURE_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;

pub(crate) struct Composite {
    pipeline: wgpu::RenderPipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct CompositeInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) grids: &'a wgpu::Buffer,
    pub(crate) cells: &'a wgpu::Buffer,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plate: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) physical_visibility: &'a wgpu::TextureView,
    pub(crate) physical_ambient: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
    pub(crate) coverage: &'a wgpu::TextureView,
    pub(crate) toy: &'a ToyTargets,
    pub(crate) motion: &'a wgpu::TextureView,
    /// Each pixel's own residual; without it that is what the frame shows.
    pub(crate) detail: Option<&'a wgpu::TextureView>,
}

impl Composite {
    /// For a toy drawn once or four times, with or without residuals cleared of noise.
    pub(crate) fn new(gpu: &Gpu, n_toy_draws: u32, is_noise_removed: bool) -> Self {
        let constants = [
            ("N_TOY_DRAWS", f64::from(n_toy_draws)),
            ("HAS_DETAIL", f64::from(u8::from(is_noise_removed))),
        ];
        Self {
            pipeline: gpu.fullscreen_pipeline(&COMPOSITE, "fs_compose", PICTURE_FORMAT, &constants),
            linear: gpu.linear_sampler(),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &CompositeInputs<'_>,
        picture: &wgpu::TextureView,
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind_buffers(&layout(GROUP_GLOBALS), &[inputs.globals, inputs.solution]);
        let [toy_0, toy_1, toy_2, toy_3] = inputs.toy.views();
        let own = gpu.bind(
            &layout(GROUP_PASS),
            &[
                (0, inputs.grids.as_entire_binding()),
                (1, inputs.cells.as_entire_binding()),
                (2, view(inputs.frame)),
                (3, view(inputs.plate)),
                (4, view(inputs.evidence)),
                (5, view(inputs.physical_visibility)),
                (6, view(inputs.physical_ambient)),
                (7, view(inputs.visibility)),
                (8, view(inputs.ambient)),
                (9, wgpu::BindingResource::Sampler(&self.linear)),
                (10, view(toy_0)),
                (11, view(toy_1)),
                (12, view(toy_2)),
                (13, view(toy_3)),
                (14, view(&inputs.toy.moved.view)),
                (15, view(inputs.motion)),
                // Not read where there is none.
                (16, view(inputs.detail.unwrap_or(inputs.plate))),
                (17, view(inputs.coverage)),
            ],
        );
        encoder.fullscreen(
            COMPOSITE.name,
            &self.pipeline,
            &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
            picture,
        );
    }
}
