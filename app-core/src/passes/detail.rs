//! `detail`: what each pixel knows of its own residual, with the noise of the shadow taken out.

use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::DETAIL;

/// Format of residuals, in plates.
pub(crate) const DETAIL_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

pub(crate) struct Detail {
    pipeline: wgpu::RenderPipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct DetailInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plate: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
}

impl Detail {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.fullscreen_pipeline(&DETAIL, "fs_separate", DETAIL_FORMAT, &[]),
            linear: gpu.linear_sampler(),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &DetailInputs<'_>,
        target: &wgpu::TextureView,
    ) {
        let shared = gpu.bind_buffers(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[inputs.globals, inputs.solution],
        );
        let own = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_PASS),
            &[
                (0, view(inputs.frame)),
                (1, view(inputs.plate)),
                (2, view(inputs.evidence)),
                (3, view(inputs.visibility)),
                (4, view(inputs.ambient)),
                (5, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        );
        let groups = [(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)];
        encoder.fullscreen(DETAIL.name, &self.pipeline, &groups, target);
    }
}
