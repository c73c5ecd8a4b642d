//! `coverage`: how much of each pixel the posed toy covers, from many positions, in one pass.

use wgpu::{CompareFunction, Face, VertexFormat};

use crate::counting::{CountingTargets, counting, ordered};
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::N_POSITIONS;
use crate::gpu::pipeline::{GROUP_GLOBALS, RenderShape, Stages};
use crate::gpu::shaders::COVERAGE;

use super::toy_mesh::{Stream, ToyMesh};

pub(crate) struct Coverage {
    pipeline: wgpu::RenderPipeline,
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
        targets: &CountingTargets,
    ) {
        let shared = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[(0, globals.as_entire_binding())],
        );
        let pose = &toy.shown;
        let is_within = pose.around.holds(camera_in_stage.as_dvec3().extend(1.0));
        let triangles = toy.shadow_ranges.seen_from(is_within);
        let mut render = targets.render(encoder, COVERAGE.name);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
        toy.bind_positions(&mut render, &pose.positions);
        render.draw_indexed(triangles, 0, 0..N_POSITIONS as u32);
    }
}
