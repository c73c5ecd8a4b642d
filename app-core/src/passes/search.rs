//! `search`: the shadow term of each texel of the new shadows, by the warp or by the concentric ring search.

use wgpu::{StoreOp, TextureFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, cleared};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, RenderShape, Stages, view};
use crate::gpu::shaders::SEARCH;

/// Format of terms and of their sums.
pub(crate) const TERM_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Format of the count of taps.
pub(crate) const TAPS_FORMAT: TextureFormat = TextureFormat::R16Float;

pub(crate) struct Search {
    pipeline: wgpu::RenderPipeline,
}

pub(crate) struct SearchInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) published: &'a wgpu::Buffer,
    pub(crate) warp: &'a wgpu::TextureView,
    pub(crate) eligible: &'a wgpu::TextureView,
    pub(crate) seen_sets: &'a wgpu::Buffer,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plate: &'a wgpu::TextureView,
}

impl Search {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let stages = Stages {
            vertex: "vs_fullscreen",
            fragment: "fs_search",
            buffers: &[],
        };
        let shape = RenderShape {
            targets: &[Some(TERM_FORMAT.into()), Some(TAPS_FORMAT.into())],
            n_samples: 1,
            depth: None,
            culled: None,
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&SEARCH, &gpu.module(&SEARCH), &stages, &shape),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &SearchInputs<'_>,
        (terms, taps): (&wgpu::TextureView, &wgpu::TextureView),
    ) {
        let layout = |group| self.pipeline.get_bind_group_layout(group);
        let shared = gpu.bind(
            &layout(GROUP_GLOBALS),
            &[
                (0, inputs.globals.as_entire_binding()),
                (2, inputs.published.as_entire_binding()),
            ],
        );
        let own = gpu.bind(
            &layout(GROUP_PASS),
            &[
                (0, view(inputs.warp)),
                (1, view(inputs.eligible)),
                (2, view(inputs.frame)),
                (3, view(inputs.plate)),
                (4, inputs.seen_sets.as_entire_binding()),
            ],
        );
        let targets = [Some(cleared(terms)), Some(cleared(taps))];
        let mut render = encoder.render(SEARCH.name, &targets, None, StoreOp::Discard);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
        render.set_bind_group(GROUP_PASS, &own, &[]);
        render.draw(0..3, 0..1);
    }
}
