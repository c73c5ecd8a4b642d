//! `coverage`: how much of each pixel the posed toy covers, from many positions, in one pass.

use glam::UVec2;
use wgpu::{BlendComponent, BlendFactor, BlendOperation, BlendState, StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, resolved};
use crate::gpu::pipeline::{GROUP_GLOBALS, RenderShape, Stages};
use crate::gpu::shaders::COVERAGE;
use crate::gpu::texture::{Texture, TextureShape};

use super::toy_mesh::{Stream, ToyMesh};

/// Colour targets, of 16 positions each: four channels of four multisample positions.
const N_TARGETS: usize = 2;
/// As many as the targets hold. RMS error of the area that a straight edge of any direction cuts off a pixel: 0.020, where
/// the four multisample positions alone have 0.092 and 16 such positions 0.036.
const N_POSITIONS: u32 = 32;
const N_SAMPLES: u32 = 4;
const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

pub(crate) struct Coverage {
    pipeline: wgpu::RenderPipeline,
}

/// Textures of the region's size: multisampled ones that stay on the chip, and what they are resolved to.
pub(crate) struct CoverageTargets {
    samples: [Texture; N_TARGETS],
    covered: [Texture; N_TARGETS],
}

impl CoverageTargets {
    pub(crate) fn new(gpu: &Gpu, size_px: UVec2) -> Self {
        let target = |label, n_samples| {
            let shape = TextureShape {
                size_px: size_px.to_array(),
                format: FORMAT,
                n_samples,
            };
            Texture::target(gpu, label, shape)
        };
        Self {
            samples: std::array::from_fn(|_| target("coverage samples", N_SAMPLES)),
            covered: std::array::from_fn(|_| target("coverage", 1)),
        }
    }

    pub(crate) fn textures(&self) -> [&wgpu::Texture; N_TARGETS] {
        self.covered.each_ref().map(|covered| &covered.raw)
    }

    /// What was drawn: each channel has four positions.
    pub(crate) fn views(&self) -> [&wgpu::TextureView; N_TARGETS] {
        self.covered.each_ref().map(|covered| &covered.view)
    }
}

impl Coverage {
    pub(crate) fn new(gpu: &Gpu) -> Self {
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
        let stream = Stream::new(0, VertexFormat::Float32x3);
        let stages = Stages {
            vertex: "vs_move",
            fragment: "fs_cover",
            buffers: &[stream.layout()],
        };
        let shape = RenderShape {
            targets: &std::array::from_fn::<_, N_TARGETS, _>(|_| Some(target.clone())),
            n_samples: N_SAMPLES,
            depth: None,
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&COVERAGE, &gpu.module(&COVERAGE), &stages, &shape),
        }
    }

    /// Draws the toy at `positions` once for each place in a pixel.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        (toy, positions): (&ToyMesh, &wgpu::Buffer),
        targets: &CoverageTargets,
    ) {
        let shared = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[(0, globals.as_entire_binding())],
        );
        let colors: Vec<_> = targets
            .samples
            .iter()
            .zip(&targets.covered)
            .map(|(samples, covered)| Some(resolved(&samples.view, &covered.view)))
            .collect();
        let mut render = encoder.render(COVERAGE.name, &colors, None, StoreOp::Discard);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
        toy.draw_positions(&mut render, positions, N_POSITIONS);
    }
}
