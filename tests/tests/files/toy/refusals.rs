//! Broken files, and the expected refusals.

use std::io::Cursor;

use serde_json::{Value, json};

use super::builder::{CORNERS, Glb, skinned, triangle};

/// A file and words of its refusal: the field and the reason.
pub(crate) struct Refusal {
    pub(crate) name: &'static str,
    pub(crate) bytes: Vec<u8>,
    pub(crate) words: Vec<&'static str>,
}

fn broken(name: &'static str, words: &[&'static str], glb: Glb) -> Refusal {
    Refusal {
        name,
        bytes: glb.bytes(),
        words: words.to_vec(),
    }
}

/// A triangle, with one change to its tree.
fn changed(name: &'static str, words: &[&'static str], change: impl Fn(&mut Glb)) -> Refusal {
    let mut glb = triangle();
    change(&mut glb);
    broken(name, words, glb)
}

/// A triangle, with another value at a position of its tree, which is a field's.
fn set(name: &'static str, words: &[&'static str], place: &str, value: Value) -> Refusal {
    changed(name, words, |glb| {
        let (parent, key) = place.rsplit_once('/').unwrap();
        glb.json.pointer_mut(parent).unwrap()[key] = value.clone();
    })
}

/// A triangle by these indices.
fn indexed(name: &'static str, words: &[&'static str], corners: &[u16]) -> Refusal {
    changed(name, words, |glb| {
        let indices = glb.u16s("SCALAR", corners);
        glb.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
    })
}

/// A triangle with an attribute of these numbers.
fn attribute(name: &'static str, words: &[&'static str], key: &str, shape: &str, values: &[f32]) -> Refusal {
    changed(name, words, |glb| {
        let accessor = glb.floats(shape, values);
        glb.json["meshes"][0]["primitives"][0]["attributes"][key] = accessor.into();
    })
}

/// A triangle, and nodes with these children.
fn parents(name: &'static str, words: &[&'static str], children: [usize; 2]) -> Refusal {
    changed(name, words, |glb| {
        for child in children {
            glb.push("nodes", json!({ "children": [child] }));
        }
    })
}

pub(crate) fn refusals() -> Vec<Refusal> {
    let all = [
        containers(),
        references(),
        counts(),
        numbers(),
        ranges(),
        skins(),
        pictures(),
    ];
    all.into_iter().flatten().collect()
}

#[rustfmt::skip] // One case a line.
fn containers() -> Vec<Refusal> {
    let whole = triangle().bytes();
    let mut short_header = whole.clone();
    short_header[8..12].copy_from_slice(&3_u32.to_le_bytes());
    let raw = |name, words: &[&'static str], bytes: &[u8]| Refusal { name, bytes: bytes.to_vec(), words: words.to_vec() };
    vec![
        raw("empty", &["file", "not binary glTF"], &[]),
        raw("truncated", &["file", "not binary glTF"], &whole[..whole.len() / 2]),
        raw("header of 3 bytes", &["file", "3 bytes"], &short_header),
        set("no number", &["JSON chunk: accessors[0].count", "three"], "/accessors/0/count", json!("three")),
        set("compressed", &["extensionsRequired[0]", "KHR_draco_mesh_compression"], "/extensionsRequired", json!(["KHR_draco_mesh_compression"])),
        set("external buffer", &["buffers[0]", "outside the file"], "/buffers", json!([{ "byteLength": 72, "uri": "../../etc/passwd" }])),
    ]
}

#[rustfmt::skip] // One case a line.
fn references() -> Vec<Refusal> {
    let position = "meshes[0].primitives[0].attributes.POSITION";
    let giant = json!({ "componentType": 5126, "type": "VEC3", "count": 1_u64 << 62 });
    vec![
        set("no such accessor", &[position, "refers to accessor 99"], "/meshes/0/primitives/0/attributes/POSITION", json!(99)),
        set("no positions", &[position, "missing"], "/meshes/0/primitives/0/attributes", json!({ "NORMAL": 1 })),
        indexed("no such vertex", &["primitives[0].indices", "refers to vertex 3"], &[0, 1, 3]),
        indexed("no triangles", &["meshes", "no triangles"], &[0, 1, 1]),
        attribute("no area", &["meshes", "no triangles"], "POSITION", "VEC3", &[1.0; 9]),
        parents("cycle", &["nodes[1].children", "cycle"], [2, 1]),
        parents("two parents", &["nodes[2].children", "node 0 has two parents"], [0, 0]),
        set("beyond the view", &[position, "reaches to byte 48", "36"], "/accessors/0/count", json!(4)),
        set("beyond the buffer", &["bufferViews[0]", "reaches to byte 100000"], "/bufferViews/0/byteLength", json!(100_000)),
        set("offset near 2^64", &[position, "reaches to byte 18446744073709551615"], "/accessors/0/byteOffset", json!(u64::MAX - 3)),
        changed("giant count", &[position, "more than"], |glb| glb.json["accessors"][0] = giant.clone()),
        set("overlapping elements", &[position, "stride of 8"], "/bufferViews/0/byteStride", json!(8)),
    ]
}

fn counts() -> Vec<Refusal> {
    let materials = vec![json!({}); 4097].into();
    let place = "meshes[0].primitives[0]";
    let many = [place, "250001 triangles are more than the 250000 allowed"];
    let together = [place, "250002 triangles are more than the 250000 allowed"];
    vec![
        set(
            "many materials",
            &["materials", "4097 materials are more than the 4096 allowed"],
            "/materials",
            materials,
        ),
        indexed("many triangles", &many, &[0, 1, 2].repeat(250_001)),
        changed("many triangles together", &together, |glb| {
            let indices = glb.u16s("SCALAR", &[0, 1, 2].repeat(125_001));
            glb.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
            glb.push("nodes", json!({ "mesh": 0 }));
            glb.json["scenes"][0]["nodes"] = json!([0, 1]);
        }),
    ]
}

#[rustfmt::skip] // One case a line.
fn numbers() -> Vec<Refusal> {
    let mut corners = CORNERS;
    corners[4] = f32::NAN;
    let position = "meshes[0].primitives[0].attributes.POSITION (accessor 2)";
    vec![
        attribute("NaN position", &[position, "1 of 9 numbers", "element 1"], "POSITION", "VEC3", &corners),
        set("infinite scale", &["nodes[0].scale", "not finite"], "/nodes/0/scale", json!([1.0, 1e39, 1.0])),
        set("projection", &["nodes[0].matrix", "not affine"], "/nodes/0/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])),
        set("morph weights", &["nodes[0].weights", "has 2 weights, but 0"], "/nodes/0/weights", json!([0.0, 0.0])),
        changed("sparse out of order", &["sparse", "index 1"], |glb| {
            let (indices, values) = (glb.view(&[1, 1]), glb.view(&[0; 24]));
            glb.json["accessors"][0]["sparse"] = json!({ "count": 2,
                "indices": { "bufferView": indices, "componentType": 5121 },
                "values": { "bufferView": values } });
        }),
    ]
}

/// Finite numbers whose squares or products exceed the range of 32 bits, or that glTF does not
/// allow.
#[rustfmt::skip] // One case a line.
fn ranges() -> Vec<Refusal> {
    let factor = |name, factor: [f32; 4]| {
        let words = ["materials[0].pbrMetallicRoughness.baseColorFactor", "from -1000 to 1000"];
        set(name, &words, "/materials", json!([{ "pbrMetallicRoughness": { "baseColorFactor": factor } }]))
    };
    let far = |key, shape: &str, values: &[f32]| {
        let mut all = vec![0.0; if shape == "VEC2" { 6 } else { 9 }];
        all[..values.len()].copy_from_slice(values);
        attribute(key, &["primitives[0].attributes", key, "is not from"], key, shape, &all)
    };
    vec![
        far("POSITION", "VEC3", &[0.0, 3e38]),
        far("NORMAL", "VEC3", &[-3e38]),
        far("COLOR_0", "VEC3", &[1e30]),
        far("TEXCOORD_0", "VEC2", &[1e30]),
        factor("bright factor", [1e30, 0.0, 0.0, 1.0]),
        set("translation", &["nodes[0].translation", "is not from"], "/nodes/0/translation", json!([0.0, 1e20, 0.0])),
        set("scale", &["nodes[0].scale", "is not from"], "/nodes/0/scale", json!([1e20, 1.0, 1.0])),
        set("matrix", &["nodes[0].matrix", "is not from"], "/nodes/0/matrix", json!([1, 0, 0, 0, 0, 1e20, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])),
        morphed("morph offset", &["POSITION of targets[0]", "element 1", "is not from"], 1e30, 0.0),
        morphed("morph weight", &["nodes[0].weights", "is not from"], 1.0, 1e30),
        bound_far(),
    ]
}

/// A target that moves one corner by `offset`, at a weight.
fn morphed(name: &'static str, words: &[&'static str], offset: f32, weight: f32) -> Refusal {
    changed(name, words, |glb| {
        let target = glb.floats("VEC3", &[0.0, 0.0, 0.0, offset, 0.0, 0.0, 0.0, 0.0, 0.0]);
        glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
        glb.json["nodes"][0]["weights"] = json!([weight]);
    })
}

/// A track of one key.
fn moved(name: &'static str, words: &[&'static str], path: &str, [time, value]: [f32; 2]) -> Refusal {
    changed(name, words, |glb| {
        let keys = [glb.floats("SCALAR", &[time]), glb.floats("VEC3", &[value; 3])];
        glb.animate("move", path, "STEP", keys);
    })
}

/// An inverse bind matrix with a large scale.
fn bound_far() -> Refusal {
    let joints = |glb: &mut Glb| glb.u16s("VEC4", &[0; 12]);
    let weights = |glb: &mut Glb| glb.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
    let mut glb = skinned(joints, weights);
    let mut matrices = [0.0; 32];
    for diagonal in [0, 5, 10, 15, 16, 21, 26, 31] {
        matrices[diagonal] = 1.0;
    }
    matrices[21] = 1e30;
    let matrices = glb.floats("MAT4", &matrices);
    glb.json["skins"][0]["inverseBindMatrices"] = matrices.into();
    broken(
        "bound far",
        &["skins[0].inverseBindMatrices", "element 1", "is not from"],
        glb,
    )
}

#[rustfmt::skip] // One case a line.
fn skins() -> Vec<Refusal> {
    let joints = |glb: &mut Glb| glb.u16s("VEC4", &[0, 7, 0, 0].repeat(3));
    let weights = |glb: &mut Glb| glb.floats("VEC4", &[0.5, 0.5, 0.0, 0.0].repeat(3));
    let nan = |glb: &mut Glb| glb.floats("VEC4", &[f32::NAN, 0.5, 0.0, 0.0].repeat(3));
    let mut few_matrices = skinned(|glb| glb.u16s("VEC4", &[0; 12]), weights);
    few_matrices.json["skins"][0]["joints"] = json!([1, 2, 0]);
    vec![
        broken("no such joint", &["JOINTS with skins[0]", "refers to joint 7"], skinned(joints, weights)),
        broken("NaN weight", &["WEIGHTS_0", "3 of 12 numbers"], skinned(joints, nan)),
        broken("few matrices", &["skins[0].inverseBindMatrices", "has 2 matrices, but 3"], few_matrices),
    ]
}

/// Files that are valid toys, but whose only clip, `move`, cannot be read.
#[rustfmt::skip] // One case a line.
pub(crate) fn broken_clips() -> Vec<Refusal> {
    let animate = |glb: &mut Glb, times: &[f32], values: &[f32]| {
        let keys = [glb.floats("SCALAR", times), glb.floats("VEC3", values)];
        glb.animate("move", "translation", "LINEAR", keys);
    };
    let animated = |name, words: &[&'static str], times: &[f32], values: &[f32]| changed(name, words, |glb| animate(glb, times, values));
    let output = "animations[0].samplers[0].output";
    vec![
        animated("keys that stand still", &["samplers[0].input", "key 1"], &[1.0, 1.0], &[0.0; 6]),
        animated("too few values", &[output, "has 3 numbers, but 6"], &[0.0, 1.0], &[0.0; 3]),
        animated("infinite value", &[output, "not finite"], &[0.0], &[f32::INFINITY, 0.0, 0.0]),
        moved("animated value", &["samplers[0].output", "is not from"], "translation", [1.0, 1e30]),
        moved("animated scale", &["samplers[0].output", "is not from"], "scale", [1.0, -1e30]),
        moved("late key", &["samplers[0].input", "is not from"], "translation", [1e30, 0.0]),
        changed("matrix that shears", &["animations[0].channels[0]", "by a matrix"], |glb| {
            glb.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
            animate(glb, &[0.0], &[0.0; 3]);
        }),
        changed("no output", &["animations[0]", "missing field `output`"], |glb| {
            animate(glb, &[0.0], &[0.0; 3]);
            glb.json["animations"][0]["samplers"][0] = json!({ "input": 0 });
        }),
    ]
}

#[rustfmt::skip] // One case a line.
fn pictures() -> Vec<Refusal> {
    let wide = png(9000);
    let textured = |name, words: &[&'static str], picture: &[u8]| {
        changed(name, words, |glb| {
            let view = glb.view(picture);
            glb.json["images"] = json!([{ "bufferView": view }]);
            glb.json["textures"] = json!([{ "source": 0 }]);
            let base_color = json!({ "baseColorTexture": { "index": 0 } });
            glb.json["materials"] = json!([{ "pbrMetallicRoughness": base_color }]);
            glb.json["meshes"][0]["primitives"][0]["material"] = 0.into();
        })
    };
    vec![
        textured("wide picture", &["images[0]", "9000 pixels on one side"], &wide),
        textured("cut picture", &["images[0]", "cannot be decoded"], &png(100)[..60]),
    ]
}

fn png(width_px: u32) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let picture = image::RgbImage::new(width_px, 1);
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}
