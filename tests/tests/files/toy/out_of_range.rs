//! Numbers that are each in range, and poses of them that are not; and colours that glTF clamps.

use std::sync::Arc;

use app_core::toy::{NodePose, Pose, PosedMesh, Toy, ToyError, ToyWarning, Trs};
use glam::{DMat4, DQuat, DVec3};
use serde_json::json;

use super::FILE;
use super::builder::{Glb, triangle};

/// A pose is refused with its file, its vertex and the limit.
fn assert_refused(toy: &Toy, pose: &Pose) {
    let error = toy
        .pose(pose, &DMat4::IDENTITY, &mut PosedMesh::default())
        .unwrap_err();
    assert!(matches!(error, ToyError::PoseOverflow { .. }), "{error}");
    let text = error.to_string();
    assert!(
        text.contains(FILE) && text.contains("vertex") && text.contains("1000000"),
        "{text}"
    );
}

/// The triangle at the end of a chain of nodes each of which enlarges it.
fn chain(n_nodes: usize, scale: f64) -> Glb {
    let mut glb = triangle();
    glb.json["nodes"][0]["scale"] = json!([scale, scale, scale]);
    for node in 1..n_nodes {
        glb.push(
            "nodes",
            json!({ "children": [node - 1], "scale": [scale, scale, scale] }),
        );
    }
    glb.json["scenes"][0]["nodes"] = json!([n_nodes - 1]);
    glb
}

#[test]
fn nodes_that_together_leave_the_range_are_refused_when_posed() {
    // 1e7, beyond 32 bits, and beyond 64 bits, where infinity times 0 is not a number.
    for (n_nodes, scale) in [(7, 10.0), (5, 1e10), (400, 1e10)] {
        let toy = Toy::from_glb(FILE, &chain(n_nodes, scale).bytes()).unwrap();
        assert_refused(&toy, &Pose::Authored);
    }
    let toy = Toy::from_glb(FILE, &chain(5, 10.0).bytes()).unwrap();
    toy.pose(&Pose::Authored, &DMat4::IDENTITY, &mut PosedMesh::default())
        .unwrap();
}

#[test]
fn a_clip_that_leaves_the_range_between_keys_is_refused_when_posed() {
    let mut glb = triangle();
    // At both keys the triangle is at the origin; between them the tangents carry it far away.
    let mut values = [0.0; 18];
    [values[6], values[9]] = [1e11, -1e11];
    let keys = [glb.floats("SCALAR", &[0.0, 1.0]), glb.floats("VEC3", &values)];
    glb.animate("move", "translation", "CUBICSPLINE", keys);
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    let clip = toy.find_clip("move").unwrap();
    let at = |time_secs| Pose::Clip { clip, time_secs };
    assert_refused(&toy, &at(0.5));
    toy.pose(&at(1.0), &DMat4::IDENTITY, &mut PosedMesh::default())
        .unwrap();
}

#[test]
fn nodes_and_weights_from_outside_that_leave_the_range_are_refused() {
    let mut glb = triangle();
    let target = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
    glb.json["nodes"][0]["name"] = json!("arm");
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    let arm = toy.find_node("arm").unwrap();
    let authored = toy.authored_transform(arm).unwrap().unwrap();
    let nodes = |trs| {
        let parent_from_node = vec![(arm, trs)];
        Pose::Nodes(Arc::new(NodePose {
            parent_from_node,
            ..NodePose::default()
        }))
    };
    let weights = |weight| {
        let morph_weights = vec![(arm, vec![weight])];
        Pose::Nodes(Arc::new(NodePose {
            morph_weights,
            ..NodePose::default()
        }))
    };
    assert_refused(
        &toy,
        &nodes(Trs {
            translation: DVec3::splat(2e6),
            ..authored
        }),
    );
    assert_refused(
        &toy,
        &nodes(Trs {
            scale: DVec3::splat(1e7),
            ..authored
        }),
    );
    assert_refused(&toy, &weights(1e7));
    let refused = |pose: Pose| {
        let posed = toy.pose(&pose, &DMat4::IDENTITY, &mut PosedMesh::default());
        posed.unwrap_err().to_string()
    };
    for pose in [
        nodes(Trs {
            translation: DVec3::splat(1e300),
            ..authored
        }),
        nodes(Trs {
            scale: DVec3::splat(1e300),
            ..authored
        }),
        weights(-1e300),
    ] {
        let text = refused(pose);
        assert!(
            text.contains("node 0") && text.contains("1000000000000"),
            "{text}"
        );
    }
    for length in [1e300, 1e-300] {
        let rotation = DQuat::from_xyzw(0.0, 0.0, 0.0, length);
        assert!(refused(nodes(Trs { rotation, ..authored })).contains("its rotation is no quaternion"));
    }
}

/// glTF 2.0, 3.7.2.1: colours of vertices are clamped to 0 to 1.
#[test]
fn vertex_colours_are_clamped_and_said() {
    let mut glb = triangle();
    let colors = glb.floats("VEC3", &[-0.5, 0.25, 1.5, 0.0, 1.0, 0.5, 1.0, 1.0, 1.25]);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = colors.into();
    let toy = Toy::from_glb(FILE, &glb.bytes()).unwrap();
    let expected = [[0.0, 0.25, 1.0, 1.0], [0.0, 1.0, 0.5, 1.0], [1.0; 4]];
    assert_eq!(toy.colors_linear().unwrap(), expected);
    let field = "meshes[0].primitives[0].attributes.COLOR_0".to_owned();
    assert_eq!(
        toy.warnings(),
        [ToyWarning::ColorsClamped { field, n_vertices: 2 }]
    );
}
