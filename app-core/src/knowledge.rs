//! What is learned of a place and of the real toy, in whatever view: it stays when the camera moves.

use wgpu::BufferUsages;

use crate::gpu::Gpu;
use crate::gpu::layout::Grids;
use crate::grids::CellBuffers;
use crate::light_tiles::Sphere;
use crate::passes::fit::{Fit, kept_bytes};
use crate::passes::tint::Tints;

/// Fits, residuals, lit colours and tints, with what they are summed from.
pub(crate) struct Knowledge {
    /// What the fit found.
    pub(crate) solution: wgpu::Buffer,
    /// Sums of the fits so far.
    pub(crate) fit_sums: wgpu::Buffer,
    /// What `grids` holds.
    pub(crate) layout: Grids,
    pub(crate) grids: wgpu::Buffer,
    pub(crate) residual: CellBuffers,
    pub(crate) lit: CellBuffers,
    pub(crate) tints: Tints,
    n_lights: usize,
}

impl Knowledge {
    /// Nothing known, on `grids`, of a toy of so many materials within a ball.
    pub(crate) fn new(
        gpu: &Gpu,
        grids: Grids,
        n_lights: usize,
        (toy, n_materials): (&Sphere, usize),
    ) -> Self {
        Self {
            solution: gpu.buffer(
                "fit",
                bytemuck::bytes_of(&Fit::start(n_lights)),
                BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            ),
            fit_sums: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("fit sums"),
                size: kept_bytes(),
                usage: BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            grids: gpu.uniform("grids", &grids),
            residual: CellBuffers::new(gpu, "residual cells", &grids),
            lit: CellBuffers::new(gpu, "lit cells", &grids),
            tints: Tints::new(gpu, toy, n_materials),
            layout: grids,
            n_lights,
        }
    }

    /// Forgets everything, so that nothing of what was wrong is left.
    pub(crate) fn forget(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder) {
        gpu.queue
            .write_buffer(&self.solution, 0, bytemuck::bytes_of(&Fit::start(self.n_lights)));
        encoder.clear_buffer(&self.residual.kept, 0, None);
        encoder.clear_buffer(&self.tints.kept, 0, None);
        self.forget_sums(encoder);
    }

    /// Forgets what fits and lit colours were summed from, and keeps what they found.
    pub(crate) fn forget_sums(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.fit_sums, 0, None);
        encoder.clear_buffer(&self.lit.kept, 0, None);
    }
}
