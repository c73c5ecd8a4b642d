//! `estimate`: the plate, with an estimate where no plate shows the place.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::ESTIMATE;

use super::plate::PLATE_FORMAT;

pub(crate) struct Estimate {
    smooth: wgpu::RenderPipeline,
    last: wgpu::RenderPipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct EstimateInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) grids: &'a wgpu::Buffer,
    pub(crate) lit_cells: &'a wgpu::Buffer,
    pub(crate) plate: &'a wgpu::TextureView,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
}

/// How much of the frame an estimate may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fineness {
    /// Smooth: to find the shadow in.
    Smooth,
    /// Each seen pixel tells its own, once the shadow is known.
    Full,
}

impl Estimate {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let pipeline = |is_final: f64| {
            gpu.fullscreen_pipeline(&ESTIMATE, "fs_complete", PLATE_FORMAT, &[("IS_FINAL", is_final)])
        };
        Self {
            smooth: pipeline(0.0),
            last: pipeline(1.0),
            linear: gpu.linear_sampler(),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &EstimateInputs<'_>,
        fineness: Fineness,
        target: &wgpu::TextureView,
    ) {
        let pipeline = match fineness {
            Fineness::Smooth => &self.smooth,
            Fineness::Full => &self.last,
        };
        let shared = gpu.bind_buffers(
            &pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[inputs.globals, inputs.solution],
        );
        let own = gpu.bind(
            &pipeline.get_bind_group_layout(GROUP_PASS),
            &[
                (0, inputs.grids.as_entire_binding()),
                (1, inputs.lit_cells.as_entire_binding()),
                (2, view(inputs.plate)),
                (3, view(inputs.frame)),
                (4, view(inputs.evidence)),
                (5, view(inputs.visibility)),
                (6, view(inputs.ambient)),
                (7, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        );
        let groups = [(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)];
        encoder.fullscreen(ESTIMATE.name, pipeline, &groups, target);
    }
}
