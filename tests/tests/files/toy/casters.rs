//! Shapes with fewer triangles that cast shadows instead of the toy's: closed like it, and within
//! their stated distance in every pose.

use std::f64::consts::TAU;

use app_core::toy::{Pose, PosedMesh, Toy};
use desk::files::BUNDLED_SESSION;
use glam::{DMat4, DVec3};
use serde_json::json;

use super::FILE;
use super::builder::Glb;
use super::shadow::unmatched;

/// Radius of the tube's centre line around the axis, and of the tube, in metres.
const RADII: [f64; 2] = [0.03, 0.012];
/// Half the number of triangles around the axis and around the tube.
const N: [u32; 2] = [96, 48];
/// Number of points from which distances are measured.
const N_PLACES: usize = 600;

/// A torus.
fn torus() -> Toy {
    torus_and(0)
}

/// A torus over this number of adjacent squares, which together have the torus' radius.
fn torus_and(n_squares: u32) -> Toy {
    let place = |[around, along]: [u32; 2]| {
        let [turn, tilt] =
            [(around, N[0]), (along, N[1])].map(|(step, n)| TAU * f64::from(step) / f64::from(n));
        let out = RADII[0] + RADII[1] * tilt.cos();
        DVec3::new(out * turn.cos(), RADII[1] * tilt.sin(), out * turn.sin())
    };
    let steps = || (0..N[0]).flat_map(|around| (0..N[1]).map(move |along| [around, along]));
    let positions = steps().flat_map(|step| place(step).as_vec3().to_array());
    let at = |[around, along]: [u32; 2]| (around % N[0]) * N[1] + along % N[1];
    let corners = steps().flat_map(|[i, j]| {
        let [a, b, c, d] = [[i, j], [i, j + 1], [i + 1, j], [i + 1, j + 1]].map(at);
        [a, b, c, b, d, c]
    });
    let mut positions: Vec<f32> = positions.collect();
    let mut corners: Vec<u32> = corners.collect();
    let first = N[0] * N[1];
    for step in 0..n_squares + u32::from(n_squares > 0) {
        let x = RADII[0] * f64::from(step) / f64::from(n_squares);
        positions.extend(
            [0.0, RADII[0]]
                .map(|z| DVec3::new(x, -0.05, z).as_vec3().to_array())
                .as_flattened(),
        );
    }
    corners.extend(
        (0..n_squares).flat_map(|square| [0, 1, 2, 2, 1, 3].map(|corner| first + 2 * square + corner)),
    );
    let mut glb = Glb::new();
    let position = glb.floats("VEC3", &positions);
    let indices = glb.u32s(&corners);
    let mesh = glb.mesh(json!({ "attributes": { "POSITION": position }, "indices": indices }));
    glb.push("nodes", json!({ "mesh": mesh }));
    Toy::from_glb(FILE, &glb.bytes()).unwrap()
}

fn places(toy: &Toy, pose: &Pose) -> Vec<DVec3> {
    let mut posed = PosedMesh::default();
    toy.pose(pose, &DMat4::IDENTITY, &mut posed).unwrap();
    posed.positions.iter().map(|place| place.as_dvec3()).collect()
}

/// Distance of a point from a triangle. Source: Ericson, Real-Time Collision Detection, 5.1.5, by projections.
fn distance(point: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let edges = [[a, b], [b, c], [c, a]];
    let is_over = edges
        .iter()
        .all(|[from, to]| normal.cross(*to - *from).dot(point - *from) >= 0.0);
    if is_over && normal != DVec3::ZERO {
        return (point - a).dot(normal.normalize()).abs();
    }
    let to_edges = edges.map(|[from, to]| {
        let along = to - from;
        let part = (point - from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        point.distance(from + part.clamp(0.0, 1.0) * along)
    });
    to_edges.into_iter().fold(f64::INFINITY, f64::min)
}

/// The largest distance of points in some triangles from others.
fn farthest(of: &[u32], from: &[u32], places: &[DVec3]) -> f64 {
    let triangles = |corners: &[u32]| -> Vec<[DVec3; 3]> {
        let chunks = corners.as_chunks::<3>().0.iter();
        chunks
            .map(|corners| corners.map(|corner| places[corner as usize]))
            .collect()
    };
    let from = triangles(from);
    let of = triangles(of);
    let points = of
        .iter()
        .flat_map(|[a, b, c]| [*a, (a + b) / 2.0, (a + b + c) / 3.0]);
    let some = points.step_by((3 * of.len()).div_ceil(N_PLACES));
    let distances = some.map(|point| {
        from.iter()
            .map(|one| distance(point, *one))
            .fold(f64::INFINITY, f64::min)
    });
    distances.fold(0.0, f64::max)
}

#[test]
fn a_closed_shape_stays_closed_and_as_near_as_it_says() {
    let toy = torus();
    let own = &toy.shadow_indices().indices;
    let places = places(&toy, &Pose::Authored);
    let (mut error, mut n_corners) = (0.0, own.len());
    for caster in toy.casters() {
        assert!(caster.error >= error && caster.indices.len() < n_corners);
        (error, n_corners) = (caster.error, caster.indices.len());
        assert_eq!(unmatched(&caster.indices), 0, "{n_corners} corners");
        assert_eq!(caster.n_closed, n_corners);
        assert!(caster.indices.iter().all(|corner| own.contains(corner)));
        let far = farthest(&caster.indices, own, &places).max(farthest(own, &caster.indices, &places));
        assert!(
            far <= error,
            "{far} m in place of {error} m with {n_corners} corners"
        );
    }
    let millimetre = toy.casters().iter().rfind(|caster| caster.error < 1e-3).unwrap();
    assert!(
        3 * millimetre.indices.len() < own.len(),
        "{}",
        millimetre.indices.len()
    );
}

#[test]
fn of_closed_and_open_pieces_it_is_told_which_is_which() {
    let toy = torus_and(40);
    let own = toy.shadow_indices();
    assert_eq!(own.indices.len() - own.n_closed, 6 * 40);
    assert!(toy.casters().len() > 3);
    for caster in toy.casters() {
        let (closed, open) = caster.indices.split_at(caster.n_closed);
        assert_eq!(unmatched(closed), 0);
        assert!(!open.is_empty() && unmatched(open) > 0);
    }
}

/// Also at moments for which no shape was made.
#[test]
fn shapes_are_as_near_in_every_pose() {
    let toy = Toy::from_glb(
        FILE,
        &std::fs::read(format!("{BUNDLED_SESSION}/toy.glb")).unwrap(),
    )
    .unwrap();
    let own = &toy.shadow_indices().indices;
    for clip in toy.clip_ids() {
        let duration_secs = toy.clips()[clip.index()].duration_secs;
        for part in [0.12, 0.35, 0.6, 0.9] {
            let pose = Pose::Clip {
                clip,
                time_secs: part * duration_secs,
            };
            let places = places(&toy, &pose);
            for caster in toy.casters() {
                let far = farthest(&caster.indices, own, &places);
                assert!(far <= caster.error, "{far} in place of {}", caster.error);
            }
        }
    }
}

#[test]
fn the_same_file_gives_the_same_shapes() {
    assert_eq!(torus().casters(), torus().casters());
}

/// If one vertex has all triangles around it, only its rim is simplified, in a time proportional to
/// the file's size.
#[test]
fn a_fan_keeps_its_middle() {
    let n = 60_000;
    let rim = (0..n).flat_map(|step| {
        let (z, x) = (TAU * f64::from(step) / f64::from(n)).sin_cos();
        DVec3::new(x, 0.0, z).as_vec3().to_array()
    });
    let positions: Vec<f32> = [0.0, 0.1, 0.0].into_iter().chain(rim).collect();
    let indices = (0..n).flat_map(|step| [0, 1 + (step + 1) % n, 1 + step]);
    let mut glb = Glb::new();
    let position = glb.floats("VEC3", &positions);
    let indices = glb.u32s(&indices.collect::<Vec<_>>());
    let mesh = glb.mesh(json!({ "attributes": { "POSITION": position }, "indices": indices }));
    glb.push("nodes", json!({ "mesh": mesh }));
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    assert!(toy.casters().len() > 3, "{}", toy.casters().len());
    for caster in toy.casters() {
        let mut triangles = caster.indices.as_chunks::<3>().0.iter();
        assert!(triangles.all(|corners| corners.contains(&0)));
    }
}
