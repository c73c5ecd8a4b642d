//! `box_filter`: box filter of the shadow term, samples outside the shadow discarded.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::BOX_FILTER;

use super::search::TERM_FORMAT;

pub(crate) struct BoxFilter {
    /// One a set of lights.
    rows: Vec<wgpu::RenderPipeline>,
    columns: wgpu::RenderPipeline,
}

impl BoxFilter {
    /// For the sets from 1 to `n_sets`.
    pub(crate) fn new(gpu: &Gpu, n_sets: u32) -> Self {
        let pipeline = |set: u32| {
            let constants = [("SET", f64::from(set))];
            gpu.fullscreen_pipeline(&BOX_FILTER, "fs_sum", TERM_FORMAT, &constants)
        };
        Self {
            rows: (1..=n_sets).map(pipeline).collect(),
            columns: pipeline(0),
        }
    }

    /// Leaves each set's sums over the box in its layer of `sums`, by way of `between`.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        published: &wgpu::Buffer,
        terms: &wgpu::TextureView,
        (between, sums): (&wgpu::TextureView, &[wgpu::TextureView]),
    ) {
        for (rows, of_set) in self.rows.iter().zip(sums) {
            for (pipeline, from, to) in [(rows, terms, between), (&self.columns, between, of_set)] {
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
}
