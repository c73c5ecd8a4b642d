//! `box_filter`: box filter of the shadow term, samples outside the shadow discarded.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::BOX_FILTER;

use super::search::TERM_FORMAT;

pub(crate) struct BoxFilter {
    rows: wgpu::RenderPipeline,
    columns: wgpu::RenderPipeline,
}

impl BoxFilter {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let pipeline = |is_rows: f64| {
            gpu.fullscreen_pipeline(&BOX_FILTER, "fs_sum", TERM_FORMAT, &[("IS_ROWS", is_rows)])
        };
        Self {
            rows: pipeline(1.0),
            columns: pipeline(0.0),
        }
    }

    /// Leaves the sums over the box in `sums`, by way of `between`.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        published: &wgpu::Buffer,
        terms: &wgpu::TextureView,
        (between, sums): (&wgpu::TextureView, &wgpu::TextureView),
    ) {
        for (pipeline, from, to) in [(&self.rows, terms, between), (&self.columns, between, sums)] {
            let layout = |group| pipeline.get_bind_group_layout(group);
            let shared = gpu.bind(&layout(GROUP_GLOBALS), &[(2, published.as_entire_binding())]);
            let own = gpu.bind(&layout(GROUP_PASS), &[(0, view(from))]);
            encoder.fullscreen(
                BOX_FILTER.name,
                pipeline,
                &[(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)],
                to,
            );
        }
    }
}
