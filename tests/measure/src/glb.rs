//! Small glTF binaries, put together from JSON and bytes.

use serde_json::{Value, json};

/// A glTF file under construction: one scene, one buffer.
#[derive(Clone, Debug)]
pub struct Glb {
    /// The whole JSON tree, which tests may break.
    pub json: Value,
    bin: Vec<u8>,
}

impl Default for Glb {
    fn default() -> Self {
        Self::new()
    }
}

impl Glb {
    /// A file whose scene shows node 0, which the caller must add.
    #[must_use]
    pub fn new() -> Self {
        let json = json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }] });
        Self {
            json,
            bin: Vec::new(),
        }
    }

    /// Appends to a list of the tree and returns the index.
    ///
    /// # Panics
    /// When that key holds something other than a list.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        let list = &mut self.json[list];
        if list.is_null() {
            *list = json!([]);
        }
        let list = list.as_array_mut().expect("entries are pushed to lists");
        list.push(value);
        list.len() - 1
    }

    /// Appends bytes, padded to four, and returns the index of their view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() });
        self.push("bufferViews", view)
    }

    /// An accessor of 32-bit floats; `shape` is `"VEC3"` and the like.
    pub fn floats(&mut self, shape: &str, values: &[f32]) -> usize {
        let accessor = json!({ "componentType": 5126, "type": shape, "count": values.len() / width(shape) });
        self.accessor(bytemuck::cast_slice(values), accessor)
    }

    /// An accessor of 32-bit integers, one per element.
    pub fn u32s(&mut self, values: &[u32]) -> usize {
        let accessor = json!({ "componentType": 5125, "type": "SCALAR", "count": values.len() });
        self.accessor(bytemuck::cast_slice(values), accessor)
    }

    /// An accessor of 16-bit integers.
    pub fn u16s(&mut self, shape: &str, values: &[u16]) -> usize {
        let accessor = json!({ "componentType": 5123, "type": shape, "count": values.len() / width(shape) });
        self.accessor(bytemuck::cast_slice(values), accessor)
    }

    /// An accessor of bytes, which are fractions if `normalized`.
    pub fn u8s(&mut self, shape: &str, normalized: bool, values: &[u8]) -> usize {
        let count = values.len() / width(shape);
        let accessor =
            json!({ "componentType": 5121, "type": shape, "count": count, "normalized": normalized });
        self.accessor(values, accessor)
    }

    fn accessor(&mut self, bytes: &[u8], mut accessor: Value) -> usize {
        accessor["bufferView"] = self.view(bytes).into();
        self.push("accessors", accessor)
    }

    /// A mesh of one primitive.
    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// One channel of an animation called `name`.
    pub fn animate(&mut self, name: &str, path: &str, interpolation: &str, [input, output]: [usize; 2]) {
        let sampler = json!({ "input": input, "output": output, "interpolation": interpolation });
        let channel = json!({ "sampler": 0, "target": { "node": 0, "path": path } });
        self.push(
            "animations",
            json!({ "name": name, "samplers": [sampler], "channels": [channel] }),
        );
    }

    /// The file.
    ///
    /// # Panics
    /// When it takes more than 4 GiB.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json["buffers"].is_null() {
            json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        }
        container(json.to_string().as_bytes(), &self.bin)
    }
}

/// A file: a header and two chunks. Source: glTF 2.0, section 4.4.
///
/// # Panics
/// When it takes more than 4 GiB.
#[must_use]
pub fn container(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let padded = |chunk: &[u8], padding: u8| {
        let mut chunk = chunk.to_vec();
        chunk.resize(chunk.len().next_multiple_of(4), padding);
        chunk
    };
    let (json, bin) = (padded(json, b' '), padded(bin, 0));
    let word = |value: usize| u32::try_from(value).expect("it is small").to_le_bytes();
    let header = [*b"glTF", word(2), word(28 + json.len() + bin.len())].concat();
    let json_head = [word(json.len()), *b"JSON"].concat();
    let bin_head = [word(bin.len()), *b"BIN\0"].concat();
    [header, json_head, json, bin_head, bin].concat()
}

/// Tree and binary chunk of a file made by [`container`] or a similar one.
///
/// # Panics
/// When it is invalid.
#[must_use]
pub fn chunks(file: &[u8]) -> (Value, &[u8]) {
    let (length, chunks) = file[12..].split_first_chunk().expect("a file has a chunk");
    let (json, bin) = chunks[4..].split_at(u32::from_le_bytes(*length) as usize);
    let json = serde_json::from_slice(json).expect("the first chunk is JSON");
    (json, &bin[8..])
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
