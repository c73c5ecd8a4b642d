//! `warp`: for each texel of the new shadow, where in the frame its vertex's real shadow lies.

use wgpu::{StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, cleared};
use crate::gpu::layout::MAX_RECEIVERS;
use crate::gpu::pipeline::{GROUP_GLOBALS, RenderShape, Stages, nearest_surface};
use crate::gpu::shaders::WARP;

use super::toy_mesh::{Stream, ToyMesh};

/// Format of the warp: source position and height need more than a half can hold.
pub(crate) const WARP_FORMAT: TextureFormat = TextureFormat::Rgba32Float;

/// Instances of a light, one a receiver.
#[allow(clippy::cast_possible_truncation, reason = "a handful")]
const N_SLOTS: u32 = MAX_RECEIVERS as u32;

/// What is warped: the shadow of one light on the first receivers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shadow {
    pub(crate) light: u32,
    pub(crate) n_receivers: u32,
}

pub(crate) struct Warp {
    pipeline: wgpu::RenderPipeline,
}

impl Warp {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let streams = [
            Stream::new(0, VertexFormat::Float32x3),
            Stream::new(1, VertexFormat::Float32x3),
        ];
        let buffers: Vec<_> = streams.iter().map(Stream::layout).collect();
        let stages = Stages {
            vertex: "vs_warp",
            fragment: "fs_source",
            buffers: &buffers,
        };
        let shape = RenderShape {
            targets: &[Some(WARP_FORMAT.into())],
            n_samples: 1,
            depth: Some(nearest_surface()),
            culled: None,
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&WARP, &gpu.module(&WARP), &stages, &shape),
        }
    }

    /// Warps the shadow of a light on each receiver to the pose at `shown`; `depth` is of the region's size and not kept.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        (globals, shadow): (&wgpu::Buffer, Shadow),
        (toy, shown): (&ToyMesh, &wgpu::Buffer),
        (warp, depth): (&wgpu::TextureView, &wgpu::TextureView),
    ) {
        let shared = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[(0, globals.as_entire_binding())],
        );
        let mut render = encoder.render(WARP.name, &[Some(cleared(warp))], Some(depth), StoreOp::Discard);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
        render.set_vertex_buffer(1, toy.physical.positions.slice(..));
        let first = shadow.light * N_SLOTS;
        toy.draw_positions(&mut render, shown, first..first + shadow.n_receivers);
    }
}
