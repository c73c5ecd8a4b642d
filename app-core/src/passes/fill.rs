//! `fill`: the cells that the toy hides, from those around, by pull-push.

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::pipeline::GROUP_PASS;
use crate::gpu::shaders::FILL;

/// Bytes of one cell.
pub(crate) const CELL_BYTES: u64 = 16;
/// Levels of the pyramid: 64 cells halve to one in six steps.
const N_LEVELS: usize = 7;

pub(crate) struct Fill {
    pipeline: wgpu::ComputePipeline,
}

impl Fill {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            pipeline: gpu.compute_pipeline(&FILL, "cs_pull_push"),
        }
    }

    /// Fills the finest levels of `cells` in place, on `n_receivers` grids.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        (grids, cells): (&wgpu::Buffer, &wgpu::Buffer),
        n_receivers: u32,
    ) {
        let own = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_PASS),
            &[(0, grids.as_entire_binding()), (1, cells.as_entire_binding())],
        );
        encoder.compute(
            FILL.name,
            &self.pipeline,
            &[(GROUP_PASS, &own)],
            [n_receivers, 1, 1],
        );
    }
}

/// Cells of all levels over a grid of `size`.
pub(crate) fn n_pyramid_cells(size: [u32; 2]) -> u32 {
    let mut level = size;
    (0..N_LEVELS)
        .map(|_| {
            let n_cells = level[0] * level[1];
            level = level.map(|cells| cells.div_ceil(2));
            n_cells
        })
        .sum()
}
