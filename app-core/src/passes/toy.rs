//! `toy`: the toy in the pose to be shown, with its camera pixels, once for each offset within a pixel.

use glam::{UVec2, Vec2};
use wgpu::{BufferUsages, StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, resolved};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, RenderShape, Stages, nearest_surface, view};
use crate::gpu::shaders::TOY;
use crate::gpu::texture::{Texture, TextureShape};

use super::motion::MOVED_FORMAT;
use super::self_shadow::{GROUP_SELF_SHADOW, SelfShadowMaps};
use super::tint::Tints;
use super::toy_mesh::{Stream, ToyMesh};

/// Format of premultiplied radiance: the resolve averages linear light, and a rim has as many steps as the inside.
const FORMAT: TextureFormat = TextureFormat::Rgba16Float;
const N_SAMPLES: u32 = 4;
/// Offsets of the draws: the multisample positions at half their size around the pixel's centre. The 16 samples of four
/// draws then lie in rows and columns of their own and leave no hole. RMS error of the area that a straight edge of any
/// direction cuts off a pixel: 0.088 with the 4 samples of one draw, 0.041 with 16; at a quarter of their size 0.054.
const OFFSETS_PX: [Vec2; 4] = [
    Vec2::new(-0.0625, -0.1875),
    Vec2::new(0.1875, -0.0625),
    Vec2::new(-0.1875, 0.0625),
    Vec2::new(0.0625, 0.1875),
];

pub(crate) struct Toy {
    pipeline: wgpu::RenderPipeline,
    /// One a draw, in pixels.
    offsets: Vec<wgpu::Buffer>,
}

pub(crate) struct ToyInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) appearance: &'a wgpu::TextureView,
    pub(crate) appearance_lit: &'a wgpu::TextureView,
    pub(crate) object_depth: &'a wgpu::TextureView,
    pub(crate) appearance_base: &'a wgpu::TextureView,
    pub(crate) self_shadow: &'a SelfShadowMaps,
    pub(crate) tints: &'a Tints,
}

/// Textures of the region's size: two multisampled ones that stay on the chip, and one for each draw.
pub(crate) struct ToyTargets {
    samples: Texture,
    depth: Texture,
    first: Texture,
    others: Vec<Texture>,
    moved_samples: Texture,
    /// Where it shows what the camera did not see in that place.
    pub(crate) moved: Texture,
}

impl ToyTargets {
    pub(crate) fn new(gpu: &Gpu, size_px: UVec2, n_draws: u32) -> Self {
        let shape = |format, n_samples| TextureShape {
            size_px: size_px.to_array(),
            format,
            n_samples,
        };
        Self {
            samples: Texture::target(gpu, "toy samples", shape(FORMAT, N_SAMPLES)),
            depth: Texture::target(gpu, "toy depth", shape(TextureFormat::Depth32Float, N_SAMPLES)),
            first: Texture::target(gpu, "toy", shape(FORMAT, 1)),
            others: (1..n_draws)
                .map(|_| Texture::target(gpu, "toy", shape(FORMAT, 1)))
                .collect(),
            moved_samples: Texture::target(gpu, "toy moved samples", shape(MOVED_FORMAT, N_SAMPLES)),
            moved: Texture::target(gpu, "toy moved", shape(MOVED_FORMAT, 1)),
        }
    }

    /// What was drawn; the first stands in for draws that there are not.
    pub(crate) fn views(&self) -> [&wgpu::TextureView; OFFSETS_PX.len()] {
        let mut views = [&self.first.view; OFFSETS_PX.len()];
        views[1..]
            .iter_mut()
            .zip(&self.others)
            .for_each(|(slot, drawn)| *slot = &drawn.view);
        views
    }
}

impl Toy {
    /// For one draw or four.
    pub(crate) fn new(gpu: &Gpu, n_draws: u32) -> Self {
        let streams = [
            Stream::new(2, VertexFormat::Float32x2),
            Stream::new(3, VertexFormat::Float32x4),
            Stream::new(0, VertexFormat::Float32x3),
            Stream::new(1, VertexFormat::Float32x3),
            Stream::new(4, VertexFormat::Float32x3),
            Stream::new(5, VertexFormat::Float32x3),
        ];
        let buffers: Vec<_> = streams.iter().map(Stream::layout).collect();
        let stages = Stages {
            vertex: "vs_toy",
            fragment: "fs_toy",
            buffers: &buffers,
        };
        let shape = RenderShape {
            targets: &[Some(FORMAT.into()), Some(MOVED_FORMAT.into())],
            n_samples: N_SAMPLES,
            depth: Some(nearest_surface()),
            culled: None,
            constants: &[],
        };
        let offsets: &[Vec2] = if n_draws == 1 { &[Vec2::ZERO] } else { &OFFSETS_PX };
        let offsets = offsets.iter().take(n_draws as usize);
        Self {
            pipeline: gpu.render_pipeline(&TOY, &gpu.module(&TOY), &stages, &shape),
            offsets: offsets
                .map(|px| gpu.buffer("toy offset", bytemuck::bytes_of(px), BufferUsages::UNIFORM))
                .collect(),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        toy: &ToyMesh,
        inputs: &ToyInputs<'_>,
        targets: &ToyTargets,
    ) {
        let shared = gpu.bind_buffers(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[inputs.globals, inputs.solution],
        );
        let self_shadow = inputs.self_shadow.bind(gpu, &self.pipeline);
        let materials = toy.material_groups(gpu, &self.pipeline);
        for (drawn, offset) in targets.views().into_iter().zip(&self.offsets) {
            let own = self.own_inputs(gpu, inputs, offset);
            let colors = [
                Some(resolved(&targets.samples.view, drawn)),
                Some(resolved(&targets.moved_samples.view, &targets.moved.view)),
            ];
            let mut render = encoder.render(TOY.name, &colors, Some(&targets.depth.view), StoreOp::Discard);
            render.set_pipeline(&self.pipeline);
            render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
            render.set_bind_group(GROUP_PASS, &own, &[]);
            render.set_bind_group(GROUP_SELF_SHADOW, &self_shadow, &[]);
            toy.draw_parts(&mut render, &[&toy.shown, &toy.physical], &materials);
        }
    }

    fn own_inputs(&self, gpu: &Gpu, inputs: &ToyInputs<'_>, offset: &wgpu::Buffer) -> wgpu::BindGroup {
        gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_PASS),
            &[
                (0, view(inputs.appearance)),
                (1, view(inputs.object_depth)),
                (2, view(inputs.appearance_base)),
                (3, view(inputs.appearance_lit)),
                (4, offset.as_entire_binding()),
                (5, inputs.tints.grid.as_entire_binding()),
                (6, inputs.tints.cells.as_entire_binding()),
            ],
        )
    }
}
