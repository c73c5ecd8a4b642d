//! CPU reference of `common/grid.wgsl` and `common/pool.wgsl`: square cells over a receiver, and
//! their accumulated values.

use app_pipeline::model::state::grids::Grid;
use glam::{DVec2, DVec3, DVec4, UVec2, Vec2};

use super::model::{Region, centre_px};
use super::raster::Raster;

/// Number of points of a cell along each side.
const N_POINTS: u32 = 8;
/// Fraction of a cell's points that must be evidence for full certainty.
const FULL_SHARE: f64 = 0.25;
/// Largest weight of all earlier frames together, in frames like the latest.
const MAX_FRAMES: f64 = 8.0;

/// The selected points of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// All of them.
    All,
    /// One of each four neighbours: its column and row.
    Quarter(u32, u32),
}

impl Taken {
    /// Their numbers, row by row.
    fn points(self) -> impl Iterator<Item = u32> {
        (0..N_POINTS * N_POINTS).filter(move |k| match self {
            Self::All => true,
            Self::Quarter(column, row) => [k % N_POINTS % 2, k / N_POINTS % 2] == [column, row],
        })
    }
}

/// The value of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cell {
    /// Per channel.
    pub value: DVec3,
    /// Certainty, from 0 to 1.
    pub certainty: f64,
}

/// Square cells over a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneGrid {
    /// Corner of the first cell, (x, z) in plane space.
    pub origin_in_plane: DVec2,
    /// Side of a cell.
    pub cell_m: f64,
    /// Cells along each side.
    pub size: UVec2,
}

impl From<&Grid> for PlaneGrid {
    fn from(grid: &Grid) -> Self {
        Self {
            origin_in_plane: Vec2::from(grid.origin_in_plane).as_dvec2(),
            cell_m: f64::from(grid.cell_m),
            size: grid.size.into(),
        }
    }
}

impl PlaneGrid {
    /// The texels of a cell's selected points, once for each point that is within the region and
    /// that no other receiver hides.
    pub fn texels_of<'a>(
        &'a self,
        region: &'a Region,
        receiver: usize,
        cell: UVec2,
        taken: Taken,
    ) -> impl Iterator<Item = UVec2> + 'a {
        taken.points().filter_map(move |k| {
            let within = (UVec2::new(k % N_POINTS, k / N_POINTS).as_dvec2() + 0.5) / f64::from(N_POINTS);
            let in_plane = self.origin_in_plane + (cell.as_dvec2() + within) * self.cell_m;
            let px = region.receivers[receiver].region_px(in_plane)?;
            let is_within = px.cmpge(DVec2::ZERO).all() && px.cmplt(region.size_px.as_dvec2()).all();
            let texel = is_within.then(|| px.as_uvec2())?;
            let shown = region.receiver_point(centre_px(texel))?;
            (shown.receiver == receiver).then_some(texel)
        })
    }

    /// The interpolated value at a point of the receiver.
    #[must_use]
    pub fn value_at(&self, cells: &Raster<DVec3>, in_plane: DVec2) -> DVec3 {
        cells.bilinear((in_plane - self.origin_in_plane) / self.cell_m)
    }
}

/// Certainty of a cell with `n_points` of the selected points as evidence.
#[must_use]
pub fn certainty(n_points: f64, taken: Taken) -> f64 {
    let n_taken = match taken {
        Taken::All => N_POINTS * N_POINTS,
        Taken::Quarter(..) => N_POINTS * N_POINTS / 4,
    };
    (n_points / (FULL_SHARE * f64::from(n_taken))).min(1.0)
}

/// The new value of a cell: the mean of all observations, weighted by certainty, and the sums to
/// keep, of values times certainties and of certainties, which are limited to `MAX_FRAMES` full
/// ones.
#[must_use]
pub fn accumulate(accumulated: DVec4, fresh: Cell) -> (Cell, DVec4) {
    let sum = accumulated + (fresh.value * fresh.certainty).extend(fresh.certainty);
    if sum.w == 0.0 {
        return (Cell::default(), DVec4::ZERO);
    }
    let value = sum.truncate() / sum.w;
    let cell = Cell {
        value,
        certainty: sum.w.min(1.0),
    };
    let weight = sum.w.min(MAX_FRAMES);
    (cell, (value * weight).extend(weight))
}
