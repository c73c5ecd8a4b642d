//! The outer side of a mesh: repairs zero normals, normals that point inwards, and pieces that are
//! inside out.
//!
//! Triangles are counter-clockwise from outside, as glTF defines it, and a closed piece encloses a
//! volume. A closed piece of negative volume is inside out, whatever its normals: its triangles are
//! reversed. The triangles of an open piece are assumed right. Normals that then point away from
//! most of the area are reversed.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::geometry::{Geometry, place_bits};
use super::pieces::Pieces;
use super::warning::ToyWarning;

/// Repairs the primitives of one mesh, at rest; `fields` are their paths.
pub(super) fn turn_outward(geometries: &mut [Geometry], fields: &[String], warnings: &mut Vec<ToyWarning>) {
    for (geometry, field) in geometries.iter_mut().zip(fields) {
        let n_vertices = fill_normals(geometry);
        if n_vertices > 0 {
            let field = format!("{field}.attributes.NORMAL");
            warnings.push(ToyWarning::NormalsFromFaces { field, n_vertices });
        }
    }
    let mut shape = Shape::of(geometries);
    for (index, (geometry, field)) in geometries.iter_mut().zip(fields).enumerate() {
        let turns = shape.turns(index, geometry);
        let n_triangles = turns.turn_faces(geometry);
        if n_triangles > 0 {
            let field = field.clone();
            warnings.push(ToyWarning::FacesInverted { field, n_triangles });
        }
        let n_vertices = turns.turn_normals(geometry);
        if n_vertices > 0 {
            let field = format!("{field}.attributes.NORMAL");
            warnings.push(ToyWarning::NormalsInverted { field, n_vertices });
        }
    }
}

/// The vector along a triangle's normal whose length is twice the area.
fn face(geometry: &Geometry, corners: [u32; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|corner| geometry.positions[corner as usize].as_dvec3());
    (b - a).cross(c - a)
}

/// Replaces zero normals by the mean of the adjacent faces, weighted by area; returns their number.
fn fill_normals(geometry: &mut Geometry) -> usize {
    let is_zero = |normal: &Vec3| normal.as_dvec3().length_squared() == 0.0;
    let Some(normals) = geometry.normals.as_ref().filter(|all| all.iter().any(is_zero)) else {
        return 0;
    };
    let mut sums = vec![DVec3::ZERO; normals.len()];
    for &corners in geometry.triangles() {
        let face = face(geometry, corners);
        corners.iter().for_each(|&corner| sums[corner as usize] += face);
    }
    let mut n_filled = 0;
    for (normal, sum) in geometry.normals.iter_mut().flatten().zip(sums) {
        if is_zero(normal) {
            *normal = sum.normalize_or_zero().as_vec3();
            n_filled += 1;
        }
    }
    n_filled
}

/// A mesh welded by position, in pieces.
struct Shape {
    pieces: Pieces,
    /// For each primitive and each of its vertices, the welded vertex.
    welded: Vec<Vec<u32>>,
}

/// Triangles with a common decision: a closed piece by its root, or all open triangles of a
/// primitive.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Group {
    Closed { root: usize, is_inside_out: bool },
    Open,
}

/// Area whose normals point to the outer side of the triangles as written, and to the inner side.
#[derive(Clone, Copy, Default)]
struct Sides {
    outer: f64,
    inner: f64,
}

/// The triangles and normals of one primitive to reverse.
struct Turns {
    triangles: Vec<bool>,
    normals: Vec<bool>,
}

impl Shape {
    fn of(geometries: &[Geometry]) -> Self {
        let mut places = Vec::new();
        let mut known = HashMap::new();
        let mut weld = |position: &Vec3| {
            *known.entry(place_bits(*position)).or_insert_with(|| {
                places.push(*position);
                // Vertices are limited when they are read.
                u32::try_from(places.len() - 1).unwrap_or(u32::MAX)
            })
        };
        let welded: Vec<Vec<u32>> = geometries
            .iter()
            .map(|geometry| geometry.positions.iter().map(&mut weld).collect())
            .collect();
        let all = geometries.iter().zip(&welded);
        let triangles: Vec<[u32; 3]> = all
            .flat_map(|(geometry, welded)| {
                let corners = geometry.triangles().iter();
                corners.map(|corners| corners.map(|corner| welded[corner as usize]))
            })
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        Self {
            pieces: Pieces::of(&triangles, &places),
            welded,
        }
    }

    fn turns(&mut self, index: usize, geometry: &Geometry) -> Turns {
        let group = |corners: &[u32; 3]| self.group(self.welded[index][corners[0] as usize]);
        let groups: Vec<Group> = geometry.triangles().iter().map(group).collect();
        let normals = geometry.normals.as_deref().unwrap_or_default();
        let mut sides: HashMap<Group, Sides> = HashMap::new();
        for (&corners, group) in geometry.triangles().iter().zip(&groups) {
            let face = face(geometry, corners);
            let sides = sides.entry(*group).or_default();
            for normal in corners.iter().filter_map(|&corner| normals.get(corner as usize)) {
                sides.add(face.length(), face.dot(normal.as_dvec3()));
            }
        }
        let is_inside_out = |group| {
            matches!(
                group,
                Group::Closed {
                    is_inside_out: true,
                    ..
                }
            )
        };
        let mut turns = Turns {
            triangles: groups.iter().copied().map(is_inside_out).collect(),
            normals: vec![false; normals.len()],
        };
        for (corners, group) in geometry.triangles().iter().zip(groups) {
            let inwards = sides.get(&group).is_some_and(|sides| sides.inner > sides.outer);
            for &corner in corners {
                if let Some(turn) = turns.normals.get_mut(corner as usize) {
                    *turn = inwards != is_inside_out(group);
                }
            }
        }
        turns
    }

    fn group(&mut self, welded: u32) -> Group {
        let is_inside_out = self.pieces.is_inside_out(welded);
        if is_inside_out || self.pieces.is_closed(welded) {
            let root = self.pieces.root(welded);
            Group::Closed { root, is_inside_out }
        } else {
            Group::Open
        }
    }
}

impl Sides {
    /// Adds a corner of a triangle; `along` is positive if its normal points to the triangle's
    /// outer side.
    fn add(&mut self, area: f64, along: f64) {
        if along > 0.0 {
            self.outer += area;
        } else if along < 0.0 {
            self.inner += area;
        }
    }
}

impl Turns {
    /// Returns the number of reversed triangles.
    fn turn_faces(&self, geometry: &mut Geometry) -> usize {
        let turned = || (0..).zip(&self.triangles).filter(|(_, turn)| **turn);
        turned().for_each(|(triangle, _)| geometry.turn_triangle(triangle));
        turned().count()
    }

    /// Returns the number of reversed normals.
    fn turn_normals(&self, geometry: &mut Geometry) -> usize {
        let turned = || (0..).zip(&self.normals).filter(|(_, turn)| **turn);
        turned().for_each(|(vertex, _)| geometry.turn_normal(vertex));
        turned().count()
    }
}
