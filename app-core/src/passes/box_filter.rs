//! `box_filter`: box filter of the shadow term, samples outside the shadow discarded.

use wgpu::{LoadOp, StoreOp};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, cleared};
use crate::gpu::layout::MAX_LIGHTS;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::BOX_FILTER;

use super::search::TERM_FORMAT;

/// The filter on one receiver.
struct OfReceiver {
    /// One a set of lights, from the set 1 on.
    rows: Vec<wgpu::RenderPipeline>,
    columns: wgpu::RenderPipeline,
}

pub(crate) struct BoxFilter {
    receivers: Vec<OfReceiver>,
}

impl BoxFilter {
    /// For the first `n_receivers` receivers and the sets from 1 to `n_sets`.
    pub(crate) fn new(gpu: &Gpu, n_receivers: u32, n_sets: u32) -> Self {
        let pipeline = |receiver: u32, label: u32| {
            let constants = [("LABEL", f64::from(label)), ("RECEIVER", f64::from(receiver))];
            gpu.fullscreen_pipeline(&BOX_FILTER, "fs_sum", TERM_FORMAT, &constants)
        };
        let of_receiver = |receiver: u32| OfReceiver {
            rows: (1..=n_sets)
                .map(|set| pipeline(receiver, (receiver << MAX_LIGHTS) + set))
                .collect(),
            columns: pipeline(receiver, 0),
        };
        Self {
            receivers: (0..n_receivers).map(of_receiver).collect(),
        }
    }

    /// Leaves each set's sums over the box in its layer of `sums`, by way of `between`.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        (globals, published): (&wgpu::Buffer, &wgpu::Buffer),
        terms: &wgpu::TextureView,
        (between, sums): (&wgpu::TextureView, &[wgpu::TextureView]),
    ) {
        let shared = [
            (0, globals.as_entire_binding()),
            (2, published.as_entire_binding()),
        ];
        for (receiver, pipelines) in self.receivers.iter().enumerate() {
            for (rows, of_set) in pipelines.rows.iter().zip(sums) {
                draw(gpu, encoder, rows, (&shared, terms), cleared(between));
                let mut target = cleared(of_set);
                if receiver > 0 {
                    target.ops.load = LoadOp::Load;
                }
                draw(gpu, encoder, &pipelines.columns, (&shared, between), target);
            }
        }
    }
}

fn draw(
    gpu: &Gpu,
    encoder: &mut Encoder,
    pipeline: &wgpu::RenderPipeline,
    (shared, from): (&[(u32, wgpu::BindingResource<'_>)], &wgpu::TextureView),
    to: wgpu::RenderPassColorAttachment<'_>,
) {
    let layout = |group| pipeline.get_bind_group_layout(group);
    let shared = gpu.bind(&layout(GROUP_GLOBALS), shared);
    let own = gpu.bind(&layout(GROUP_PASS), &[(0, view(from))]);
    let mut render = encoder.render(BOX_FILTER.name, &[Some(to)], None, StoreOp::Discard);
    render.set_pipeline(pipeline);
    render.set_bind_group(GROUP_GLOBALS, &shared, &[]);
    render.set_bind_group(GROUP_PASS, &own, &[]);
    render.draw(0..3, 0..1);
}
