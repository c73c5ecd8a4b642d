//! Files with their expected vertices, computed by hand.

use std::f32::consts::FRAC_1_SQRT_2;

use serde_json::json;

use super::builder::{CORNERS, Glb, skinned, triangle};

/// A posed file and the expected result: a position and a normal for each vertex.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) glb: Glb,
    pub(crate) moment: Option<(&'static str, f64)>,
    pub(crate) expected: Vec<([f32; 3], [f32; 3])>,
    pub(crate) indices: Vec<u32>,
}

const Z: [f32; 3] = [0.0, 0.0, 1.0];

/// One triangle with the given corners; the normal is the same at each.
fn one(name: &'static str, glb: Glb, moment: Option<(&'static str, f64)>, corners: [[f32; 3]; 3]) -> Case {
    let expected = corners.map(|corner| (corner, Z)).to_vec();
    Case {
        name,
        glb,
        moment,
        expected,
        indices: vec![0, 1, 2],
    }
}

fn moved(by: [f32; 3]) -> [[f32; 3]; 3] {
    let [x, y, z] = by;
    [[x, y, z], [x + 1.0, y, z], [x, y + 1.0, z]]
}

fn animated(path: &str, interpolation: &str, shape: &str, times: &[f32], values: &[f32]) -> Glb {
    let mut glb = triangle();
    let keys = [glb.floats("SCALAR", times), glb.floats(shape, values)];
    glb.animate("move", path, interpolation, keys);
    glb
}

/// The file's node, called `arm`, turns by 90 degrees around z in the second that `move` takes.
pub(crate) fn turning() -> Glb {
    let quarter = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
    let values = [[0.0, 0.0, 0.0, 1.0], quarter].concat();
    let mut glb = animated("rotation", "LINEAR", "VEC4", &[0.0, 1.0], &values);
    glb.json["nodes"][0]["name"] = json!("arm");
    glb
}

pub(crate) fn cases() -> Vec<Case> {
    [tracks(), transforms(), skins_and_morphs(), topologies()]
        .into_iter()
        .flatten()
        .collect()
}

#[rustfmt::skip] // One case a line.
fn tracks() -> Vec<Case> {
    let line = |interpolation| {
        animated(
            "translation",
            interpolation,
            "VEC3",
            &[1.0, 3.0],
            &[0.0, 0.0, 0.0, 2.0, 4.0, 6.0],
        )
    };
    // In-tangent, value, out-tangent of x at 0 s and 2 s: at 1 s x is 1/2 + 2/8 3 + 5/2 + 2/8 = 4.
    let mut spline = [0.0; 18];
    [spline[3], spline[6], spline[9], spline[12]] = [1.0, 3.0, -1.0, 5.0];
    let spline = animated("translation", "CUBICSPLINE", "VEC3", &[0.0, 2.0], &spline);
    // The second key is minus the rotation by 90 degrees: the shorter way is the other sign.
    let turn = animated(
        "rotation",
        "LINEAR",
        "VEC4",
        &[0.0, 3.0],
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    );
    let (sin, cos) = 30.0_f32.to_radians().sin_cos();
    let turned = [[0.0; 3], [cos, sin, 0.0], [-sin, cos, 0.0]];
    let single = animated("translation", "LINEAR", "VEC3", &[0.5], &[7.0, 0.0, 0.0]);
    vec![
        one("linear", line("LINEAR"), Some(("move", 2.0)), moved([1.0, 2.0, 3.0])),
        one("before the first key", line("LINEAR"), Some(("#0", 0.5)), moved([0.0; 3])),
        one("after the last key", line("LINEAR"), Some(("move", 9.0)), moved([2.0, 4.0, 6.0])),
        one("step", line("STEP"), Some(("move", 2.999)), moved([0.0; 3])),
        one("cubic spline", spline, Some(("move", 1.0)), moved([4.0, 0.0, 0.0])),
        one("slerp, a third of 90 degrees", turn, Some(("move", 1.0)), turned),
        one("single key", single, Some(("move", 0.0)), moved([7.0, 0.0, 0.0])),
    ]
}

#[rustfmt::skip] // One case a line.
fn transforms() -> Vec<Case> {
    let node = |fields: serde_json::Value| {
        let mut glb = triangle();
        let nodes = glb.json["nodes"][0].as_object_mut().unwrap();
        nodes.extend(fields.as_object().unwrap().clone());
        glb
    };
    let mut mirrored = one(
        "mirrored",
        node(json!({ "scale": [-1.0, 1.0, 1.0] })),
        None,
        [[0.0; 3], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    );
    mirrored.indices = vec![0, 2, 1];
    let mut chain = node(json!({ "translation": [1.0, 0.0, 0.0], "rotation": [0.0, 0.0, 1.0, 1.0] }));
    chain.push("nodes", json!({ "scale": [2.0, 2.0, 2.0], "children": [0] }));
    chain.push("nodes", json!({ "mesh": 0, "name": "outside the scene" }));
    chain.json["scenes"][0]["nodes"] = json!([1]);
    let matrix = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]);
    let flattened = node(json!({ "scale": [1.0, 1.0, 0.0] }));
    // The inverse transpose of diag(4, 1, 1) turns (1, 0, 1) into (1, 0, 4).
    let mut stretched = node(json!({ "scale": [4.0, 1.0, 1.0] }));
    let slanted = stretched.floats("VEC3", &[FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2].repeat(3));
    stretched.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = slanted.into();
    let corners = [[0.0; 3], [4.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut stretched = one("normal under uneven scale", stretched, None, corners);
    let length = 17.0_f32.sqrt();
    stretched
        .expected
        .iter_mut()
        .for_each(|(_, normal)| *normal = [1.0 / length, 0.0, 4.0 / length]);
    vec![
        mirrored,
        one("chain", chain, None, [[2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 0.0]]),
        one("matrix", node(json!({ "matrix": matrix })), None, moved([5.0, 6.0, 7.0])),
        one("flattened", flattened, None, moved([0.0; 3])),
        stretched,
    ]
}

#[rustfmt::skip] // One case a line.
fn skins_and_morphs() -> Vec<Case> {
    let joints = |glb: &mut Glb| glb.u16s("VEC4", &[0, 1, 0, 0].repeat(3));
    let quarters = |glb: &mut Glb| glb.floats("VEC4", &[0.25, 0.75, 0.0, 0.0].repeat(3));
    let blend = moved([0.0, -0.75, 3.0]);
    let doubled = |glb: &mut Glb| glb.floats("VEC4", &[0.5, 1.5, 0.0, 0.0].repeat(3));
    let nothing = |glb: &mut Glb| glb.floats("VEC4", &[0.0; 12]);
    // Joints without weight may have any index.
    let byte_joints = |glb: &mut Glb| glb.u8s("VEC4", false, &[0, 1, 200, 0].repeat(3));
    let bytes = |glb: &mut Glb| glb.u8s("VEC4", true, &[51, 204, 0, 0].repeat(3));
    let mut two_sets = skinned(joints, |glb| glb.floats("VEC4", &[0.25, 0.0, 0.0, 0.0].repeat(3)));
    let (more_joints, more_weights) = (
        two_sets.u16s("VEC4", &[0, 0, 0, 1].repeat(3)),
        two_sets.floats("VEC4", &[0.0, 0.0, 0.0, 0.75].repeat(3)),
    );
    let attributes = &mut two_sets.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_1"] = more_joints.into();
    attributes["WEIGHTS_1"] = more_weights.into();
    // The lowest 16-bit integer also represents -1.
    let mut by_fractions = morphed();
    let weights = by_fractions.view(&[i16::MIN, i16::MAX, 0, 0].map(i16::to_le_bytes).concat());
    by_fractions.json["accessors"][3] = json!({ "bufferView": weights, "componentType": 5122, "normalized": true, "type": "SCALAR", "count": 4 });
    vec![
        one("skin", skinned(joints, quarters), None, blend),
        one("weights that sum to two", skinned(joints, doubled), None, blend),
        one("no weight at all", skinned(joints, nothing), None, moved([0.0; 3])),
        one("byte weights", skinned(byte_joints, bytes), None, moved([0.0, -0.8, 3.2])),
        one("two sets of joints", two_sets, None, blend),
        one("morph as authored", morphed(), None, moved([2.0, 0.0, 0.0])),
        one("morph animated", morphed(), Some(("move", 0.25)), moved([0.25, 0.75, 0.0])),
        one("morph by fractions", by_fractions, Some(("move", 0.0)), moved([-1.0, 1.0, 0.0])),
    ]
}

/// Two targets, one along x and one along y, with weights 2 and 0, animated from (0, 1) to (1, 0) in one second.
fn morphed() -> Glb {
    let times_and_weights = [0.0, 1.0, 1.0, 0.0];
    let mut glb = animated("weights", "LINEAR", "SCALAR", &[0.0, 1.0], &times_and_weights);
    let x = glb.floats("VEC3", &[1.0, 0.0, 0.0].repeat(3));
    let y = glb.floats("VEC3", &[0.0, 1.0, 0.0].repeat(3));
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": x }, { "POSITION": y }]);
    glb.json["meshes"][0]["weights"] = json!([9.0, 9.0]);
    glb.json["nodes"][0]["weights"] = json!([2.0, 0.0]);
    glb
}

fn topologies() -> Vec<Case> {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let of_square = |name, mode: u32, corners: &[u16], indices: &[u32]| {
        let mut glb = Glb::new();
        let position = glb.floats("VEC3", square.as_flattened());
        let normal = glb.floats("VEC3", &Z.repeat(4));
        let corners = glb.u16s("SCALAR", corners);
        let attributes = json!({ "POSITION": position, "NORMAL": normal });
        glb.mesh(json!({ "attributes": attributes, "indices": corners, "mode": mode }));
        glb.push("nodes", json!({ "mesh": 0 }));
        let expected = square.map(|corner| (corner, Z)).to_vec();
        Case {
            name,
            glb,
            moment: None,
            expected,
            indices: indices.to_vec(),
        }
    };
    // A corner at the origin by default; the others are written over it.
    let mut sparse = triangle();
    let (indices, values) = (sparse.view(&[1, 2]), sparse.view(&bytes_of(&CORNERS[3..])));
    sparse.json["accessors"][0] = json!({ "componentType": 5126, "type": "VEC3", "count": 3, "sparse": {
        "count": 2, "indices": { "bufferView": indices, "componentType": 5121 },
        "values": { "bufferView": values } } });
    let mut interleaved = triangle();
    let rows: Vec<f32> = CORNERS
        .chunks(3)
        .flat_map(|corner| [&[99.0], corner].concat())
        .collect();
    let view = interleaved.view(&bytes_of(&rows));
    interleaved.json["bufferViews"][view]["byteStride"] = 16.into();
    interleaved.json["accessors"][0] =
        json!({ "bufferView": view, "byteOffset": 4, "componentType": 5126, "type": "VEC3", "count": 3 });
    vec![
        of_square("list", 4, &[0, 1, 2, 2, 1, 3], &[0, 1, 2, 2, 1, 3]),
        of_square("strip", 5, &[0, 1, 2, 3], &[0, 1, 2, 1, 3, 2]),
        of_square("fan", 6, &[0, 1, 3, 2], &[1, 3, 0, 3, 2, 0]),
        one("sparse", sparse, None, moved([0.0; 3])),
        one("interleaved", interleaved, None, moved([0.0; 3])),
        folded(),
    ]
}

/// Two triangles without normals with a common edge at a right angle, turned by i16 fractions about
/// z.
fn folded() -> Case {
    let mut glb = Glb::new();
    let position = glb.floats("VEC3", &[&CORNERS[..], &[0.0, 0.0, -1.0]].concat());
    let corners = glb.u16s("SCALAR", &[0, 1, 2, 0, 3, 1]);
    glb.mesh(json!({ "attributes": { "POSITION": position }, "indices": corners }));
    glb.push("nodes", json!({ "mesh": 0 }));
    let times = glb.floats("SCALAR", &[0.0]);
    let turn = glb.view(&[0, 0, 23170_i16, 23170].map(i16::to_le_bytes).concat());
    let turn = glb.push(
        "accessors",
        json!({ "bufferView": turn, "componentType": 5122, "normalized": true, "type": "VEC4", "count": 1 }),
    );
    glb.animate("turn", "rotation", "LINEAR", [times, turn]);
    let ([o, x, y, z], back) = (
        [[0.0; 3], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]],
        [1.0, 0.0, 0.0],
    );
    Case {
        name: "flat normals",
        glb,
        moment: Some(("turn", 0.0)),
        expected: vec![(o, Z), (x, Z), (y, Z), (o, back), (z, back), (x, back)],
        indices: vec![0, 1, 2, 3, 4, 5],
    }
}

fn bytes_of(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
