//! `pcss`: percentage-closer soft shadows of a posed toy, of each light, in the edge region.

use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::PCSS;

pub(crate) struct Pcss {
    pipeline: wgpu::RenderPipeline,
}

impl Pcss {
    /// Into a map of `format`.
    pub(crate) fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        Self {
            pipeline: gpu.fullscreen_pipeline(&PCSS, "fs_soften", format, &[]),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        (globals, published): (&wgpu::Buffer, &wgpu::Buffer),
        warp: &wgpu::TextureView,
        visibility: &wgpu::TextureView,
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind(
            &layout(GROUP_GLOBALS),
            &[
                (0, globals.as_entire_binding()),
                (2, published.as_entire_binding()),
            ],
        );
        let own = gpu.bind(&layout(GROUP_PASS), &[(0, view(warp))]);
        encoder.fullscreen(
            PCSS.name,
            &self.pipeline,
            &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
            visibility,
        );
    }
}
