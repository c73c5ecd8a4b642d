//! Square tiles of a target, some of which are marked for a pass that must treat them separately.

use std::ops::Range;

use glam::{UVec2, Vec2};

use crate::geometry::rect::PixelRect;

/// Tiles of a target, in rows; the last ones may extend beyond its border.
#[derive(Clone, Debug)]
pub struct Tiles {
    /// Size of the target.
    size_px: UVec2,
    grid: Grid,
    is_marked: Vec<bool>,
}

/// Partition of a target into tiles.
#[derive(Clone, Copy, Debug)]
struct Grid {
    /// Pixels along each side of a tile.
    tile_px: u32,
    /// Tiles along each side of the target.
    size: UVec2,
}

/// A box in pixels: its lowest corner and its highest one.
pub type PixelBox = [Vec2; 2];

impl Tiles {
    /// Tiles of `tile_px` pixels along each side, none of them marked.
    #[must_use]
    pub fn over(size_px: UVec2, tile_px: u32) -> Self {
        let size = UVec2::new(size_px.x.div_ceil(tile_px), size_px.y.div_ceil(tile_px));
        Self {
            size_px,
            grid: Grid { tile_px, size },
            is_marked: vec![false; (size.x * size.y) as usize],
        }
    }

    /// Adds the marks of another set of the same size.
    pub fn join(&mut self, other: &Self) {
        debug_assert_eq!(self.is_marked.len(), other.is_marked.len());
        for (is_marked, of_other) in self.is_marked.iter_mut().zip(&other.is_marked) {
            *is_marked |= of_other;
        }
    }

    /// The marked tiles that another set of the same size does not mark.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        debug_assert_eq!(self.is_marked.len(), other.is_marked.len());
        let pairs = self.is_marked.iter().zip(&other.is_marked);
        Self {
            is_marked: pairs
                .map(|(is_marked, of_other)| *is_marked && !of_other)
                .collect(),
            ..*self
        }
    }

    /// Marks all of them.
    pub fn mark_all(&mut self) {
        self.is_marked.fill(true);
    }

    /// Marks all tiles that a segment meets, and those within `reach_px` of it along either axis.
    pub fn mark_segment(&mut self, [from, to]: PixelBox, reach_px: Vec2) {
        let (low, high) = (from.min(to) - reach_px, from.max(to) + reach_px);
        // A short segment has no tiles that could be left out.
        if (high - low).cmplt(Vec2::splat(self.grid.px(1))).all() {
            return self.mark_box([low, high]);
        }
        let Some(rows) = self.grid.rows(low.y, high.y) else {
            return;
        };
        let along = to - from;
        for row in rows {
            let [top, bottom] = [self.grid.px(row) - reach_px.y, self.grid.px(row + 1) + reach_px.y];
            // The part of the segment that can reach into the row.
            let at = |y: f32| ((y - from.y) / along.y).clamp(0.0, 1.0);
            let [t0, t1] = if along.y == 0.0 {
                [0.0, 1.0]
            } else {
                [at(top), at(bottom)]
            };
            let [x0, x1] = [t0, t1].map(|t| from.x + t * along.x);
            if let Some(columns) = self
                .grid
                .columns(x0.min(x1) - reach_px.x, x0.max(x1) + reach_px.x)
            {
                self.mark_row(row, columns);
            }
        }
    }

    /// Marks all tiles that a box meets.
    pub fn mark_box(&mut self, [low, high]: PixelBox) {
        let columns = self.grid.columns(low.x, high.x);
        if let Some((columns, rows)) = columns.zip(self.grid.rows(low.y, high.y)) {
            for row in rows {
                self.mark_row(row, columns.clone());
            }
        }
    }

    fn mark_row(&mut self, row: u32, columns: Range<u32>) {
        let first = row * self.grid.size.x;
        self.is_marked[(first + columns.start) as usize..(first + columns.end) as usize].fill(true);
    }

    /// Whether the tile that contains a pixel is marked.
    #[must_use]
    pub fn is_marked_at(&self, px: UVec2) -> bool {
        let (tile, size) = (px / self.grid.tile_px, self.grid.size);
        tile.cmplt(size).all() && self.is_marked[(tile.y * size.x + tile.x) as usize]
    }

    /// Runs of marked tiles, row by row, each as a box in pixels.
    pub fn runs(&self) -> impl Iterator<Item = PixelBox> + '_ {
        self.rows_of_runs(true).flat_map(|(row, runs)| {
            let grid = self.grid;
            runs.map(move |run| {
                [
                    Vec2::new(grid.px(run.start), grid.px(row)),
                    Vec2::new(grid.px(run.end), grid.px(row + 1)),
                ]
            })
        })
    }

    /// Rectangles that cover the marked tiles, or the unmarked ones, within the target.
    #[must_use]
    pub fn rects(&self, is_marked: bool) -> Vec<PixelRect> {
        let mut rects: Vec<PixelRect> = Vec::new();
        // Indices of the rectangles that reach down to the row.
        let mut open: Vec<usize> = Vec::new();
        for (row, runs) in self.rows_of_runs(is_marked) {
            let above = std::mem::take(&mut open);
            for run in runs {
                let of_run = self.grid.rect(row, run, self.size_px);
                let goes_on = |index: &&usize| {
                    let known = rects[**index];
                    (known.origin_px.x, known.size_px.x) == (of_run.origin_px.x, of_run.size_px.x)
                };
                if let Some(index) = above.iter().find(goes_on) {
                    rects[*index].size_px.y += of_run.size_px.y;
                    open.push(*index);
                } else {
                    open.push(rects.len());
                    rects.push(of_run);
                }
            }
        }
        rects
    }

    /// For each row in turn, the runs of marked tiles or of unmarked ones.
    fn rows_of_runs(&self, is_marked: bool) -> impl Iterator<Item = (u32, impl Iterator<Item = Range<u32>>)> {
        let width = self.grid.size.x as usize;
        (0..)
            .zip(self.is_marked.chunks(width.max(1)))
            .map(move |(row, tiles)| {
                let mut end = 0;
                let runs = std::iter::from_fn(move || {
                    let start = end + tiles.get(end..)?.iter().position(|marked| *marked == is_marked)?;
                    let rest = tiles[start..].iter().position(|marked| *marked != is_marked);
                    end = rest.map_or(tiles.len(), |n| start + n);
                    #[allow(
                        clippy::cast_possible_truncation,
                        reason = "tiles of a row are counted in 32 bits"
                    )]
                    Some(start as u32..end as u32)
                });
                (row, runs)
            })
    }

    /// The tiles with their sums, for many queries.
    #[must_use]
    pub fn counted(&self) -> CountedTiles {
        let size = self.grid.size;
        let stride = size.x as usize + 1;
        let mut sums = vec![0; stride * (size.y as usize + 1)];
        for (row, tiles) in self.is_marked.chunks((size.x as usize).max(1)).enumerate() {
            let mut of_row = 0;
            for (column, marked) in tiles.iter().enumerate() {
                of_row += u32::from(*marked);
                sums[(row + 1) * stride + column + 1] = sums[row * stride + column + 1] + of_row;
            }
        }
        CountedTiles {
            grid: self.grid,
            sums,
        }
    }
}

/// Number of marked tiles above and left of each corner. Source: Crow 1984 (summed-area tables).
pub struct CountedTiles {
    grid: Grid,
    sums: Vec<u32>,
}

impl CountedTiles {
    /// Whether a box meets any marked tile.
    #[must_use]
    pub fn meets(&self, [low, high]: PixelBox) -> bool {
        let columns = self.grid.columns(low.x, high.x);
        let sum = |row: u32, column: u32| self.sums[(row * (self.grid.size.x + 1) + column) as usize];
        columns
            .zip(self.grid.rows(low.y, high.y))
            .is_some_and(|(columns, rows)| {
                let [top, bottom] = [rows.start, rows.end];
                sum(bottom, columns.end) + sum(top, columns.start)
                    > sum(top, columns.end) + sum(bottom, columns.start)
            })
    }
}

impl Grid {
    /// The columns between two positions, inclusive; `None` if all of them are outside the target.
    fn columns(&self, low_px: f32, high_px: f32) -> Option<Range<u32>> {
        span(self.px(1), [low_px, high_px], self.size.x)
    }

    /// The rows between two positions, inclusive; `None` if all of them are outside the target.
    fn rows(&self, low_px: f32, high_px: f32) -> Option<Range<u32>> {
        span(self.px(1), [low_px, high_px], self.size.y)
    }

    /// Start of a column or a row in pixels.
    fn px(&self, tile: u32) -> f32 {
        (tile * self.tile_px) as f32
    }

    /// A run of tiles, limited to a target of `size_px`.
    fn rect(&self, row: u32, run: Range<u32>, size_px: UVec2) -> PixelRect {
        let origin_px = self.tile_px * UVec2::new(run.start, row);
        let end_px = self.tile_px * UVec2::new(run.end, row + 1);
        PixelRect {
            origin_px,
            size_px: end_px.min(size_px) - origin_px,
        }
    }
}

/// The tiles between two positions, inclusive; `None` if all of them are outside the target.
#[allow(clippy::cast_possible_truncation, reason = "clamped to the number of tiles")]
fn span(tile_px: f32, between_px: [f32; 2], n_tiles: u32) -> Option<Range<u32>> {
    let [first, last] = between_px.map(|px| (px / tile_px).floor());
    // A position that is not a number counts as everywhere.
    if last < 0.0 || first >= n_tiles as f32 || n_tiles == 0 {
        return None;
    }
    let first = if first >= 0.0 { first as u32 } else { 0 };
    let last = if last < n_tiles as f32 {
        last as u32
    } else {
        n_tiles - 1
    };
    (first <= last).then_some(first..last + 1)
}
