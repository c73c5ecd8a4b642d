//! Scene state, accumulated over the views of a scene and its real toy, and independent of the
//! camera.

pub mod grids;
pub mod solution;
pub mod tints;

use wgpu::BufferUsages;

use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::model::state::grids::{CellBuffers, Grids};
use crate::model::state::solution::accumulated_bytes;
use crate::model::state::tints::Tints;
use app_scene::geometry::bounds::Sphere;

/// Fits, residuals, lit colours and tints, with their accumulated sums.
pub(crate) struct SceneState {
    /// Solution of the fits.
    pub(crate) solution: Buffer,
    /// Accumulated sums of the fits.
    pub(crate) fit_sums: Buffer,
    /// Contents of `grids`.
    pub(crate) layout: Grids,
    pub(crate) grids: Buffer,
    pub(crate) residual: CellBuffers,
    pub(crate) lit: CellBuffers,
    pub(crate) tints: Tints,
    n_lights: usize,
}

impl SceneState {
    /// State of zeros, except for the starting solution: on `grids`, for a toy within a ball with
    /// this number of materials.
    pub(crate) fn new(
        gpu: &Gpu,
        grids: Grids,
        n_lights: usize,
        (toy, n_materials): (&Sphere, usize),
    ) -> Self {
        Self {
            solution: gpu.buffer(
                "fit",
                bytemuck::bytes_of(&solution::start(n_lights)),
                BufferUsages::STORAGE | BufferUsages::COPY_SRC,
            ),
            fit_sums: gpu.storage(
                "fit sums",
                accumulated_bytes(),
                BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            ),
            grids: gpu.uniform("grids", &grids),
            residual: CellBuffers::new(gpu, "residual cells", &grids),
            lit: CellBuffers::new(gpu, "lit cells", &grids),
            tints: Tints::new(gpu, toy, n_materials),
            layout: grids,
            n_lights,
        }
    }

    /// Resets everything, so that no wrong value remains.
    pub(crate) fn forget(&self, recorder: &mut Recorder<'_>) {
        recorder
            .gpu
            .write(&self.solution, &[solution::start(self.n_lights)]);
        recorder.clear(&self.residual.accumulated);
        recorder.clear(&self.tints.accumulated);
        recorder.clear(&self.lit.cells);
        self.forget_sums(recorder);
    }

    /// Resets the sums of fits and lit colours, but keeps their solutions.
    pub(crate) fn forget_sums(&self, recorder: &mut Recorder<'_>) {
        recorder.clear(&self.fit_sums);
        recorder.clear(&self.lit.accumulated);
    }
}
