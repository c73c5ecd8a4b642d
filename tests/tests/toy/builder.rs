//! Small glTF files, put together from JSON and bytes.

use serde_json::{Value, json};

/// A file in the making: one scene, one buffer.
#[derive(Clone)]
pub(crate) struct Glb {
    /// The whole JSON tree, free to be broken.
    pub(crate) json: Value,
    bin: Vec<u8>,
}

impl Glb {
    pub(crate) fn new() -> Self {
        let json = json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }] });
        Self {
            json,
            bin: Vec::new(),
        }
    }

    /// Appends to a list of the tree and returns the index.
    pub(crate) fn push(&mut self, list: &str, value: Value) -> usize {
        let list = &mut self.json[list];
        if list.is_null() {
            *list = json!([]);
        }
        let list = list.as_array_mut().unwrap();
        list.push(value);
        list.len() - 1
    }

    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        self.push("bufferViews", view)
    }

    /// An accessor of 32-bit floats; `shape` is `"VEC3"` and the like.
    pub(crate) fn floats(&mut self, shape: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let count = values.len() / width(shape);
        let view = self.view(&bytes);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5126, "type": shape, "count": count }),
        )
    }

    pub(crate) fn u16s(&mut self, shape: &str, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let count = values.len() / width(shape);
        let view = self.view(&bytes);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5123, "type": shape, "count": count }),
        )
    }

    /// An accessor of bytes that stand for fractions where `normalized`.
    pub(crate) fn u8s(&mut self, shape: &str, normalized: bool, values: &[u8]) -> usize {
        let count = values.len() / width(shape);
        let view = self.view(values);
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5121, "type": shape, "count": count,
                    "normalized": normalized }),
        )
    }

    /// A mesh of one primitive.
    pub(crate) fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// One channel of an animation called `name`.
    pub(crate) fn animate(
        &mut self,
        name: &str,
        path: &str,
        interpolation: &str,
        [input, output]: [usize; 2],
    ) {
        let sampler = json!({ "input": input, "output": output, "interpolation": interpolation });
        let channel = json!({ "sampler": 0, "target": { "node": 0, "path": path } });
        self.push(
            "animations",
            json!({ "name": name, "samplers": [sampler], "channels": [channel] }),
        );
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json["buffers"].is_null() {
            json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        }
        let mut text = serde_json::to_vec(&json).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let n_bytes = 12 + 8 + text.len() + 8 + self.bin.len();
        let u32_bytes = |value: usize| u32::try_from(value).unwrap().to_le_bytes();
        let header = [*b"glTF", u32_bytes(2), u32_bytes(n_bytes)].concat();
        let json_head = [u32_bytes(text.len()), *b"JSON"].concat();
        let bin_head = [u32_bytes(self.bin.len()), *b"BIN\0"].concat();
        [header, json_head, text, bin_head, self.bin.clone()].concat()
    }
}

fn width(shape: &str) -> usize {
    match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        "VEC4" => 4,
        "MAT4" => 16,
        _ => panic!("{shape} is no shape"),
    }
}

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

/// The same, following two joints: node 1 at the origin, node 2 at (0, 0, 4) and bound at (0, 1, 0).
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
    // A skinned mesh ignores where its own node stands.
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
