//! Square tiles of a target, of which some are marked: where a pass has to look closely.

use glam::{UVec2, Vec2};

/// Pixels along each side of a tile.
pub const TILE_PX: u32 = 4;

/// What lies within so many pixels along both axes is marked as a box.
const SHORT_PX: f32 = TILE_PX as f32;

/// Tiles of a target, in rows, whose last ones may reach past its border.
#[derive(Clone, Debug)]
pub struct Tiles {
    /// Tiles along each side.
    size: UVec2,
    is_marked: Vec<bool>,
}

/// A box in pixels: its least corner, and its most.
pub type PixelBox = [Vec2; 2];

impl Tiles {
    /// None marked yet.
    #[must_use]
    pub fn over(size_px: UVec2) -> Self {
        let size = UVec2::new(size_px.x.div_ceil(TILE_PX), size_px.y.div_ceil(TILE_PX));
        Self {
            size,
            is_marked: vec![false; (size.x * size.y) as usize],
        }
    }

    /// Marks all tiles that a segment meets, or that lie within `reach_px` of it along either axis.
    pub fn mark_segment(&mut self, [from, to]: PixelBox, reach_px: Vec2) {
        let (low, high) = (from.min(to) - reach_px, from.max(to) + reach_px);
        // Of a short one there is nothing to leave out.
        if (high - low).cmplt(Vec2::splat(SHORT_PX)).all() {
            return self.mark_box([low, high]);
        }
        let Some(rows) = span(low.y, high.y, self.size.y) else {
            return;
        };
        let along = to - from;
        for row in rows {
            let [top, bottom] = [tile_px(row) - reach_px.y, tile_px(row + 1) + reach_px.y];
            // The part of the segment that can reach into the row.
            let at = |y: f32| ((y - from.y) / along.y).clamp(0.0, 1.0);
            let [t0, t1] = if along.y == 0.0 {
                [0.0, 1.0]
            } else {
                [at(top), at(bottom)]
            };
            let [x0, x1] = [t0, t1].map(|t| from.x + t * along.x);
            if let Some(columns) = span(x0.min(x1) - reach_px.x, x0.max(x1) + reach_px.x, self.size.x) {
                self.mark_row(row, columns);
            }
        }
    }

    /// Marks all tiles that a box meets.
    pub fn mark_box(&mut self, [low, high]: PixelBox) {
        let columns = span(low.x, high.x, self.size.x);
        let rows = span(low.y, high.y, self.size.y);
        if let Some((columns, rows)) = columns.zip(rows) {
            for row in rows {
                self.mark_row(row, columns.clone());
            }
        }
    }

    fn mark_row(&mut self, row: u32, columns: std::ops::Range<u32>) {
        let first = row * self.size.x;
        self.is_marked[(first + columns.start) as usize..(first + columns.end) as usize].fill(true);
    }

    /// Whether the tile that holds a pixel is marked.
    #[must_use]
    pub fn is_marked_at(&self, px: UVec2) -> bool {
        let tile = px / TILE_PX;
        tile.cmplt(self.size).all() && self.is_marked[(tile.y * self.size.x + tile.x) as usize]
    }

    /// Runs of marked tiles, row by row: each a box in pixels.
    pub fn runs(&self) -> impl Iterator<Item = PixelBox> + '_ {
        let width = self.size.x as usize;
        (0..)
            .zip(self.is_marked.chunks(width.max(1)))
            .flat_map(|(row, tiles)| {
                let mut end = 0;
                std::iter::from_fn(move || {
                    let start = end + tiles.get(end..)?.iter().position(|marked| *marked)?;
                    let rest = tiles[start..].iter().position(|marked| !marked);
                    end = rest.map_or(tiles.len(), |n| start + n);
                    #[allow(
                        clippy::cast_possible_truncation,
                        reason = "tiles of a row are counted in 32 bits"
                    )]
                    let [left, right] = [start, end].map(|column| tile_px(column as u32));
                    Some([Vec2::new(left, tile_px(row)), Vec2::new(right, tile_px(row + 1))])
                })
            })
    }

    /// Sums over the tiles, to ask for many boxes.
    #[must_use]
    pub fn counted(&self) -> CountedTiles {
        let stride = self.size.x as usize + 1;
        let mut sums = vec![0; stride * (self.size.y as usize + 1)];
        for (row, tiles) in self.is_marked.chunks((self.size.x as usize).max(1)).enumerate() {
            let mut of_row = 0;
            for (column, marked) in tiles.iter().enumerate() {
                of_row += u32::from(*marked);
                sums[(row + 1) * stride + column + 1] = sums[row * stride + column + 1] + of_row;
            }
        }
        CountedTiles {
            size: self.size,
            sums,
        }
    }
}

/// How many tiles are marked above and left of each corner. Source: Crow 1984 (summed-area tables).
pub struct CountedTiles {
    size: UVec2,
    sums: Vec<u32>,
}

impl CountedTiles {
    /// Whether a box meets any marked tile.
    #[must_use]
    pub fn meets(&self, [low, high]: PixelBox) -> bool {
        let columns = span(low.x, high.x, self.size.x);
        let rows = span(low.y, high.y, self.size.y);
        let sum = |row: u32, column: u32| self.sums[(row * (self.size.x + 1) + column) as usize];
        columns.zip(rows).is_some_and(|(columns, rows)| {
            let [top, bottom] = [rows.start, rows.end];
            sum(bottom, columns.end) + sum(top, columns.start)
                > sum(top, columns.end) + sum(bottom, columns.start)
        })
    }
}

/// The tiles between two places, both within; none where all of that is beyond the target.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "clamped to the number of tiles"
)]
fn span(low_px: f32, high_px: f32, n_tiles: u32) -> Option<std::ops::Range<u32>> {
    let tile = |px: f32| (px / TILE_PX as f32).floor();
    let (first, last) = (tile(low_px), tile(high_px));
    // What is no number is everywhere.
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

#[allow(clippy::cast_precision_loss, reason = "pixels of a picture")]
fn tile_px(tile: u32) -> f32 {
    (tile * TILE_PX) as f32
}
