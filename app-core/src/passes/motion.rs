//! `motion`: where the surface that the camera saw of the real toy is no longer in its place.

use glam::UVec2;
use wgpu::{StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, resolved};
use crate::gpu::pipeline::{GROUP_GLOBALS, RenderShape, Stages, nearest_surface};
use crate::gpu::shaders::MOTION;
use crate::gpu::texture::{Texture, TextureShape};

use super::toy_mesh::{Stream, ToyMesh};

/// Format of what has moved, as part of a pixel.
pub(crate) const MOVED_FORMAT: TextureFormat = TextureFormat::R8Unorm;
/// What is thinner than a pixel counts as well.
const N_SAMPLES: u32 = 4;

pub(crate) struct Motion {
    pipeline: wgpu::RenderPipeline,
}

/// Textures of the region's size: two multisampled ones that stay on the chip, and what has moved.
pub(crate) struct MotionTargets {
    samples: Texture,
    depth: Texture,
    pub(crate) moved: Texture,
}

impl MotionTargets {
    pub(crate) fn new(gpu: &Gpu, size_px: UVec2) -> Self {
        let shape = |format, n_samples| TextureShape {
            size_px: size_px.to_array(),
            format,
            n_samples,
        };
        Self {
            samples: Texture::target(gpu, "motion samples", shape(MOVED_FORMAT, N_SAMPLES)),
            depth: Texture::target(gpu, "motion depth", shape(TextureFormat::Depth32Float, N_SAMPLES)),
            moved: Texture::target(gpu, "motion", shape(MOVED_FORMAT, 1)),
        }
    }
}

impl Motion {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let streams = [
            Stream::new(0, VertexFormat::Float32x3),
            Stream::new(1, VertexFormat::Float32x3),
        ];
        let buffers: Vec<_> = streams.iter().map(Stream::layout).collect();
        let stages = Stages {
            vertex: "vs_physical",
            fragment: "fs_motion",
            buffers: &buffers,
        };
        let shape = RenderShape {
            targets: &[Some(MOVED_FORMAT.into())],
            n_samples: N_SAMPLES,
            depth: Some(nearest_surface()),
            culled: None,
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&MOTION, &gpu.module(&MOTION), &stages, &shape),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        toy: &ToyMesh,
        targets: &MotionTargets,
    ) {
        let group = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[(0, globals.as_entire_binding())],
        );
        let colors = [Some(resolved(&targets.samples.view, &targets.moved.view))];
        let mut render = encoder.render(MOTION.name, &colors, Some(&targets.depth.view), StoreOp::Discard);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &group, &[]);
        render.set_vertex_buffer(1, toy.shown.positions.slice(..));
        toy.draw_positions(&mut render, &toy.physical.positions, 0..1);
    }
}
