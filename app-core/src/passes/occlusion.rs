//! `occlusion`: shadows of the posed toy on the receivers from many light points, in one pass.

use glam::{UVec2, Vec4};
use wgpu::{BlendComponent, BlendFactor, BlendOperation, BlendState, StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, resolved};
use crate::gpu::layout::{LightPoints, MAX_LIGHT_POINTS, MAX_RECEIVERS};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, RenderShape, Stages};
use crate::gpu::shaders::OCCLUSION;
use crate::gpu::texture::{Texture, TextureShape};

use super::toy_mesh::{Stream, ToyMesh};

/// Light points that one colour target holds: four channels of four multisample positions.
const POINTS_PER_TARGET: usize = 16;
const N_SAMPLES: u32 = 4;
const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

/// The pass for a number of light points; more points are more colour targets.
pub(crate) struct Occlusion {
    pipeline: wgpu::RenderPipeline,
    n_points: usize,
}

/// Targets for one map: multisampled ones that stay on the chip, and what they are resolved to.
pub(crate) struct OcclusionTargets {
    samples: Vec<Texture>,
    pub(crate) hidden: Vec<Texture>,
    /// Size of a texel in the region.
    texel_px: [f32; 2],
}

impl OcclusionTargets {
    /// For maps of `size_px` texels over a region of `region_px` pixels.
    pub(crate) fn new(gpu: &Gpu, size_px: UVec2, region_px: UVec2, n_points: usize) -> Self {
        let n_targets = n_points.div_ceil(POINTS_PER_TARGET);
        let shape = |n_samples| TextureShape {
            size_px: size_px.to_array(),
            format: FORMAT,
            n_samples,
        };
        let textures = |label, n_samples| {
            (0..n_targets)
                .map(|_| Texture::target(gpu, label, shape(n_samples)))
                .collect()
        };
        Self {
            samples: textures("occlusion samples", N_SAMPLES),
            hidden: textures("occlusion", 1),
            texel_px: (region_px.as_vec2() / size_px.as_vec2()).to_array(),
        }
    }
}

impl Occlusion {
    /// For 4 points, or a multiple of 16 up to 64.
    pub(crate) fn new(gpu: &Gpu, n_points: usize, n_receivers: u32) -> Self {
        let n_points = n_points.min(MAX_LIGHT_POINTS);
        let keep_largest = BlendComponent {
            src_factor: BlendFactor::One,
            dst_factor: BlendFactor::One,
            operation: BlendOperation::Max,
        };
        let target = wgpu::ColorTargetState {
            format: FORMAT,
            blend: Some(BlendState {
                color: keep_largest,
                alpha: keep_largest,
            }),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let targets = vec![Some(target); n_points.div_ceil(POINTS_PER_TARGET)];
        let stream = Stream::new(0, VertexFormat::Float32x3);
        let stages = Stages {
            vertex: "vs_flatten",
            fragment: "fs_cover",
            buffers: &[stream.layout()],
        };
        let shape = RenderShape {
            targets: &targets,
            n_samples: N_SAMPLES,
            depth: None,
            constants: &[("IS_SHARED", f64::from(u8::from(n_receivers > 1)))],
        };
        let pipeline = gpu.render_pipeline(&OCCLUSION, &gpu.module(&OCCLUSION), &stages, &shape);
        Self { pipeline, n_points }
    }

    /// Draws the caster from its points, of which there are as many as the pass was made for on each receiver.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        caster: &Caster<'_>,
        targets: &OcclusionTargets,
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind(&layout(GROUP_GLOBALS), &[(0, globals.as_entire_binding())]);
        let points = gpu.uniform(
            "light points",
            &self.light_points_uniform(caster.points, targets.texel_px),
        );
        let own = gpu.bind(&layout(GROUP_PASS), &[(0, points.as_entire_binding())]);
        let colors: Vec<_> = targets
            .samples
            .iter()
            .zip(&targets.hidden)
            .map(|(samples, hidden)| Some(resolved(&samples.view, &hidden.view)))
            .collect();
        let mut render = encoder.render(OCCLUSION.name, &colors, None, StoreOp::Discard);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
        render.set_bind_group(GROUP_PASS, &own, &[]);
        let n_instances = u32::try_from(caster.points.len()).unwrap_or(0);
        caster
            .toy
            .draw_positions(&mut render, caster.positions, n_instances);
    }

    fn light_points_uniform(&self, points: &[Vec4], texel_px: [f32; 2]) -> LightPoints {
        let mut uniform = LightPoints {
            points: [[0.0; 4]; MAX_LIGHT_POINTS * MAX_RECEIVERS],
            texel_px,
            n_points: u32::try_from(self.n_points).unwrap_or(1),
            _pad: 0,
        };
        for (slot, point) in uniform.points.iter_mut().zip(points) {
            *slot = point.to_array();
        }
        uniform
    }
}

/// A posed toy and the light points that it hides.
pub(crate) struct Caster<'a> {
    pub(crate) toy: &'a ToyMesh,
    pub(crate) positions: &'a wgpu::Buffer,
    /// Those in the space of the first receiver, then those of the next.
    pub(crate) points: &'a [Vec4],
}
