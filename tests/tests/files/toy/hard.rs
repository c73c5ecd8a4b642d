//! Numerically difficult shapes: each results in finite corners and correct unit normals, or is
//! refused.

use std::f32::consts::{PI, TAU};

use app_core::toy::{Pose, PosedMesh, Toy, ToyWarning};
use glam::{DMat4, Vec3};
use serde_json::json;

use super::FILE;
use super::builder::{CORNERS, Glb, skinned, triangle};

/// The toy posed as authored; every number is finite and every normal has length 1.
fn posed(toy: &Toy) -> PosedMesh {
    let mut posed = PosedMesh::default();
    toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut posed).unwrap();
    assert!(posed.positions.iter().all(|position| position.is_finite()));
    assert!(posed.normals.iter().all(|normal| normal.is_normalized()));
    posed
}

/// A mesh at node 0, with normals if there are any.
fn mesh(positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> Toy {
    let mut glb = Glb::new();
    let flat = |vectors: &[Vec3]| vectors.iter().flat_map(Vec3::to_array).collect::<Vec<f32>>();
    let mut attributes = json!({ "POSITION": glb.floats("VEC3", &flat(positions)) });
    if !normals.is_empty() {
        attributes["NORMAL"] = glb.floats("VEC3", &flat(normals)).into();
    }
    let indices = glb.u32s(triangles.as_flattened());
    glb.mesh(json!({ "attributes": attributes, "indices": indices }));
    glb.push("nodes", json!({ "mesh": 0 }));
    Toy::from_glb(FILE, &glb.bytes()).unwrap()
}

/// Corners of a unit tetrahedron and its faces, counter-clockwise seen from outside.
const TETRAHEDRON: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

/// A sphere of radius 1 with `n` rows of faces and twice as many columns; its corners are also its
/// normals. The seam and the poles have separate corners for each column, as texture coordinates
/// need.
fn sphere(n: u32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let fraction =
        |k: u32, of: u32| f32::from(u16::try_from(k).unwrap()) / f32::from(u16::try_from(of).unwrap());
    let n_columns = 2 * n;
    // Poles are points, and the seam is closed to the bit.
    let corner = |row, column| {
        let (down, around) = (
            PI * fraction(row, n),
            TAU * fraction(column % n_columns, n_columns),
        );
        let out = if row % n == 0 { 0.0 } else { down.sin() };
        Vec3::new(out * around.cos(), down.cos(), -out * around.sin())
    };
    let corners = (0..=n).flat_map(|row| (0..=n_columns).map(move |column| corner(row, column)));
    let faces = (0..n).flat_map(|row| {
        (0..n_columns).flat_map(move |column| {
            let first = row * (n_columns + 1) + column;
            let below = first + n_columns + 1;
            [[first, below, first + 1], [first + 1, below, below + 1]]
        })
    });
    (corners.collect(), faces.collect())
}

#[test]
fn one_triangle_is_a_toy() {
    let toy = Toy::from_glb(FILE, &triangle().bytes()).unwrap();
    let positions: Vec<f32> = posed(&toy).positions.iter().flat_map(Vec3::to_array).collect();
    assert_eq!(positions, CORNERS);
    assert_eq!(toy.shadow_indices().indices.len(), 3);
    assert!(toy.warnings().is_empty());
}

/// The toy's normals are those of its faces, up to rounding.
fn assert_outward(toy: &Toy) {
    let posed = posed(toy);
    for corners in toy.indices().as_chunks::<3>().0 {
        let [a, b, c] = corners.map(|corner| posed.positions[corner as usize]);
        let out = (b - a).cross(c - a).normalize();
        for corner in corners {
            assert!(posed.normals[*corner as usize].distance(out) < 1e-6);
        }
    }
}

#[test]
fn triangles_without_area_do_no_harm() {
    // Three corners on a line, and two at one position.
    let corners = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, Vec3::Y];
    let toy = mesh(&corners, &[], &[[0, 1, 2], [0, 1, 3]]);
    let posed = posed(&toy);
    assert_eq!(posed.normals[3..], [Vec3::Z; 3]);
    let toy = mesh(&corners, &[Vec3::ZERO; 4], &[[0, 1, 2], [0, 1, 3]]);
    // Only the corner that belongs to the line alone has no face for a normal.
    assert_eq!(self::posed(&toy).normals, [Vec3::Z, Vec3::Z, Vec3::Y, Vec3::Z]);
}

#[test]
fn shapes_that_are_no_solid_have_the_normals_of_their_faces() {
    let doubled = [FACES, FACES].concat();
    let fin = [&FACES[..], &[[0, 1, 4]]].concat();
    let corners = [&TETRAHEDRON[..], &[Vec3::new(0.5, -1.0, -1.0)]].concat();
    for (name, triangles) in [
        ("closed", &FACES[..]),
        ("open", &FACES[..3]),
        ("doubled", &doubled),
        ("three faces at an edge", &fin),
    ] {
        let toy = mesh(&corners, &[], triangles);
        assert_eq!(toy.indices().len(), 3 * triangles.len(), "{name}");
        assert!(toy.warnings().is_empty(), "{name}: {:?}", toy.warnings());
        assert_outward(&toy);
    }
    let both_sides = mesh(&TETRAHEDRON, &[], &[FACES[0], [0, 1, 2]]);
    assert!(both_sides.warnings().is_empty(), "a sheet is not inside out");
    assert_outward(&both_sides);
}

#[test]
fn an_open_surface_is_as_its_triangles_say_and_a_closed_one_as_its_volume_says() {
    let normals = [-Vec3::Z; 3];
    let toy = mesh(&[Vec3::ZERO, Vec3::X, Vec3::Y], &normals, &[[0, 1, 2]]);
    assert_eq!(posed(&toy).normals, [Vec3::Z; 3]);
    assert!(matches!(
        toy.warnings(),
        [ToyWarning::NormalsInverted { n_vertices: 3, .. }]
    ));

    let (corners, faces) = sphere(8);
    let inwards: Vec<Vec3> = corners.iter().map(|corner| -corner).collect();
    let turned: Vec<[u32; 3]> = faces.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    for (normals, faces) in [(&inwards, &faces), (&corners, &turned), (&inwards, &turned)] {
        let toy = mesh(&corners, normals, faces);
        assert!(!toy.warnings().is_empty());
        let posed = posed(&toy);
        for (position, normal) in posed.positions.iter().zip(&posed.normals) {
            assert!(normal.distance(*position) < 1e-6, "{normal} at {position}");
        }
        for corners in toy.indices().as_chunks::<3>().0 {
            let [a, b, c] = corners.map(|corner| posed.positions[corner as usize]);
            assert!((b - a).cross(c - a).dot(a + b + c) >= 0.0);
        }
    }
}

/// In a sphere of 32 rows, normals from faces are as exact as its faces are small: 5.6 degrees
/// wide.
#[test]
fn normals_without_length_are_those_of_the_faces_around() {
    const MAX_ANGLE_RAD: f32 = 0.1;
    let (corners, faces) = sphere(32);
    let toy = mesh(&corners, &vec![Vec3::ZERO; corners.len()], &faces);
    let posed = posed(&toy);
    // In every column but one, each pole is the corner of a triangle with an area.
    let n_columns = 2 * 32;
    let has_area = |vertex: &usize| *vertex != 0 && *vertex != 32 * (n_columns + 1) + n_columns;
    let angles = (0..posed.positions.len())
        .filter(has_area)
        .map(|vertex| posed.positions[vertex].angle_between(posed.normals[vertex]));
    let largest = angles.fold(0.0, f32::max);
    println!("largest angle {largest}");
    assert!(largest < MAX_ANGLE_RAD, "{largest}");
    let n_vertices = posed.positions.len();
    let [ToyWarning::NormalsFromFaces { n_vertices: n, .. }] = toy.warnings() else {
        panic!("{:?}", toy.warnings());
    };
    assert_eq!(*n, n_vertices);
}

#[test]
fn bones_that_are_collapsed_take_their_vertices_to_a_point() {
    let joints = |glb: &mut Glb| glb.u16s("VEC4", &[1, 0, 0, 0].repeat(3));
    let weights = |glb: &mut Glb| glb.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    let mut glb = skinned(joints, weights);
    glb.json["nodes"][2]["scale"] = json!([0.0, 0.0, 0.0]);
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    assert_eq!(posed(&toy).positions, [Vec3::new(0.0, 0.0, 4.0); 3]);
    // Flattened along one axis.
    glb.json["nodes"][2]["scale"] = json!([1.0, 0.0, 1.0]);
    posed(&Toy::from_glb(FILE, &glb.bytes()).unwrap());
}

#[test]
fn a_thousand_joints_move_a_toy() {
    const N_JOINTS: u16 = 1000;
    let joints = |glb: &mut Glb| glb.u16s("VEC4", &[N_JOINTS - 1, 0, 0, 0].repeat(3));
    let weights = |glb: &mut Glb| glb.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    let mut glb = skinned(joints, weights);
    // A chain in which each joint is a millimetre above the previous one.
    let nodes = glb.json["nodes"].as_array_mut().unwrap();
    nodes.truncate(1);
    for joint in 1..=N_JOINTS {
        let children = if joint == N_JOINTS {
            json!(null)
        } else {
            json!([joint + 1])
        };
        nodes.push(json!({ "translation": [0.0, 0.0, 0.001], "children": children }));
    }
    glb.json["skins"] = json!([{ "joints": (1..=N_JOINTS).collect::<Vec<_>>() }]);
    glb.json["scenes"][0]["nodes"] = json!([0, 1]);
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    let expected = [Vec3::Z, Vec3::X + Vec3::Z, Vec3::Y + Vec3::Z];
    for (position, expected) in posed(&toy).positions.iter().zip(expected) {
        assert!(position.distance(expected) < 1e-6, "{position}");
    }
}

#[test]
fn two_hundred_thousand_triangles_are_a_toy() {
    let (corners, faces) = sphere(224);
    assert!(faces.len() > 200_000, "{}", faces.len());
    let toy = mesh(&corners, &corners, &faces);
    assert!(toy.warnings().is_empty(), "{:?}", toy.warnings());
    let posed = posed(&toy);
    assert!(
        posed
            .normals
            .iter()
            .zip(&posed.positions)
            .all(|(a, b)| a.distance(*b) < 1e-6)
    );
    // The poles are points: faces there have no area, and nothing is open.
    assert!(toy.shadow_indices().is_closed());
}
