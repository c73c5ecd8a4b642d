//! Small glTF files as starting points.

pub(crate) use measure::glb::Glb;
use serde_json::json;

/// Corners of [`triangle`]: the origin, one along x, one along y.
pub(crate) const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// A file whose node 0 shows one triangle that faces +z.
pub(crate) fn triangle() -> Glb {
    let mut glb = Glb::new();
    let position = glb.floats("VEC3", &CORNERS);
    let normal = glb.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let mesh = glb.mesh(json!({ "attributes": { "POSITION": position, "NORMAL": normal } }));
    glb.push("nodes", json!({ "mesh": mesh }));
    glb
}

/// The same, bound to two joints: node 1 at the origin, node 2 at (0, 0, 4), bound at (0, 1, 0).
pub(crate) fn skinned(joints: impl Fn(&mut Glb) -> usize, weights: impl Fn(&mut Glb) -> usize) -> Glb {
    let mut glb = triangle();
    let (joints, weights) = (joints(&mut glb), weights(&mut glb));
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = joints.into();
    attributes["WEIGHTS_0"] = weights.into();
    let identity = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let mut matrices = [identity, identity].concat();
    matrices[16 + 13] = -1.0;
    let matrices = glb.floats("MAT4", &matrices);
    // A skinned mesh ignores the position of its own node.
    glb.json["nodes"][0]["translation"] = json!([100.0, 0.0, 0.0]);
    glb.json["nodes"][0]["skin"] = 0.into();
    glb.push("nodes", json!({}));
    glb.push("nodes", json!({ "translation": [0.0, 0.0, 4.0] }));
    glb.push(
        "skins",
        json!({ "joints": [1, 2], "inverseBindMatrices": matrices }),
    );
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    glb
}
