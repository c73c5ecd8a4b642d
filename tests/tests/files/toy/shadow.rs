//! The shape from which shadows are drawn: its welded vertices, and the definition of a closed
//! shape.

use std::collections::{HashMap, HashSet};

use app_core::toy::{Pose, PosedMesh, Toy, ToyWarning};
use glam::DMat4;
use serde_json::json;

use super::FILE;
use super::builder::{CORNERS, Glb, triangle};

/// Corners of a tetrahedron; its faces are counter-clockwise seen from outside.
const TETRAHEDRON: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

/// Faces of the tetrahedron with corners of their own, and a triangle beside it.
fn faceted(faces: &[[usize; 3]]) -> Toy {
    let mut corners: Vec<f32> = faces
        .as_flattened()
        .iter()
        .flat_map(|&k| TETRAHEDRON[k])
        .collect();
    corners.extend(CORNERS.map(|coordinate| coordinate + 2.0));
    let mut glb = Glb::new();
    let position = glb.floats("VEC3", &corners);
    let mesh = glb.mesh(json!({ "attributes": { "POSITION": position } }));
    glb.push("nodes", json!({ "mesh": mesh }));
    Toy::from_glb(FILE, &glb.bytes()).unwrap()
}

/// Number of edges that are passed more often in one direction than in the other.
pub(crate) fn unmatched(corners: &[u32]) -> usize {
    let mut passes: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in corners.as_chunks().0 {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *passes.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
        }
    }
    passes.values().filter(|n| **n != 0).count()
}

/// Number of different corners.
fn n_corners(corners: &[u32]) -> usize {
    corners.iter().collect::<HashSet<_>>().len()
}

#[test]
fn closed_pieces_come_before_open_ones_and_each_triangle_once() {
    let toy = faceted(&FACES);
    let shadow = toy.shadow_indices();
    assert_eq!((shadow.indices.len(), shadow.n_closed), (15, 12));
    assert!(!shadow.is_closed());
    assert_eq!(n_corners(&shadow.indices), 4 + 3);
    // Only the edges of the triangle beside it.
    assert_eq!(unmatched(&shadow.indices[..12]), 0);
    assert_eq!(unmatched(&shadow.indices), 3);
}

#[test]
fn a_piece_whose_faces_look_inwards_is_turned_around() {
    let inwards = FACES.map(|[a, b, c]| [a, c, b]);
    let toy = faceted(&inwards);
    let shadow = toy.shadow_indices();
    assert_eq!((shadow.indices.len(), shadow.n_closed), (15, 12));
    let [ToyWarning::FacesInverted { n_triangles: 4, .. }] = toy.warnings() else {
        panic!("{:?}", toy.warnings());
    };
    // Its normals, from the faces, are those of the piece that was right from the start.
    let posed = |toy: &Toy| {
        let mut posed = PosedMesh::default();
        toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).unwrap();
        posed.normals
    };
    assert_eq!(posed(&toy), posed(&faceted(&FACES)));
}

#[test]
fn what_lacks_a_face_or_has_one_turned_around_is_open() {
    let [a, b, c] = FACES[3];
    for faces in [&FACES[..3], &[FACES[0], FACES[1], FACES[2], [a, c, b]]] {
        let toy = faceted(faces);
        let shadow = toy.shadow_indices();
        assert_eq!((shadow.indices.len(), shadow.n_closed), (3 * faces.len() + 3, 0));
    }
}

/// Two nodes show one mesh at one position, but a clip may separate them; so may morph targets.
#[test]
fn what_a_pose_can_part_is_not_welded() {
    let mut glb = triangle();
    glb.push("nodes", json!({ "mesh": 0 }));
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    assert_eq!(n_corners(&toy.shadow_indices().indices), 6);

    let mut glb = triangle();
    let primitive = glb.json["meshes"][0]["primitives"][0].clone();
    let offsets = glb.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let mut still = primitive.clone();
    let zeros = glb.floats("VEC3", &[0.0; 9]);
    still["targets"] = json!([{ "POSITION": zeros }]);
    let mut moving = primitive;
    moving["targets"] = json!([{ "POSITION": offsets }]);
    glb.json["meshes"][0]["primitives"] = json!([still, moving]);
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    assert_eq!(n_corners(&toy.shadow_indices().indices), 4);
}
