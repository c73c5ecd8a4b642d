//! The tints of the toy's paint: the ratios of its colours to those of the model.

use wgpu::BufferUsages;

use crate::gpu::buffer::Buffer;
use crate::gpu::context::{Gpu, GpuError};
use crate::gpu::shader::{Mirrors, mirrors};
use crate::gpu::shared::shared_struct;
use app_scene::geometry::bounds::Sphere;

/// WGSL part of the grids.
pub(crate) const TINT_GRID: Mirrors = mirrors!("common/tint_grid", structs: [TintGrid]);
/// WGSL part of their cells.
pub(crate) const TINT_CELL: Mirrors =
    mirrors!("common/tint_cells", constants: [TINT_SIDE, TINT_CELLS, N_TINT_SUMS]);
/// Trilinear interpolation between cells.
pub(crate) const BETWEEN_TINTS: Mirrors = mirrors!("common/between_tints", constants: [TINT_PYRAMID]);

/// Cells of a grid of tints along each side.
pub const TINT_SIDE: usize = 16;
/// Cells of a grid of tints.
pub(crate) const TINT_CELLS: usize = TINT_SIDE * TINT_SIDE * TINT_SIDE;
/// Cells of all levels of its pyramid: 16, 8, 4, 2 and 1 along each side, a geometric series.
pub(crate) const TINT_PYRAMID: usize = (8 * TINT_CELLS - 1) / 7;
/// Sums of a cell of tints.
pub(crate) const N_TINT_SUMS: usize = 7;
/// Maximum number of materials with a grid of their own.
const MAX_GRIDS: usize = 8;

shared_struct! {
    /// Layout of the cells: cubes around the whole physical toy.
    pub struct TintGrid {
        pub corner_in_anchor: [f32; 3],
        pub cell_m: f32,
        pub n_materials: u32,
        pub _pad_0: u32,
        pub _pad_1: [u32; 2],
    }
}

/// Tints of the real toy's paint, relative to its model's.
#[derive(Clone, Debug, PartialEq)]
pub struct TintMap {
    /// Layout of the cells.
    pub grid: TintGrid,
    /// For each material with a grid, the tints of its cells, x fastest, then y; alpha is 1.
    pub materials: Vec<Vec<[f32; 4]>>,
}

/// The tints of a toy's paint, on grids over its physical pose.
pub(crate) struct Tints {
    pub(crate) grid: Buffer,
    /// All levels of each material's grid, finest first.
    pub(crate) cells: Buffer,
    /// Sums of one frame.
    pub(crate) sums: Buffer,
    /// Accumulated sums of the finest cells.
    pub(crate) accumulated: Buffer,
    /// Contents of `grid`.
    pub(crate) layout: TintGrid,
}

impl Tints {
    /// Tints of zero, for a toy within `around`.
    pub(crate) fn new(gpu: &Gpu, around: &Sphere, n_materials: usize) -> Self {
        let n_grids = n_materials.clamp(1, MAX_GRIDS);
        let layout = tint_grid(around, n_grids);
        let buffer = |label, n_bytes: usize, usage| gpu.storage(label, (n_grids * n_bytes) as u64, usage);
        let cell_bytes = size_of::<[f32; 4]>();
        Self {
            cells: buffer("tints", TINT_PYRAMID * cell_bytes, BufferUsages::COPY_SRC),
            sums: buffer(
                "tint sums",
                TINT_CELLS * N_TINT_SUMS * size_of::<u32>(),
                BufferUsages::COPY_DST,
            ),
            accumulated: buffer("tints so far", TINT_CELLS * cell_bytes, BufferUsages::COPY_DST),
            grid: gpu.uniform("tint grid", &layout),
            layout,
        }
    }

    /// Moves the grids to another position of the toy; their contents must then be reset.
    pub(crate) fn surround(&mut self, gpu: &Gpu, around: &Sphere) {
        self.layout = tint_grid(around, self.layout.n_materials as usize);
        gpu.write(&self.grid, &[self.layout]);
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

/// Cubes around the whole physical toy.
#[allow(
    clippy::cast_possible_truncation,
    reason = "metres in f32 as shaders have them, and few grids"
)]
fn tint_grid(around: &Sphere, n_grids: usize) -> TintGrid {
    TintGrid {
        corner_in_anchor: (around.centre - around.radius_m).as_vec3().to_array(),
        // A toy of one point lies in one cell.
        cell_m: (2.0 * around.radius_m / TINT_SIDE as f64).max(f64::from(f32::MIN_POSITIVE)) as f32,
        n_materials: n_grids as u32,
        _pad_0: 0,
        _pad_1: [0; 2],
    }
}
