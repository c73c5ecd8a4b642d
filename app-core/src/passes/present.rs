//! `present`: the camera image with the work region laid over it, code for code.

use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::Placement;
use crate::gpu::pipeline::{GROUP_PASS, view};
use crate::gpu::shaders::PRESENT;

pub(crate) struct Present {
    pipeline: wgpu::RenderPipeline,
}

/// Views of sRGB textures as plain codes.
pub(crate) struct PresentInputs<'a> {
    pub(crate) frame_codes: &'a wgpu::TextureView,
    pub(crate) region_codes: &'a wgpu::TextureView,
    pub(crate) placement: Placement,
}

impl Present {
    /// For a target of `format`, which takes codes as they are.
    pub(crate) fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        Self {
            pipeline: gpu.fullscreen_pipeline(&PRESENT, "fs_place", format, &[]),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &PresentInputs<'_>,
        target: &wgpu::TextureView,
    ) {
        let placement = gpu.uniform("placement", &inputs.placement);
        let own = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_PASS),
            &[
                (0, placement.as_entire_binding()),
                (1, view(inputs.frame_codes)),
                (2, view(inputs.region_codes)),
            ],
        );
        encoder.fullscreen(PRESENT.name, &self.pipeline, &[(GROUP_PASS, &own)], target);
    }
}
