//! `evidence`: which pixels of the frame show the receiver alone, and which one surface of the toy.

use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_PASS, view};
use crate::gpu::shaders::EVIDENCE;

/// Format of the evidence: r for the receiver, g for the toy, b for the receiver well clear of the toy.
pub(crate) const EVIDENCE_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

pub(crate) struct Evidence {
    pipeline: wgpu::RenderPipeline,
}

impl Evidence {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.fullscreen_pipeline(&EVIDENCE, "fs_mark", EVIDENCE_FORMAT, &[]),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        object_depth: &wgpu::TextureView,
        evidence: &wgpu::TextureView,
    ) {
        let own = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_PASS),
            &[(0, view(object_depth))],
        );
        encoder.fullscreen(EVIDENCE.name, &self.pipeline, &[(GROUP_PASS, &own)], evidence);
    }
}
