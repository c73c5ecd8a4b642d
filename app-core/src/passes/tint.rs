//! `tint` and `tint_fill`: how the real toy's paint differs from its model's, also where no camera has seen it.

use wgpu::BufferUsages;

use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{N_TINT_SUMS, TINT_CELLS, TINT_PYRAMID, TINT_SIDE, TintGrid};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, view};
use crate::gpu::shaders::{TINT, TINT_FILL};
use crate::gpu::{Gpu, GpuError};
use crate::light_tiles::Sphere;
use crate::maps::TintMap;
use crate::plan::Plan;

/// Materials that have a grid of their own.
const MAX_GRIDS: usize = 8;
/// Invocations of a workgroup along each side.
const WORKGROUP_PX: u32 = 8;

pub(crate) struct Tint {
    add: wgpu::ComputePipeline,
    fill: wgpu::ComputePipeline,
}

/// The tints of a toy's paint, on grids over its physical pose.
pub(crate) struct Tints {
    pub(crate) grid: wgpu::Buffer,
    /// All levels of each material's grid, finest first.
    pub(crate) cells: wgpu::Buffer,
    /// Sums of one frame.
    sums: wgpu::Buffer,
    /// Sums of the finest cells over the frames so far.
    pub(crate) kept: wgpu::Buffer,
    /// What `grid` holds.
    layout: TintGrid,
}

pub(crate) struct TintInputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) object_depth: &'a wgpu::TextureView,
    pub(crate) object_normal: &'a wgpu::TextureView,
    pub(crate) object_received: &'a wgpu::TextureView,
    pub(crate) object_base: &'a wgpu::TextureView,
}

impl Tints {
    /// Nothing known of a toy within `around`.
    pub(crate) fn new(gpu: &Gpu, around: &Sphere, n_materials: usize) -> Self {
        let n_grids = n_materials.clamp(1, MAX_GRIDS);
        let layout = tint_grid(around, n_grids);
        let buffer = |label, n_bytes: usize, usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: (n_grids * n_bytes) as u64,
                usage: BufferUsages::STORAGE | usage,
                mapped_at_creation: false,
            })
        };
        let cell_bytes = size_of::<[f32; 4]>();
        Self {
            cells: buffer("tints", TINT_PYRAMID * cell_bytes, BufferUsages::COPY_SRC),
            sums: buffer(
                "tint sums",
                TINT_CELLS * N_TINT_SUMS * size_of::<u32>(),
                BufferUsages::COPY_DST,
            ),
            kept: buffer("tints so far", TINT_CELLS * cell_bytes, BufferUsages::COPY_DST),
            grid: gpu.uniform("tint grid", &layout),
            layout,
        }
    }

    /// Waits for the device and returns the grid, and the finest cells of each material.
    pub(crate) fn read(&self, gpu: &Gpu) -> Result<TintMap, GpuError> {
        let cells: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&self.cells)?);
        let pyramids = cells.chunks_exact(TINT_PYRAMID);
        let finest = pyramids.map(|levels| levels[..TINT_CELLS].to_vec());
        Ok(TintMap {
            grid: self.layout,
            materials: finest.collect(),
        })
    }
}

/// Cubes around all of the physical toy.
#[allow(
    clippy::cast_possible_truncation,
    reason = "metres in f32 as shaders have them, and few grids"
)]
fn tint_grid(around: &Sphere, n_grids: usize) -> TintGrid {
    TintGrid {
        corner_in_stage: (around.centre - around.radius_m).as_vec3().to_array(),
        // A toy of one point lies in one cell.
        cell_m: (2.0 * around.radius_m / TINT_SIDE as f64).max(f64::from(f32::MIN_POSITIVE)) as f32,
        n_materials: n_grids as u32,
        _pad_0: 0,
        _pad_1: [0; 2],
    }
}

impl Tint {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            add: gpu.compute_pipeline(&TINT, "cs_add"),
            fill: gpu.compute_pipeline(&TINT_FILL, "cs_fill"),
        }
    }

    /// Adds what a frame shows of the toy to what is known of its paint.
    pub(crate) fn encode(&self, gpu: &Gpu, encoder: &mut Encoder, inputs: &TintInputs<'_>, tints: &Tints) {
        encoder.raw.clear_buffer(&tints.sums, 0, None);
        let shared = gpu.bind_buffers(
            &self.add.get_bind_group_layout(GROUP_GLOBALS),
            &[inputs.globals, inputs.solution],
        );
        let stride_px = inputs.plan.fit_stride_px;
        let stride = gpu.uniform("tint stride", &stride_px);
        let own = gpu.bind(
            &self.add.get_bind_group_layout(GROUP_PASS),
            &[
                (0, tints.grid.as_entire_binding()),
                (1, tints.sums.as_entire_binding()),
                (2, view(inputs.frame)),
                (3, view(inputs.evidence)),
                (4, view(inputs.object_depth)),
                (5, view(inputs.object_normal)),
                (6, view(inputs.object_received)),
                (7, view(inputs.object_base)),
                (8, stride.as_entire_binding()),
            ],
        );
        let taken = inputs
            .plan
            .region
            .size_px
            .map(|side_px| side_px.div_ceil(stride_px));
        let workgroups = taken.map(|side| side.div_ceil(WORKGROUP_PX));
        let groups = [(GROUP_GLOBALS, &shared), (GROUP_PASS, &own)];
        encoder.compute(TINT.name, &self.add, &groups, [workgroups.x, workgroups.y, 1]);
        self.encode_fill(gpu, encoder, tints);
    }

    fn encode_fill(&self, gpu: &Gpu, encoder: &mut Encoder, tints: &Tints) {
        let own = gpu.bind(
            &self.fill.get_bind_group_layout(GROUP_PASS),
            &[
                (0, tints.sums.as_entire_binding()),
                (1, tints.kept.as_entire_binding()),
                (2, tints.cells.as_entire_binding()),
            ],
        );
        encoder.compute(
            TINT_FILL.name,
            &self.fill,
            &[(GROUP_PASS, &own)],
            [tints.layout.n_materials, 1, 1],
        );
    }
}
