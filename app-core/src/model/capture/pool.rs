//! Pooling of pictures in the cells of coarse grids, for `lit` and `residual`.

use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Compute, ComputeSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Part, Shader, part};
use crate::gpu::texture::TextureView;
use crate::model::state::grids::{CellBuffers, Grids};
use crate::model::state::solution::{SCENE_SLOTS, Scene};

/// Sample points of a cell, and its accumulation.
pub(crate) const POOL: Part = part!("common/pool", constants: [N_POINTS]);
/// Points of a cell along each side.
const N_POINTS: u32 = 8;
/// Workgroups along each side of the largest grid: 64 cells of 8 x 8 invocations.
const WORKGROUPS: u32 = 8;

pub(crate) struct Pool {
    compute: Compute,
}

/// Grids and cells to pool into.
pub(crate) struct PoolGrids<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) grids: &'a Buffer,
    /// Contents of `grids`.
    pub(crate) layout: &'a Grids,
    pub(crate) cells: &'a CellBuffers,
    pub(crate) n_receivers: u32,
}

impl Pool {
    /// The slots begin with the grids, the cells and their accumulated sums.
    pub(crate) fn new(gpu: &Gpu, shader: &'static Shader, slots: &'static [Slot]) -> Self {
        Self {
            compute: gpu.compute(&ComputeSpec {
                shader,
                entry_point: "cs_pool",
                groups: [SCENE_SLOTS, slots, &[], &[]],
            }),
        }
    }

    /// Pools `pictures`, which are in the order of the slots, the sampler after them.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, on: &PoolGrids<'_>, pictures: &[&TextureView]) {
        let buffers = [on.grids, &on.cells.cells, &on.cells.accumulated].map(Resource::from);
        let sampler = Resource::from(&recorder.gpu.samplers.linear);
        let resources: Vec<_> = buffers
            .into_iter()
            .chain(pictures.iter().map(|picture| Resource::from(*picture)))
            .chain([sampler])
            .collect();
        let groups = [
            recorder.bind(&self.compute, GROUP_SCENE, &on.scene.resources()),
            recorder.bind(&self.compute, GROUP_PASS, &resources),
        ];
        let n_points = (u64::from(N_POINTS * N_POINTS) * on.layout.n_cells()).min(recorder.n_pixels);
        let workgroups = [WORKGROUPS, WORKGROUPS, on.n_receivers];
        recorder.compute_over(&self.compute, &groups, workgroups, n_points);
    }
}
