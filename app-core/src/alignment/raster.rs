//! How much of each pixel a mesh covers, and how far away it is there.

use glam::{DVec2, DVec3, IVec2};

use super::rectangle::{index_in, places};
use crate::scene::Intrinsics;

/// Samples of each pixel: 8 rows of 16.
const N_SUB_ROWS: i32 = 8;
const N_SUB_COLUMNS: i32 = 16;
const PIXELS_A_WORD: i32 = 4;
/// Where the samples of each sub-row lie within a column; together they are spread evenly.
const SHIFTS: [f64; N_SUB_ROWS as usize] = [0.0625, 0.5625, 0.3125, 0.8125, 0.1875, 0.6875, 0.4375, 0.9375];

/// Coverage of pixels by a mesh, over a rectangle of the picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Coverage {
    /// Corner of the rectangle, in pixels of the picture.
    pub(super) origin_px: IVec2,
    /// Size of the rectangle.
    pub(super) size_px: IVec2,
    /// 0 to 1 for each pixel, rows from the top.
    values: Vec<f32>,
    /// Depth in metres at the centre of each pixel, infinite where there is no mesh; empty where nobody asked.
    depths_m: Vec<f32>,
}

impl Coverage {
    /// Coverage of a pixel of the picture; 0 outside the rectangle.
    pub(super) fn at(&self, at: IVec2) -> f32 {
        let value = self.index(at).and_then(|index| self.values.get(index));
        value.copied().unwrap_or(0.0)
    }

    /// Depth at a pixel's centre, in metres; infinite where there is no mesh.
    pub(super) fn depth_m(&self, at: IVec2) -> f32 {
        let depth = self.index(at).and_then(|index| self.depths_m.get(index));
        depth.copied().unwrap_or(f32::INFINITY)
    }

    fn index(&self, at: IVec2) -> Option<usize> {
        index_in(self.size_px, at - self.origin_px)
    }

    /// Pixels of the rectangle, row by row.
    pub(super) fn pixels(&self) -> impl Iterator<Item = IVec2> + use<> {
        let origin = self.origin_px;
        places(self.size_px).map(move |place| origin + place)
    }
}

/// Projects points in camera space: u, v in pixels, and depth in metres.
pub(super) fn project(points: &[DVec3], k: &Intrinsics) -> Vec<DVec3> {
    let projected = points.iter().map(|point| {
        let depth_m = -point.z;
        DVec3::new(
            k.cx_px + k.fx_px * point.x / depth_m,
            k.cy_px - k.fy_px * point.y / depth_m,
            depth_m,
        )
    });
    projected.collect()
}

/// Draws meshes on the processor; its buffer is reused.
#[derive(Debug, Default)]
pub(super) struct Rasterizer {
    /// One bit a sample, sub-rows one after the other.
    bits: Vec<u64>,
    n_words: usize,
}

impl Rasterizer {
    /// Coverage by the union of the triangles that face the eye, of projected `corners`, in a picture of `size_px`.
    ///
    /// Triangles that reach behind the camera are left out.
    pub(super) fn coverage(&mut self, corners: &[DVec3], triangles: &[[u32; 3]], size_px: IVec2) -> Coverage {
        self.draw(corners, triangles, size_px, false)
    }

    /// The same, with depths.
    pub(super) fn with_depth(
        &mut self,
        corners: &[DVec3],
        triangles: &[[u32; 3]],
        size_px: IVec2,
    ) -> Coverage {
        self.draw(corners, triangles, size_px, true)
    }

    fn draw(
        &mut self,
        corners: &[DVec3],
        triangles: &[[u32; 3]],
        size_px: IVec2,
        has_depth: bool,
    ) -> Coverage {
        let Some(mut out) = rectangle(corners, size_px) else {
            return Coverage::default();
        };
        let n_pixels = (out.size_px.x * out.size_px.y) as usize;
        out.values.resize(n_pixels, 0.0);
        if has_depth {
            out.depths_m.resize(n_pixels, f32::INFINITY);
        }
        self.n_words = (out.size_px.x as usize).div_ceil(PIXELS_A_WORD as usize);
        self.bits.clear();
        self.bits
            .resize(self.n_words * (out.size_px.y * N_SUB_ROWS) as usize, 0);
        let origin = out.origin_px.as_dvec2().extend(0.0);
        for triangle in triangles {
            let corners = triangle.map(|corner| corners[corner as usize] - origin);
            let [a, b, c] = corners;
            // Rows go down: triangles that face the eye turn to the left.
            let is_facing = (b - a).truncate().perp_dot((c - a).truncate()) < 0.0;
            if !is_facing || a.z <= 0.0 || b.z <= 0.0 || c.z <= 0.0 {
                continue;
            }
            self.set(corners.map(DVec3::truncate), out.size_px);
            if has_depth {
                add_depths(corners, &mut out);
            }
        }
        self.count(&mut out);
        out
    }

    /// Sets the bits within a triangle.
    fn set(&mut self, mut corners: [DVec2; 3], size_px: IVec2) {
        corners.sort_unstable_by(|a, b| a.y.total_cmp(&b.y));
        let [a, b, c] = corners;
        let rows = f64::from(N_SUB_ROWS);
        let n_lines = f64::from(size_px.y * N_SUB_ROWS);
        let n_columns = f64::from(size_px.x * N_SUB_COLUMNS);
        let [first, end] = [a.y, c.y].map(|y| round_up((y * rows - 0.5).min(n_lines)));
        let slope = |from: DVec2, to: DVec2| (to.x - from.x) / (to.y - from.y);
        let (long, upper, lower) = (slope(a, c), slope(a, b), slope(b, c));
        for line in first..end {
            #[allow(clippy::cast_precision_loss, reason = "lines of a picture")]
            let y = (line as f64 + 0.5) / rows;
            let one = a.x + (y - a.y) * long;
            let other = if y < b.y {
                a.x + (y - a.y) * upper
            } else {
                b.x + (y - b.y) * lower
            };
            // Sub-rows have their samples in different places within a column: upright edges are as exact as slanted ones.
            let shift = SHIFTS[line % SHIFTS.len()];
            let column = |x: f64| round_up((x * f64::from(N_SUB_COLUMNS) - shift).min(n_columns));
            let words = &mut self.bits[line * self.n_words..][..self.n_words];
            set_run(words, column(one.min(other)), column(one.max(other)));
        }
    }

    /// Turns bits into coverage.
    fn count(&self, out: &mut Coverage) {
        const OF_SAMPLE: f32 = 1.0 / (N_SUB_ROWS * N_SUB_COLUMNS) as f32;
        let rows = out.values.chunks_exact_mut(out.size_px.x as usize);
        let bits = self.bits.chunks_exact(self.n_words * N_SUB_ROWS as usize);
        for (row, bits) in rows.zip(bits) {
            for sub_row in bits.chunks_exact(self.n_words) {
                for (pixels, word) in row.chunks_mut(PIXELS_A_WORD as usize).zip(sub_row) {
                    if *word == 0 {
                        continue;
                    }
                    let mut rest = *word;
                    for pixel in pixels {
                        #[allow(clippy::cast_precision_loss, reason = "at most 16")]
                        let n_set = (rest & 0xffff).count_ones() as f32;
                        *pixel += OF_SAMPLE * n_set;
                        rest >>= N_SUB_COLUMNS;
                    }
                }
            }
        }
    }
}

/// An empty coverage of the pixels that a mesh can reach; none where it is out of the picture.
fn rectangle(corners: &[DVec3], size_px: IVec2) -> Option<Coverage> {
    let seen = corners.iter().filter(|corner| corner.z > 0.0);
    let (low, high) = seen.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), corner| {
        (low.min(corner.truncate()), high.max(corner.truncate()))
    });
    let size = size_px.as_dvec2();
    let low = low.floor().max(DVec2::ZERO).min(size);
    let high = high.ceil().max(DVec2::ZERO).min(size);
    low.cmplt(high).all().then(|| Coverage {
        origin_px: low.as_ivec2(),
        size_px: (high - low).as_ivec2(),
        values: Vec::new(),
        depths_m: Vec::new(),
    })
}

/// The least whole number that is not below a value of a picture's size; 0 for a negative one.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "bounded by the callers; the library's own rounding is a call, here in the innermost loop"
)]
fn round_up(value: f64) -> usize {
    let down = value as usize;
    down + usize::from((down as f64) < value)
}

/// Sets the bits from `first` to before `end`.
fn set_run(words: &mut [u64], first: usize, end: usize) {
    if first >= end {
        return;
    }
    let (first_word, last_word) = (first / 64, (end - 1) / 64);
    let from = u64::MAX << (first % 64);
    let to = u64::MAX >> (63 - (end - 1) % 64);
    if first_word == last_word {
        words[first_word] |= from & to;
        return;
    }
    words[first_word] |= from;
    words[first_word + 1..last_word].fill(u64::MAX);
    words[last_word] |= to;
}

/// Keeps the nearest depth at each pixel's centre: 1 / depth is affine over the picture.
fn add_depths([a, b, c]: [DVec3; 3], out: &mut Coverage) {
    let (ab, ac) = ((b - a).truncate(), (c - a).truncate());
    let area = ab.perp_dot(ac);
    let (at_a, to_b, to_c) = (1.0 / a.z, 1.0 / b.z - 1.0 / a.z, 1.0 / c.z - 1.0 / a.z);
    // Of a sliver, rounding would go beyond its corners.
    let nearest = at_a + to_b.max(to_c).max(0.0);
    let farthest = at_a + to_b.min(to_c).min(0.0);
    let slope = DVec2::new(to_b * ac.y - to_c * ab.y, to_c * ab.x - to_b * ac.x) / area;
    let limit = f64::from(out.size_px.y);
    let top = a.y.min(b.y).min(c.y);
    let bottom = a.y.max(b.y).max(c.y);
    for row in round_up((top - 0.5).min(limit))..round_up((bottom - 0.5).min(limit)) {
        #[allow(clippy::cast_precision_loss, reason = "rows of a picture")]
        let y = row as f64 + 0.5;
        let Some([left, right]) = crossing([a, b, c], y) else {
            continue;
        };
        let width = f64::from(out.size_px.x);
        let columns = round_up((left - 0.5).min(width))..round_up((right - 0.5).min(width));
        for column in columns {
            #[allow(clippy::cast_precision_loss, reason = "columns of a picture")]
            let at = DVec2::new(column as f64 + 0.5, y);
            let inverse = (at_a + slope.dot(at - a.truncate())).max(farthest).min(nearest);
            #[allow(clippy::cast_possible_truncation, reason = "a depth, to 7 digits")]
            let depth_m = (1.0 / inverse) as f32;
            let kept = &mut out.depths_m[row * out.size_px.x as usize + column];
            *kept = kept.min(depth_m);
        }
    }
}

/// Where the line at `y` enters and leaves a triangle.
fn crossing(corners: [DVec3; 3], y: f64) -> Option<[f64; 2]> {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for (from, to) in [(0, 1), (1, 2), (2, 0)] {
        let (from, to) = (corners[from], corners[to]);
        if (from.y <= y) != (to.y <= y) {
            let x = from.x + (to.x - from.x) * ((y - from.y) / (to.y - from.y));
            range = [range[0].min(x), range[1].max(x)];
        }
    }
    (range[0] < range[1]).then_some(range)
}
