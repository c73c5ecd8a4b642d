//! `appearance`: the toy's own colours from the camera frame, carried a little past its outline.

use wgpu::{StoreOp, TextureFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, cleared};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, RenderShape, Stages, view};
use crate::gpu::shaders::APPEARANCE;

use super::object::BASE_FORMAT;

/// Format of the colours: as the camera's, so that its codes come through unrounded.
pub(crate) const APPEARANCE_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// Format of the light that they were seen under.
pub(crate) const LIT_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

pub(crate) struct Appearance {
    pipeline: wgpu::RenderPipeline,
}

pub(crate) struct AppearanceInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) object_depth: &'a wgpu::TextureView,
    pub(crate) object_normal: &'a wgpu::TextureView,
    pub(crate) object_received: &'a wgpu::TextureView,
    pub(crate) object_base: &'a wgpu::TextureView,
}

/// Textures of the region's size.
pub(crate) struct AppearanceOutputs<'a> {
    pub(crate) color: &'a wgpu::TextureView,
    pub(crate) lit: &'a wgpu::TextureView,
    pub(crate) base: &'a wgpu::TextureView,
}

impl Appearance {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let stages = Stages {
            vertex: "vs_fullscreen",
            fragment: "fs_clean",
            buffers: &[],
        };
        let shape = RenderShape {
            targets: &[
                Some(APPEARANCE_FORMAT.into()),
                Some(LIT_FORMAT.into()),
                Some(BASE_FORMAT.into()),
            ],
            n_samples: 1,
            depth: None,
            culled: None,
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&APPEARANCE, &gpu.module(&APPEARANCE), &stages, &shape),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &AppearanceInputs<'_>,
        outputs: &AppearanceOutputs<'_>,
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind_buffers(&layout(GROUP_GLOBALS), &[inputs.globals, inputs.solution]);
        let own = gpu.bind(
            &layout(GROUP_PASS),
            &[
                (0, view(inputs.frame)),
                (1, view(inputs.evidence)),
                (2, view(inputs.object_depth)),
                (3, view(inputs.object_normal)),
                (4, view(inputs.object_received)),
                (5, view(inputs.object_base)),
            ],
        );
        let targets = [outputs.color, outputs.lit, outputs.base].map(|view| Some(cleared(view)));
        let mut render = encoder.render(APPEARANCE.name, &targets, None, StoreOp::Discard);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
        render.set_bind_group(GROUP_PASS, &own, &[]);
        render.draw(0..3, 0..1);
    }
}
