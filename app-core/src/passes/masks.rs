//! `masks`: the paper's mask 3a, where the camera sees the physical toy.

use wgpu::{StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, cleared};
use crate::gpu::pipeline::{GROUP_GLOBALS, RenderShape, Stages};
use crate::gpu::shaders::MASKS;

use super::toy_mesh::{Stream, ToyMesh};

/// Format of the mask.
pub(crate) const MASKS_FORMAT: TextureFormat = TextureFormat::R8Unorm;

pub(crate) struct Masks {
    pipeline: wgpu::RenderPipeline,
}

impl Masks {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let stream = Stream::new(0, VertexFormat::Float32x3);
        let stages = Stages {
            vertex: "vs_object",
            fragment: "fs_set",
            buffers: &[stream.layout()],
        };
        let shape = RenderShape {
            targets: &[Some(MASKS_FORMAT.into())],
            n_samples: 1,
            depth: None,
            culled: None,
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&MASKS, &gpu.module(&MASKS), &stages, &shape),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        toy: &ToyMesh,
        masks: &wgpu::TextureView,
    ) {
        let layout = self.pipeline.get_bind_group_layout(GROUP_GLOBALS);
        let shared = gpu.bind(&layout, &[(0, globals.as_entire_binding())]);
        let mut render = encoder.render(MASKS.name, &[Some(cleared(masks))], None, StoreOp::Discard);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
        toy.draw_positions(&mut render, &toy.physical.positions, 0..1);
    }
}
