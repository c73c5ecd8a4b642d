//! `visibility`: visibility of a light from the light points that `occlusion` found hidden.

use wgpu::{ColorTargetState, ColorWrites, LoadOp, StoreOp, TextureFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, cleared};
use crate::gpu::pipeline::{GROUP_PASS, RenderShape, Stages, view};
use crate::gpu::shaders::VISIBILITY;

use super::occlusion::OcclusionTargets;

/// The pass for one number of light points, writing one channel of a visibility map.
pub(crate) struct Visibility {
    pipeline: wgpu::RenderPipeline,
    channel: usize,
}

impl Visibility {
    /// Writes channel `channel` of a map of `format`.
    pub(crate) fn new(gpu: &Gpu, n_points: usize, channel: usize, format: TextureFormat) -> Self {
        let masks = [
            ColorWrites::RED,
            ColorWrites::GREEN,
            ColorWrites::BLUE,
            ColorWrites::ALPHA,
        ];
        let target = ColorTargetState {
            format,
            blend: None,
            write_mask: masks[channel.min(masks.len() - 1)],
        };
        let stages = Stages {
            vertex: "vs_fullscreen",
            fragment: "fs_average",
            buffers: &[],
        };
        #[allow(clippy::cast_precision_loss, reason = "at most 64")]
        let constants = [("N_POINTS", n_points as f64)];
        let shape = RenderShape {
            targets: &[Some(target)],
            n_samples: 1,
            depth: None,
            culled: None,
            constants: &constants,
        };
        let pipeline = gpu.render_pipeline(&VISIBILITY, &gpu.module(&VISIBILITY), &stages, &shape);
        Self { pipeline, channel }
    }

    /// Channel 0 starts the map afresh, the others add to it.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        occlusion: &OcclusionTargets,
        visibility: &wgpu::TextureView,
    ) {
        let own = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_PASS),
            &[(0, view(&occlusion.hidden.count.view))],
        );
        let mut target = cleared(visibility);
        if self.channel > 0 {
            target.ops.load = LoadOp::Load;
        }
        let mut render = encoder.render(VISIBILITY.name, &[Some(target)], None, StoreOp::Discard);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_PASS, &own, &[]);
        render.draw(0..3, 0..1);
    }
}
