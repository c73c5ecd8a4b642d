//! `coverage`: how much of each pixel the posed toy covers, from many positions, in one pass.

use glam::UVec2;
use wgpu::{BlendComponent, BlendFactor, BlendOperation, BlendState, StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, resolved};
use crate::gpu::pipeline::{GROUP_GLOBALS, RenderShape, Stages};
use crate::gpu::shaders::COVERAGE;
use crate::gpu::texture::{Texture, TextureShape};

use super::toy_mesh::{Stream, ToyMesh};

/// Positions that one colour target holds: four channels of four multisample positions.
const POSITIONS_PER_TARGET: u32 = 16;
const N_SAMPLES: u32 = 4;
const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;
/// Most colour targets of the pass.
pub(crate) const MAX_TARGETS: usize = 4;

/// Positions of a pixel that the toy is looked for at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lattice {
    n_positions: u32,
    step: u32,
}

impl Lattice {
    /// The lattice of 16, 32 or 64 positions with the least RMS error of the area that a straight edge of any direction cuts
    /// off a pixel: 0.036, 0.020, 0.012. The four multisample positions alone have 0.092.
    pub(crate) fn new(n_positions: u32) -> Self {
        match n_positions {
            0..=16 => Self { n_positions: 16, step: 5 },
            17..=32 => Self { n_positions: 32, step: 9 },
            _ => Self { n_positions: 64, step: 19 },
        }
    }

    fn n_targets(self) -> u32 {
        self.n_positions / POSITIONS_PER_TARGET
    }
}

pub(crate) struct Coverage {
    pipeline: wgpu::RenderPipeline,
    lattice: Lattice,
}

/// Textures of the region's size: multisampled ones that stay on the chip, and what they are resolved to.
pub(crate) struct CoverageTargets {
    samples: Vec<Texture>,
    pub(crate) covered: Vec<Texture>,
}

impl CoverageTargets {
    pub(crate) fn new(gpu: &Gpu, size_px: UVec2, n_positions: u32) -> Self {
        let textures = |label, n_samples| {
            let shape = TextureShape {
                size_px: size_px.to_array(),
                format: FORMAT,
                n_samples,
            };
            (0..Lattice::new(n_positions).n_targets())
                .map(|_| Texture::target(gpu, label, shape))
                .collect()
        };
        Self {
            samples: textures("coverage samples", N_SAMPLES),
            covered: textures("coverage", 1),
        }
    }

    /// What was drawn; the first stands in for targets that there are not.
    pub(crate) fn views(&self) -> [&wgpu::TextureView; MAX_TARGETS] {
        let of = |index: usize| &self.covered.get(index).unwrap_or(&self.covered[0]).view;
        std::array::from_fn(of)
    }
}

impl Coverage {
    pub(crate) fn new(gpu: &Gpu, n_positions: u32) -> Self {
        let lattice = Lattice::new(n_positions);
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
            targets: &vec![Some(target); lattice.n_targets() as usize],
            n_samples: N_SAMPLES,
            depth: None,
            constants: &[
                ("N_POSITIONS", f64::from(lattice.n_positions)),
                ("LATTICE_STEP", f64::from(lattice.step)),
            ],
        };
        Self {
            pipeline: gpu.render_pipeline(&COVERAGE, &gpu.module(&COVERAGE), &stages, &shape),
            lattice,
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
        toy.draw_positions(&mut render, positions, self.lattice.n_positions);
    }
}
