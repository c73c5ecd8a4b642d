//! Measured displacements of the surface at an outline: pieces of it, each between two points of
//! the surface.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::motion::Measured;
use crate::raster::project;
use crate::shape::Shape;
use app_scene::scene::Intrinsics;

/// Side of the squares within which pieces are merged, in pixels; larger if an outline has more of
/// them than the limit.
const CELL_PX: f64 = 4.0;
const MOST_CELLS: f64 = 400.0;
/// Largest distance of a piece from the outline of the surface, in pixels.
const ON_EDGE_PX: f64 = 1.5;
/// Further noise of a piece, in pixels: no field is as rough as a surface may be.
const ROUGH_PX: f64 = 0.2;

/// Neighbouring pieces of an outline as one.
pub(super) struct ContourSegment {
    pub(super) at_px: DVec2,
    /// Normal, out of the toy.
    pub(super) normal: DVec2,
    /// Distance from the surface as given, positive outside.
    pub(super) offset_px: f64,
    pub(super) variance_px2: f64,
    /// Shift in pixels per metre of each point's displacement, along each axis.
    pub(super) row: Vec<(usize, DVec3)>,
}

/// A piece of the outline, and its dependence on the ends of its edge.
struct Piece<'a> {
    measured: &'a Measured,
    row: [(usize, DVec3); 2],
}

impl Piece<'_> {
    fn weight(&self) -> f64 {
        self.measured.precision.min(ROUGH_PX.powi(-2)) * self.measured.element.length_px
    }
}

/// Side of the squares for the given number of pieces, in pixels.
pub(super) fn cell_px(n_pieces: usize) -> f64 {
    CELL_PX.max(n_pieces as f64 / MOST_CELLS)
}

impl ContourSegment {
    /// Segments of an outline that was measured with a displaced shape.
    pub(super) fn all(
        measured: &[Measured],
        (shape, displacements_m): (&Shape, &[DVec3]),
        k: &Intrinsics,
    ) -> Vec<Self> {
        let (rims, cell_px) = (Rims::new(shape, k), cell_px(measured.len()));
        let mut cells: BTreeMap<[i64; 3], Vec<Piece<'_>>> = BTreeMap::new();
        for measured in measured {
            let element = &measured.element;
            let Some(ends) = rims.at(element.at_px) else {
                continue;
            };
            let (_, per_m) = element.rim(k);
            let row = ends.map(|(point, part)| (point, part * per_m));
            let [x, y] = (element.at_px / cell_px).floor().as_i64vec2().to_array();
            let piece = Piece { measured, row };
            cells.entry([y, x, side(element.normal)]).or_default().push(piece);
        }
        let cells = cells.into_values();
        cells
            .filter_map(|pieces| Self::of(&pieces, displacements_m))
            .collect()
    }

    /// `None` if nothing is known of the pieces.
    fn of(pieces: &[Piece<'_>], displacements_m: &[DVec3]) -> Option<Self> {
        let total: f64 = pieces.iter().map(Piece::weight).sum();
        let (mut at_px, mut normal, mut offset_px) = (DVec2::ZERO, DVec2::ZERO, 0.0);
        let mut row: BTreeMap<usize, DVec3> = BTreeMap::new();
        for piece in pieces {
            let part = piece.weight() / total;
            at_px += part * piece.measured.element.at_px;
            normal += part * piece.measured.element.normal;
            offset_px += part * piece.measured.offset_px;
            for (point, px_per_m) in &piece.row {
                *row.entry(*point).or_default() += part * *px_per_m;
                offset_px += part * px_per_m.dot(displacements_m[*point]);
            }
        }
        (total > 0.0).then(|| Self {
            at_px,
            normal: normal.normalize_or_zero(),
            offset_px,
            variance_px2: total.recip(),
            row: row.into_iter().collect(),
        })
    }
}

/// The quadrant of a normal.
fn side(normal: DVec2) -> i64 {
    if normal.x.abs() > normal.y.abs() {
        i64::from(normal.x > 0.0)
    } else {
        2 + i64::from(normal.y > 0.0)
    }
}

/// Edges between front faces and back faces of a shape: their ends, projected.
struct Rims(Vec<[(usize, DVec2); 2]>);

impl Rims {
    fn new(shape: &Shape, k: &Intrinsics) -> Self {
        let corners = project(shape.points.iter().copied(), k);
        let at = |corner: u32| corners[corner as usize].truncate();
        // Rows go down: triangles whose outer side is visible turn to the left.
        let faces_eye = |[a, b, c]: &[u32; 3]| (at(*b) - at(*a)).perp_dot(at(*c) - at(*a)) < 0.0;
        let mut facing: Vec<bool> = shape.faces.triangles.iter().map(faces_eye).collect();
        // Stands for the missing second triangle of an edge.
        facing.push(false);
        let rims = shape.faces.edges.iter().filter(|edge| {
            let [one, other] = edge.sides.map(|side| facing[side as usize]);
            one != other
        });
        Self(
            rims.map(|edge| edge.corners.map(|corner| (corner as usize, at(corner))))
                .collect(),
        )
    }

    /// The ends of the edge nearest to a place, with their weights; `None` if none is near.
    fn at(&self, at_px: DVec2) -> Option<[(usize, f64); 2]> {
        let mut nearest = ON_EDGE_PX * ON_EDGE_PX;
        let mut found = None;
        for [(a, from), (b, to)] in &self.0 {
            let along = *to - *from;
            let part = ((at_px - *from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let square = (*from + part * along - at_px).length_squared();
            if square < nearest {
                nearest = square;
                found = Some([(*a, 1.0 - part), (*b, part)]);
            }
        }
        found
    }
}
