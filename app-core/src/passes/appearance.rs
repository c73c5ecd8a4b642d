//! `appearance`: the toy's own colours from the camera frame, carried a little past its outline.

use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::APPEARANCE;

/// Format of the colours: as the camera's, so that its codes come through unrounded.
pub(crate) const APPEARANCE_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;

pub(crate) struct Appearance {
    pipeline: wgpu::RenderPipeline,
}

pub(crate) struct AppearanceInputs<'a> {
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) object_depth: &'a wgpu::TextureView,
}

impl Appearance {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.fullscreen_pipeline(&APPEARANCE, "fs_clean", APPEARANCE_FORMAT, &[]),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        inputs: &AppearanceInputs<'_>,
        appearance: &wgpu::TextureView,
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind(&layout(GROUP_GLOBALS), &[(0, globals.as_entire_binding())]);
        let own = gpu.bind(
            &layout(GROUP_PASS),
            &[
                (0, view(inputs.frame)),
                (1, view(inputs.evidence)),
                (2, view(inputs.object_depth)),
            ],
        );
        encoder.fullscreen(
            APPEARANCE.name,
            &self.pipeline,
            &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
            appearance,
        );
    }
}
