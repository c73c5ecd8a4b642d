//! Coarse grids over the receivers, and the buffers of their cells.

use wgpu::BufferUsages;

use crate::geometry::rect::PlaneRect;
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::shader::{Mirrors, mirrors};
use crate::gpu::shared::shared_struct;
use app_scene::scene::MAX_RECEIVERS;

/// WGSL part of the grids.
pub(crate) const GRID: Mirrors = mirrors!("common/grid", structs: [Grid, Grids], constants: [MAX_CELLS]);
/// Maximum number of cells of a receiver's grid, at its finest level.
pub const MAX_CELLS: usize = 64 * 64;
/// Bytes of one cell.
const CELL_BYTES: u64 = 16;
/// Levels of the pyramid: 64 cells halve to one in six steps.
const N_LEVELS: usize = 7;
/// Maximum number of cells of a grid along a side.
const MAX_SIDE_CELLS: u32 = 64;
/// Relative margin of a grid around its rectangle on each side, since another clip reaches slightly
/// farther.
const SPARE: f64 = 0.1;
/// Size of the grid over a receiver that neither toy nor shadows reach; any other grid has a longer
/// side.
const UNREACHED: [u32; 2] = [1, 1];

shared_struct! {
    /// The grid over one receiver.
    #[derive(Default)]
    pub struct Grid {
        pub origin_in_plane: [f32; 2],
        pub cell_m: f32,
        pub first_cell: u32,
        pub size: [u32; 2],
        pub _pad: [u32; 2],
    }
}

shared_struct! {
    /// The grids over all receivers.
    #[derive(Default)]
    pub struct Grids {
        pub grids: [Grid; MAX_RECEIVERS],
    }
}

impl Grids {
    /// Cells of the finest levels.
    pub(crate) fn n_cells(&self) -> u64 {
        let sizes = self.grids.iter().map(|grid| grid.size.map(u64::from));
        sizes.map(|[width, height]| width * height).sum()
    }
}

/// Places a grid of square cells over each rectangle, pyramid after pyramid in one buffer.
#[must_use]
pub fn grids_over(rects: &[PlaneRect]) -> Grids {
    let mut grids = Grids::default();
    let mut first_cell = 0;
    for (slot, rect) in grids.grids.iter_mut().zip(rects) {
        *slot = grid_over(rect, first_cell);
        first_cell += n_pyramid_cells(slot.size);
    }
    grids
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "at most 64 cells a side; metres in f32 as shaders have them"
)]
fn grid_over(rect: &PlaneRect, first_cell: u32) -> Grid {
    let rect = PlaneRect {
        min: rect.min - SPARE * (rect.max - rect.min),
        max: rect.max + SPARE * (rect.max - rect.min),
    };
    let size_m = rect.max - rect.min;
    let longest_m = size_m.max_element();
    // A receiver that neither toy nor shadows reach has a grid of one cell without extent, which
    // stays empty.
    if !is_reached(&rect) {
        return Grid {
            origin_in_plane: [0.0; 2],
            cell_m: 0.0,
            first_cell,
            size: UNREACHED,
            _pad: [0; 2],
        };
    }
    let cell_m = longest_m / f64::from(MAX_SIDE_CELLS);
    let n_cells = |side_m: f64| ((side_m / cell_m).ceil() as u32).clamp(1, MAX_SIDE_CELLS);
    Grid {
        origin_in_plane: rect.min.as_vec2().to_array(),
        cell_m: cell_m as f32,
        first_cell,
        size: [n_cells(size_m.x), n_cells(size_m.y)],
        _pad: [0; 2],
    }
}

/// Cells of one quantity on the grids: pyramids, and sums over the previous frames.
pub(crate) struct CellBuffers {
    pub(crate) cells: Buffer,
    pub(crate) accumulated: Buffer,
}

impl CellBuffers {
    /// Buffers filled with zeros.
    pub(crate) fn new(gpu: &Gpu, label: &str, grids: &Grids) -> Self {
        let n_cells: u32 = grids.grids.iter().map(|grid| n_pyramid_cells(grid.size)).sum();
        let usage = BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let buffer = |n_cells: u64| gpu.storage(label, CELL_BYTES * n_cells, usage);
        Self {
            cells: buffer(u64::from(n_cells)),
            accumulated: buffer((MAX_CELLS * MAX_RECEIVERS) as u64),
        }
    }
}

/// Whether toy or shadows reach a receiver in more than a point.
fn is_reached(rect: &PlaneRect) -> bool {
    let longest_m = (rect.max - rect.min).max_element();
    longest_m.is_finite() && longest_m > 0.0
}

/// Whether the grids cover the rectangles.
#[must_use]
pub fn holds(grids: &Grids, rects: &[PlaneRect]) -> bool {
    grids.grids.iter().zip(rects).all(|(grid, rect)| {
        let origin = glam::Vec2::from(grid.origin_in_plane).as_dvec2();
        let size = glam::UVec2::from(grid.size).as_dvec2() * f64::from(grid.cell_m);
        // A tolerance of one cell: points beyond the grid have the value at its border.
        let slack = f64::from(grid.cell_m);
        let is_laid = grid.size != UNREACHED;
        !is_reached(rect)
            || (is_laid
                && rect.min.cmpge(origin - slack).all()
                && rect.max.cmple(origin + size + slack).all())
    })
}

/// Cells of all levels over a grid of `size`.
fn n_pyramid_cells(size: [u32; 2]) -> u32 {
    let mut level = size;
    (0..N_LEVELS)
        .map(|_| {
            let n_cells = level[0] * level[1];
            level = level.map(|cells| cells.div_ceil(2));
            n_cells
        })
        .sum()
}
