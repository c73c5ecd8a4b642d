//! Rasterises meshes: the covered fraction of each pixel, and the depth there.

use std::ops::Range;

use glam::{DVec2, DVec3, IVec2};

use super::picture::{index_in, places};
use app_scene::geometry::edges::Faces;
use app_scene::scene::Intrinsics;

/// Number of sub-rows of a pixel; each has 16 samples.
const N_SUB_ROWS: i32 = 8;
const N_SUB_COLUMNS: i32 = 16;
/// Offsets of the samples of each sub-row within a column; together they are evenly spread.
const SHIFTS: [f64; N_SUB_ROWS as usize] = [0.0625, 0.5625, 0.3125, 0.8125, 0.1875, 0.6875, 0.4375, 0.9375];

/// Least depth of a triangle's part that is drawn: no camera focuses there.
const NEAREST_M: f64 = 1e-3;

/// Coverage of pixels by a mesh, over a rectangle of the picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Coverage {
    /// Corner of the rectangle, in pixels of the picture.
    pub(super) origin_px: IVec2,
    /// Size of the rectangle.
    pub(super) size_px: IVec2,
    /// 0 to 1 for each pixel, rows from the top.
    values: Vec<f32>,
    /// Depth in metres at the centre of each pixel, infinite without a mesh; empty if not
    /// requested.
    depths_m: Vec<f32>,
}

impl Coverage {
    /// Coverage of a pixel of the picture; 0 outside the rectangle.
    pub(super) fn at(&self, at: IVec2) -> f32 {
        let value = self.index(at).and_then(|index| self.values.get(index));
        value.copied().unwrap_or(0.0)
    }

    /// Whether any pixel in a square around one, `reach_px` to each side, is covered.
    pub(super) fn is_near(&self, at: IVec2, reach_px: i32) -> bool {
        let reach = -reach_px..=reach_px;
        let mut around = reach
            .clone()
            .flat_map(|y| reach.clone().map(move |x| IVec2::new(x, y)));
        around.any(|step| self.at(at + step) > 0.0)
    }

    /// Depth at a pixel's centre, in metres; infinite without a mesh.
    pub(super) fn depth_m(&self, at: IVec2) -> f32 {
        let depth = self.index(at).and_then(|index| self.depths_m.get(index));
        depth.copied().unwrap_or(f32::INFINITY)
    }

    /// First pixel of each row of the rectangle, and the column after its last.
    pub(super) fn rows(&self) -> impl Iterator<Item = (IVec2, i32)> + use<> {
        let (origin, size) = (self.origin_px, self.size_px);
        (0..size.y).map(move |row| (origin + IVec2::new(0, row), origin.x + size.x))
    }

    fn index(&self, at: IVec2) -> Option<usize> {
        index_in(self.size_px, at - self.origin_px)
    }

    /// Times a value at each pixel, without depths.
    pub(super) fn times(&self, of: impl Fn(IVec2) -> f32) -> Self {
        let values = self.pixels().zip(&self.values);
        let values = values.map(|(at, covered)| if *covered > 0.0 { covered * of(at) } else { 0.0 });
        Self {
            values: values.collect(),
            depths_m: Vec::new(),
            ..*self
        }
    }

    /// Pixels of the rectangle, row by row.
    pub(super) fn pixels(&self) -> impl Iterator<Item = IVec2> + use<> {
        let origin = self.origin_px;
        places(self.size_px).map(move |place| origin + place)
    }
}

/// Projects points in camera space: u, v in pixels, and depth in metres.
pub(super) fn project(points: impl IntoIterator<Item = DVec3>, k: &Intrinsics) -> Vec<DVec3> {
    let projected = points.into_iter().map(|point| {
        let depth_m = -point.z;
        DVec3::new(
            k.cx_px + k.fx_px * point.x / depth_m,
            k.cy_px - k.fy_px * point.y / depth_m,
            depth_m,
        )
    });
    projected.collect()
}

/// Draws meshes on the processor; its buffers are reused.
#[derive(Debug, Default)]
pub(super) struct Rasterizer {
    /// Whether each triangle faces the eye, and one more that does not.
    facing: Vec<bool>,
    /// Intersections of the outline with the sub-rows, and the end of each sub-row among them.
    crossings: Vec<Crossing>,
    ends: Vec<u32>,
    sorted: Vec<u32>,
    /// Difference of samples between each pixel of a row and the one before.
    more: Vec<i32>,
}

/// An intersection of the outline with a sub-row.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    line: u32,
    /// Twice the first column of samples after it, plus one if the mesh ends there.
    place: u32,
}

impl Rasterizer {
    /// Coverage by the union of the triangles that face the eye, of projected `corners`, in a
    /// picture of `size_px`.
    ///
    /// Triangles that reach behind the camera are skipped. Only edges of the outline are drawn,
    /// between a triangle that faces the eye and one that does not: the winding number of the
    /// outline around a sample is the number of the mesh's layers there.
    pub(super) fn coverage(&mut self, corners: &[DVec3], faces: &Faces, size_px: IVec2) -> Coverage {
        let Some(mut out) = rectangle(corners, size_px) else {
            return Coverage::default();
        };
        self.draw(corners, faces, &mut out);
        out
    }

    /// The same, with depths.
    pub(super) fn with_depth(&mut self, corners: &[DVec3], faces: &Faces, size_px: IVec2) -> Coverage {
        let mut out = self.coverage(corners, faces, size_px);
        out.depths_m.resize(out.values.len(), f32::INFINITY);
        let origin = out.origin_px.as_dvec2().extend(0.0);
        if out.values.is_empty() {
            return out;
        }
        let facing = faces.triangles.iter().zip(&self.facing);
        for (triangle, _) in facing.filter(|(_, is_facing)| **is_facing) {
            add_depths(triangle.map(|corner| corners[corner as usize] - origin), &mut out);
        }
        out
    }

    fn draw(&mut self, corners: &[DVec3], faces: &Faces, out: &mut Coverage) {
        self.facing.clear();
        self.facing.extend(
            faces
                .triangles
                .iter()
                .map(|triangle| is_facing(triangle.map(|corner| corners[corner as usize]))),
        );
        self.facing.push(false);
        self.crossings.clear();
        let origin = out.origin_px.as_dvec2();
        for edge in &faces.edges {
            let [is_left, is_right] = edge.sides.map(|side| self.facing[side as usize]);
            if is_left == is_right {
                continue;
            }
            let ends = edge
                .corners
                .map(|corner| corners[corner as usize].truncate() - origin);
            self.cross(ends, is_left, out.size_px);
        }
        self.sort((out.size_px.y * N_SUB_ROWS) as usize);
        self.fill(out);
    }

    /// Adds an edge; `is_left` is true if the front face is the triangle that has its ends in this
    /// order.
    fn cross(&mut self, [from, to]: [DVec2; 2], is_left: bool, size_px: IVec2) {
        let is_down = from.y < to.y;
        let [a, b] = if is_down { [from, to] } else { [to, from] };
        let rows = f64::from(N_SUB_ROWS);
        let n_lines = f64::from(size_px.y * N_SUB_ROWS);
        let n_columns = f64::from(size_px.x * N_SUB_COLUMNS);
        let [first, end] = [a.y, b.y].map(|y| round_up((y * rows - 0.5).min(n_lines)));
        if first >= end {
            return;
        }
        let slope = (b.x - a.x) / (b.y - a.y);
        // Triangles that face the eye turn to the left, and rows go down: edges that go down have
        // them on their right.
        let is_end = u32::from(is_down != is_left);
        for line in first..end {
            let y = (line as f64 + 0.5) / rows;
            let x = a.x + (y - a.y) * slope;
            // Sub-rows have different sample offsets within a column: axis-parallel edges are as
            // accurate as slanted ones.
            let shift = SHIFTS[line % SHIFTS.len()];
            let column = round_up((x * f64::from(N_SUB_COLUMNS) - shift).min(n_columns));
            #[allow(clippy::cast_possible_truncation, reason = "samples of a picture's side")]
            self.crossings.push(Crossing {
                line: line as u32,
                place: 2 * column as u32 + is_end,
            });
        }
    }

    /// Sorts the crossings by line and by place.
    fn sort(&mut self, n_lines: usize) {
        self.ends.clear();
        self.ends.resize(n_lines, 0);
        for crossing in &self.crossings {
            self.ends[crossing.line as usize] += 1;
        }
        let mut end = 0;
        for count in &mut self.ends {
            let first = end;
            end += *count;
            *count = first;
        }
        self.sorted.clear();
        self.sorted.resize(self.crossings.len(), 0);
        for crossing in &self.crossings {
            let place = &mut self.ends[crossing.line as usize];
            self.sorted[*place as usize] = crossing.place;
            *place += 1;
        }
        let mut first = 0;
        for end in &self.ends {
            self.sorted[first..*end as usize].sort_unstable();
            first = *end as usize;
        }
    }

    /// Converts runs of samples to coverage.
    fn fill(&mut self, out: &mut Coverage) {
        const OF_SAMPLE: f32 = 1.0 / (N_SUB_ROWS * N_SUB_COLUMNS) as f32;
        let width = out.size_px.x as usize;
        let mut first = 0;
        for ends in self.ends.chunks_exact(N_SUB_ROWS as usize) {
            self.more.clear();
            self.more.resize(width + 2, 0);
            for end in ends {
                let mut depth = 0;
                for place in &self.sorted[first..*end as usize] {
                    let (column, is_end) = (place / 2, place % 2 == 1);
                    let before = depth;
                    depth += if is_end { -1 } else { 1 };
                    if before == 0 || depth == 0 {
                        add_run(&mut self.more, column, if is_end { -1 } else { 1 });
                    }
                }
                first = *end as usize;
            }
            let mut n_samples = 0;
            out.values.extend(self.more[..width].iter().map(|more| {
                n_samples += more;

                OF_SAMPLE * n_samples as f32
            }));
        }
    }
}

/// The depth in metres of the nearest of some triangles in camera space at the centre of each pixel
/// that shows one, whichever side of it.
pub(super) fn nearest_depths(
    triangles: impl IntoIterator<Item = [DVec3; 3]>,
    k: &Intrinsics,
    size_px: IVec2,
) -> impl Iterator<Item = (IVec2, f32)> {
    let mut out = Coverage {
        size_px,
        depths_m: vec![f32::INFINITY; places(size_px).count()],
        ..Coverage::default()
    };
    for triangle in triangles {
        let corners = project(before_camera(triangle), k);
        // A polygon as a fan.
        for far in 2..corners.len() {
            add_depths([corners[0], corners[far - 1], corners[far]], &mut out);
        }
    }
    let depths = places(size_px).zip(out.depths_m);
    depths.filter(|(_, depth_m)| depth_m.is_finite())
}

/// The part of a triangle in camera space that lies before the camera: a polygon of 0, 3 or 4 corners.
///
/// Source: Sutherland and Hodgman 1974.
fn before_camera(triangle: [DVec3; 3]) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(4);
    for (from, to) in [(0, 1), (1, 2), (2, 0)].map(|(from, to)| (triangle[from], triangle[to])) {
        let [of_from, of_to] = [from, to].map(|corner| -corner.z - NEAREST_M);
        if of_from >= 0.0 {
            kept.push(from);
        }
        if (of_from >= 0.0) != (of_to >= 0.0) {
            kept.push(from.lerp(to, of_from / (of_from - of_to)));
        }
    }
    kept
}

/// Whether a projected triangle faces the eye and lies in front of it.
fn is_facing([a, b, c]: [DVec3; 3]) -> bool {
    // Rows go down: triangles that face the eye turn to the left.
    let turns_left = (b - a).truncate().perp_dot((c - a).truncate()) < 0.0;
    // Without a branch, which would be mispredicted half of the time.
    turns_left & (a.z.min(b.z).min(c.z) > 0.0)
}

/// Adds one sample at all columns of a sub-row from the given one on, or removes it.
fn add_run(more: &mut [i32], column: u32, sign: i32) {
    const OF_PIXEL: u32 = N_SUB_COLUMNS as u32;
    let pixel = (column / OF_PIXEL) as usize;
    let passed = (column % OF_PIXEL).cast_signed();
    more[pixel] += sign * (N_SUB_COLUMNS - passed);
    more[pixel + 1] += sign * passed;
}

/// An empty coverage of the pixels that a mesh can reach; `None` if it is out of the picture.
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

/// The smallest integer not below a value of a picture's size; 0 for a negative one.
#[allow(
    clippy::cast_possible_truncation,
    reason = "bounded by the callers; the library's own rounding is a call, here in the innermost loop"
)]
fn round_up(value: f64) -> usize {
    // A narrower number takes fewer instructions.
    let down = value as u32;
    (down + u32::from(f64::from(down) < value)) as usize
}

/// Keeps the nearest depth at each pixel's centre: 1 / depth is affine over the picture.
fn add_depths([a, b, c]: [DVec3; 3], out: &mut Coverage) {
    let (ab, ac) = ((b - a).truncate(), (c - a).truncate());
    let area = ab.perp_dot(ac);
    let (at_a, to_b, to_c) = (1.0 / a.z, 1.0 / b.z - 1.0 / a.z, 1.0 / c.z - 1.0 / a.z);
    // For a sliver, rounding would exceed its corners' depths.
    let nearest = at_a + to_b.max(to_c).max(0.0);
    let farthest = at_a + to_b.min(to_c).min(0.0);
    let slope = DVec2::new(to_b * ac.y - to_c * ab.y, to_c * ab.x - to_b * ac.x) / area;
    for (row, columns) in centres([a, b, c], out.size_px) {
        for column in columns {
            let at = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
            let inverse = (at_a + slope.dot(at - a.truncate())).max(farthest).min(nearest);
            #[allow(clippy::cast_possible_truncation, reason = "a depth, to 7 digits")]
            let depth_m = (1.0 / inverse) as f32;
            let kept = &mut out.depths_m[row * out.size_px.x as usize + column];
            *kept = kept.min(depth_m);
        }
    }
}

/// The rows of a picture with the columns of pixels whose centres a projected triangle covers.
pub(super) fn centres(corners: [DVec3; 3], size_px: IVec2) -> impl Iterator<Item = (usize, Range<usize>)> {
    let [a, b, c] = corners.map(|corner| corner.y);
    let [width, height] = size_px.as_dvec2().to_array();
    let from_to =
        |first: f64, end: f64, most: f64| round_up((first - 0.5).min(most))..round_up((end - 0.5).min(most));
    let rows = from_to(a.min(b).min(c), a.max(b).max(c), height);
    rows.filter_map(move |row| {
        let [left, right] = crossing(corners, row as f64 + 0.5)?;
        Some((row, from_to(left, right, width)))
    })
}

/// The range of a triangle on the line at `y`.
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
