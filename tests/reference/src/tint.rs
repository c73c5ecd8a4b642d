//! CPU reference of `tint.wgsl` and `tint_fill.wgsl`: the difference between the real toy's paint
//! and its model's, on one grid per material.
//!
//! Source: Gortler et al. 1996, section 3.4, here in a volume.

use app_pipeline::model::state::tints::TintGrid;
use glam::{DVec3, DVec4, UVec3, Vec3};

use super::model::{BRIGHTEST_USABLE, DARKEST_USABLE};

/// Largest expected linear light of a channel: a photograph is clipped far below.
const MOST_EXPECTED: f64 = 3.0;
/// Number of cells along each side of a grid.
const N_SIDE_CELLS: u32 = 16;
/// Number of pixels from which a cell has full weight.
const FULL_PIXELS: f64 = 16.0;

/// A pixel that shows one surface of the toy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPaint {
    /// The point of the physical toy, in metres.
    pub in_anchor: DVec3,
    /// Index of the toy's material.
    pub material: usize,
    /// The pixel's colour, linear.
    pub seen: DVec3,
    /// The colour of its paint, without what a blurred picture mixes into it.
    pub shown: DVec3,
    /// Its expected colour, from base colour, gain and fitted light.
    pub expected: DVec3,
    /// Its weight, from 0 to 1: less if a blurred picture mixes another surface into it.
    pub weight: f64,
}

/// Cells of a cube, x fastest, then y.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    side: u32,
    cells: Vec<DVec4>,
}

impl Volume {
    fn from_fn(side: u32, mut cell: impl FnMut(UVec3) -> DVec4) -> Self {
        let n_cells = side * side * side;
        let places = (0..n_cells).map(|i| UVec3::new(i % side, i / side % side, i / (side * side)));
        Self {
            side,
            cells: places.map(&mut cell).collect(),
        }
    }

    /// All cells.
    #[must_use]
    pub fn cells(&self) -> &[DVec4] {
        &self.cells
    }

    /// A cell.
    #[must_use]
    pub fn at(&self, cell: UVec3) -> DVec4 {
        self.cells[((cell.z * self.side + cell.y) * self.side + cell.x) as usize]
    }

    /// Interpolated between cells; the centre of the first is at (.5, .5, .5), and the outermost
    /// are repeated outside.
    fn trilinear(&self, at: DVec3) -> DVec4 {
        let last = DVec3::splat(f64::from(self.side - 1));
        let at = (at - 0.5).clamp(DVec3::ZERO, last);
        let corners = (0..8).map(|k| UVec3::new(k & 1, (k >> 1) & 1, k >> 2));
        corners
            .map(|corner| {
                let near = at.floor() + corner.as_dvec3();
                let weights = DVec3::ONE - (at - near).abs();
                weights.element_product() * self.at(near.min(last).as_uvec3())
            })
            .sum()
    }
}

/// The tint in each cell of each material's grid, with alpha 1, from one frame without earlier
/// values.
#[must_use]
pub fn tints(grid: &TintGrid, seen: &[SeenPaint]) -> Vec<Volume> {
    let side = N_SIDE_CELLS;
    let materials = 0..grid.n_materials as usize;
    let last = materials.end - 1;
    materials
        .map(|material| {
            let own: Vec<&SeenPaint> = seen
                .iter()
                .filter(|paint| paint.material.min(last) == material)
                .filter(|paint| paint.seen.max_element() <= BRIGHTEST_USABLE)
                .collect();
            let cell_of = |paint: &SeenPaint| {
                let corner = Vec3::from(grid.corner_in_anchor).as_dvec3();
                let place = (paint.in_anchor - corner) / f64::from(grid.cell_m);
                place.max(DVec3::ZERO).as_uvec3().min(UVec3::splat(side - 1))
            };
            let finest = Volume::from_fn(side, |cell| {
                let here = own.iter().filter(|paint| cell_of(paint) == cell);
                pooled(here.copied())
            });
            filled(finest)
        })
        .collect()
}

/// A cell's tint times its certainty, and that. If all pixels of a cell are mixed, they count as others do.
fn pooled<'a>(seen: impl Iterator<Item = &'a SeenPaint> + Clone) -> DVec4 {
    let most = seen.clone().map(|paint| paint.weight).fold(0.0, f64::max);
    let (mut shown, mut expected, mut n_pixels) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for paint in seen {
        // The sums include a constant, as if each pixel also had an amount too dark to measure,
        // exactly as expected.
        let weight = paint.weight / most;
        shown += weight * paint.shown + DARKEST_USABLE;
        let limited = paint.expected.min(DVec3::splat(MOST_EXPECTED));
        expected += weight * limited + DARKEST_USABLE;
        n_pixels += 1.0;
    }
    if n_pixels == 0.0 {
        return DVec4::ZERO;
    }
    (n_pixels / FULL_PIXELS).min(1.0) * (shown / expected).extend(1.0)
}

/// Every cell completed from the coarser level, the coarsest from the model's own colour.
fn filled(level: Volume) -> Volume {
    if level.side == 1 {
        return Volume::from_fn(1, |cell| {
            let all = level.at(cell);
            all + (1.0 - all.w) * DVec4::ONE
        });
    }
    let coarse = filled(halved(&level));
    Volume::from_fn(level.side, |cell| {
        let own = level.at(cell);
        own + (1.0 - own.w) * coarse.trilinear(0.5 * (cell.as_dvec3() + 0.5))
    })
}

/// Sums of eight, in which eight certain cells count as one.
fn halved(fine: &Volume) -> Volume {
    Volume::from_fn(fine.side / 2, |cell| {
        let children = (0..8).map(|k| 2 * cell + UVec3::new(k & 1, (k >> 1) & 1, k >> 2));
        let sum: DVec4 = children.map(|child| fine.at(child)).sum();
        sum / sum.w.max(1.0)
    })
}
