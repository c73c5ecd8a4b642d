//! `self_shadow`: depth maps of the posed toy from points of each light, as tiles of one atlas.

use glam::Vec4;
use wgpu::{BufferUsages, StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::SelfShadow as Tiles;
use crate::gpu::pipeline::{RenderShape, Stages, nearest_surface, view};
use crate::gpu::shaders::SELF_SHADOW;
use crate::gpu::texture::{Texture, TextureShape};
use crate::light_tiles::light_tiles;
use crate::plan::SelfShadowPlan;

use super::toy_mesh::{PoseBuffers, Stream, ToyMesh};

/// Group of the maps, in this pass and where they are read.
pub(crate) const GROUP_SELF_SHADOW: u32 = 3;

/// The depth maps of one pose.
pub(crate) struct SelfShadowMaps {
    tiles: wgpu::Buffer,
    depth: Texture,
    nearer: wgpu::Sampler,
}

impl SelfShadowMaps {
    pub(crate) fn new(gpu: &Gpu, plan: &SelfShadowPlan) -> Self {
        let side_px = plan.n_columns * plan.tile_px;
        let shape = TextureShape {
            size_px: [side_px; 2],
            format: TextureFormat::Depth32Float,
            n_samples: 1,
        };
        let no_tiles: Tiles = bytemuck::Zeroable::zeroed();
        Self {
            tiles: gpu.buffer(
                "self shadow tiles",
                bytemuck::bytes_of(&no_tiles),
                BufferUsages::UNIFORM,
            ),
            depth: Texture::target(gpu, "self shadow", shape),
            nearer: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("nearer"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                // Depth is reversed: what is as near to the light as the map, or nearer, is lit.
                compare: Some(wgpu::CompareFunction::GreaterEqual),
                ..Default::default()
            }),
        }
    }

    /// The maps, for a pass that reads them.
    pub(crate) fn bind(&self, gpu: &Gpu, pipeline: &wgpu::RenderPipeline) -> wgpu::BindGroup {
        gpu.bind(
            &pipeline.get_bind_group_layout(GROUP_SELF_SHADOW),
            &[
                (0, self.tiles.as_entire_binding()),
                (1, view(&self.depth.view)),
                (2, wgpu::BindingResource::Sampler(&self.nearer)),
            ],
        )
    }
}

pub(crate) struct SelfShadow {
    pipeline: wgpu::RenderPipeline,
}

/// A posed toy, and the lights' points around it.
pub(crate) struct Shadowed<'a> {
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pose: &'a PoseBuffers,
    pub(crate) light_points: &'a [&'a [Vec4]],
}

impl SelfShadow {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let stream = Stream::new(0, VertexFormat::Float32x3);
        let stages = Stages {
            vertex: "vs_light",
            fragment: "fs_depth",
            buffers: &[stream.layout()],
        };
        let shape = RenderShape {
            targets: &[],
            n_samples: 1,
            depth: Some(nearest_surface()),
            culled: None,
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&SELF_SHADOW, &gpu.module(&SELF_SHADOW), &stages, &shape),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        plan: &SelfShadowPlan,
        shadowed: &Shadowed<'_>,
        maps: &SelfShadowMaps,
    ) {
        let tiles = light_tiles(shadowed.light_points, &shadowed.pose.around, plan);
        gpu.queue.write_buffer(&maps.tiles, 0, bytemuck::bytes_of(&tiles));
        let group = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_SELF_SHADOW),
            &[(0, maps.tiles.as_entire_binding())],
        );
        let mut render = encoder.render(SELF_SHADOW.name, &[], Some(&maps.depth.view), StoreOp::Store);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_SELF_SHADOW, &group, &[]);
        let n_tiles = tiles.n_tiles.iter().sum();
        shadowed
            .toy
            .draw_positions(&mut render, &shadowed.pose.positions, 0..n_tiles);
    }
}
