//! `eligible`: the paper's masks 3b and 3c, the real shadow and the part of it to sample from.

use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::ELIGIBLE;

/// Format of the masks: r is 3c as a set of lights, g is 3b.
pub(crate) const ELIGIBLE_FORMAT: TextureFormat = TextureFormat::Rg8Uint;

pub(crate) struct Eligible {
    pipeline: wgpu::RenderPipeline,
}

impl Eligible {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.fullscreen_pipeline(&ELIGIBLE, "fs_mark", ELIGIBLE_FORMAT, &[]),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        (globals, published): (&wgpu::Buffer, &wgpu::Buffer),
        (masks, visibility): (&wgpu::TextureView, &wgpu::TextureView),
        eligible: &wgpu::TextureView,
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind(
            &layout(GROUP_GLOBALS),
            &[
                (0, globals.as_entire_binding()),
                (2, published.as_entire_binding()),
            ],
        );
        let own = gpu.bind(&layout(GROUP_PASS), &[(0, view(masks)), (1, view(visibility))]);
        encoder.fullscreen(
            ELIGIBLE.name,
            &self.pipeline,
            &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
            eligible,
        );
    }
}
