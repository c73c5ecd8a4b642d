//! `withhold`: evidence without the real shadow, for measuring how well that is rebuilt.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::WITHHOLD;

use super::evidence::EVIDENCE_FORMAT;

pub(crate) struct Withhold {
    pipeline: wgpu::RenderPipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct WithholdInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
}

impl Withhold {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.fullscreen_pipeline(&WITHHOLD, "fs_withhold", EVIDENCE_FORMAT, &[]),
            linear: gpu.linear_sampler(),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &WithholdInputs<'_>,
        target: &wgpu::TextureView,
    ) {
        let shared = gpu.bind_buffers(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[inputs.globals, inputs.solution],
        );
        let own = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_PASS),
            &[
                (0, view(inputs.evidence)),
                (1, view(inputs.visibility)),
                (2, view(inputs.ambient)),
                (3, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        );
        let groups = [(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)];
        encoder.fullscreen(WITHHOLD.name, &self.pipeline, &groups, target);
    }
}
