//! `census`: which sets of lights are shadowed anywhere in mask 3c.

use glam::UVec2;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::MAX_RECEIVERS;
use crate::gpu::pipeline::{GROUP_PASS, view};
use crate::gpu::shaders::CENSUS;

/// Invocations of a workgroup along each side.
const WORKGROUP: u32 = 16;
/// A word a receiver, with bit s where the set s of lights was seen.
pub(crate) type SeenSets = [u32; MAX_RECEIVERS];

pub(crate) struct Census {
    pipeline: wgpu::ComputePipeline,
}

impl Census {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.compute_pipeline(&CENSUS, "cs_count"),
        }
    }

    /// Counts over a mask of `size_px`.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        (eligible, size_px): (&wgpu::TextureView, UVec2),
        seen_sets: &wgpu::Buffer,
    ) {
        let layout = self.pipeline.get_bind_group_layout(GROUP_PASS);
        let own = gpu.bind(
            &layout,
            &[(0, view(eligible)), (1, seen_sets.as_entire_binding())],
        );
        encoder.raw.clear_buffer(seen_sets, 0, None);
        let workgroups = [size_px.x.div_ceil(WORKGROUP), size_px.y.div_ceil(WORKGROUP), 1];
        encoder.compute(CENSUS.name, &self.pipeline, &[(GROUP_PASS, &own)], workgroups);
    }
}
