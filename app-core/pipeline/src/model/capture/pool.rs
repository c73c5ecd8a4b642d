//! Pooling of pictures in the cells of coarse grids, for `lit` and `residual`.

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Compute, ComputeSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Mirrors, Shader, mirrors};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::TextureView;
use crate::model::state::grids::{CellBuffers, Grids};
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::passes::pictures::ByForm;

/// Sample points of a cell, and its accumulation.
pub(crate) const POOL: Mirrors = mirrors!("common/pool", structs: [Taken], constants: [N_POINTS]);
/// Sample points of a cell along each side.
const N_POINTS: u32 = 8;
/// Workgroups along each side of the largest grid: 64 cells of 8 x 8 invocations.
const WORKGROUPS: u32 = 8;

shared_struct! {
    /// The points of a cell that are sampled.
    pub(crate) struct Taken {
        pub stride: u32,
        pub _pad: u32,
        pub first: [u32; 2],
    }
}

impl Taken {
    /// All points.
    pub(crate) const ALL: Self = Self {
        stride: 1,
        _pad: 0,
        first: [0, 0],
    };

    /// A quarter of the points; the quarters take turns, since the estimate is a mean over several
    /// pictures.
    pub(crate) fn quarter(n_pictures: u32) -> Self {
        // All quarters take their turn whether each picture is used, as under a moving camera, or
        // every second one.
        let turn = n_pictures / 2 + 2 * (n_pictures % 2);
        Self {
            stride: 2,
            _pad: 0,
            first: [[0, 0], [1, 1], [1, 0], [0, 1]][(turn % 4) as usize],
        }
    }
}

pub(crate) struct Pool {
    compute: ByForm<Compute>,
}

/// Grids and cells to pool into.
pub(crate) struct PoolGrids<'a> {
    pub(crate) seen: SeenScene<'a>,
    pub(crate) grids: &'a Buffer,
    /// Contents of `grids`.
    pub(crate) layout: &'a Grids,
    pub(crate) cells: &'a CellBuffers,
    pub(crate) n_receivers: u32,
}

impl Pool {
    /// The slots begin with the grids, the cells and their accumulated sums, and the sampled
    /// points.
    pub(crate) fn new(gpu: &Gpu, shader: &'static Shader, slots: &'static [Slot]) -> Self {
        Self {
            compute: ByForm::new(gpu, move |gpu, form| {
                gpu.compute(&ComputeSpec {
                    shader,
                    entry_point: "cs_pool",
                    groups: [SEEN_SLOTS, slots, &[], &[]],
                    constants: vec![form],
                })
            }),
        }
    }

    /// Pools `pictures`, which are in the order of the slots, the sampler after them.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        on: &PoolGrids<'_>,
        taken: &Taken,
        pictures: &[&TextureView],
    ) {
        let compute = self.compute.of(recorder.gpu, &on.seen.frame);
        let buffers = [on.grids, &on.cells.cells, &on.cells.accumulated].map(Resource::from);
        let sampler = Resource::from(&recorder.gpu.samplers.linear);
        let resources: Vec<_> = buffers
            .into_iter()
            .chain([Resource::PerUse])
            .chain(pictures.iter().map(|picture| Resource::from(*picture)))
            .chain([sampler])
            .collect();
        let groups = [
            on.seen.bind(recorder, compute),
            recorder.bind_with(compute, GROUP_PASS, taken, &resources),
        ];
        let n_side = N_POINTS / taken.stride;
        let n_points = (u64::from(n_side * n_side) * on.layout.n_cells()).min(recorder.n_pixels);
        let workgroups = [WORKGROUPS, WORKGROUPS, on.n_receivers];
        recorder.compute_over(compute, &groups, workgroups, n_points);
    }
}
