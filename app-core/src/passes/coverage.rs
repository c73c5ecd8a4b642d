//! `coverage`: how much of each pixel the posed toy covers, from many positions, in one pass.

use glam::UVec2;
use wgpu::{CompareFunction, Face, StoreOp, VertexFormat};

use crate::counting::{COUNT_FORMAT, ORDER_FORMAT, counting, ordered};
use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, cleared};
use crate::gpu::layout::N_POSITIONS;
use crate::gpu::pipeline::{GROUP_GLOBALS, RenderShape, Stages};
use crate::gpu::shaders::COVERAGE;
use crate::gpu::texture::{Texture, TextureShape};

use super::toy_mesh::{Stream, ToyMesh};

pub(crate) struct Coverage {
    pipeline: wgpu::RenderPipeline,
}

/// Textures of the region's size.
pub(crate) struct CoverageTargets {
    /// Which position was drawn last; never leaves the chip.
    order: Texture,
    /// What covered positions add up to.
    pub(crate) covered: Texture,
}

impl CoverageTargets {
    pub(crate) fn new(gpu: &Gpu, size_px: UVec2) -> Self {
        let target = |label, format| {
            let shape = TextureShape {
                size_px: size_px.to_array(),
                format,
                n_samples: 1,
            };
            Texture::target(gpu, label, shape)
        };
        Self {
            order: target("coverage order", ORDER_FORMAT),
            covered: target("coverage", COUNT_FORMAT),
        }
    }
}

impl Coverage {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let stream = Stream::new(0, VertexFormat::Float32x3);
        let stages = Stages {
            vertex: "vs_move",
            fragment: "fs_cover",
            buffers: &[stream.layout()],
        };
        let shape = RenderShape {
            targets: &[Some(counting())],
            n_samples: 1,
            depth: Some(ordered(CompareFunction::Greater)),
            culled: Some(Face::Back),
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&COVERAGE, &gpu.module(&COVERAGE), &stages, &shape),
        }
    }

    /// Draws the shown toy once for each position in a pixel, as seen from `camera_in_stage`.
    #[allow(clippy::cast_possible_truncation, reason = "a few positions")]
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        (toy, camera_in_stage): (&ToyMesh, glam::Vec3),
        targets: &CoverageTargets,
    ) {
        let shared = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[(0, globals.as_entire_binding())],
        );
        let pose = &toy.shown;
        let is_within = pose.around.holds(camera_in_stage.as_dvec3().extend(1.0));
        let triangles = toy.shadow_ranges.seen_from(is_within);
        let colors = [Some(cleared(&targets.covered.view))];
        let mut render = encoder.render(
            COVERAGE.name,
            &colors,
            Some(&targets.order.view),
            StoreOp::Discard,
        );
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
        toy.bind_positions(&mut render, &pose.positions);
        render.draw_indexed(triangles, 0, 0..N_POSITIONS as u32);
    }
}
