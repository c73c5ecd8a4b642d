//! The bundled toy's file, and changes to it.

use std::fs;

use app_core::toy::Toy;
use desk::files::BUNDLED_SESSION;
use measure::glb::{chunks, container};
use serde_json::{Value, json};

/// The bundled toy's file with packed accessors.
pub(crate) struct File {
    json: Value,
    bin: Vec<u8>,
}

impl File {
    pub(crate) fn open() -> Self {
        let bytes = fs::read(format!("{BUNDLED_SESSION}/toy.glb")).unwrap();
        let (json, bin) = chunks(&bytes);
        Self {
            json,
            bin: bin.to_vec(),
        }
    }

    /// The primitives' accessors that `find` selects.
    fn accessors(&self, find: impl Fn(&Value) -> &Value) -> Vec<usize> {
        let primitives = self.json["meshes"][0]["primitives"].as_array().unwrap();
        let index = |primitive| usize::try_from(find(primitive).as_u64().unwrap()).unwrap();
        primitives.iter().map(index).collect()
    }

    /// The bytes of an accessor with elements of `size` bytes.
    fn elements(&mut self, accessor: usize, size: usize) -> &mut [u8] {
        let number = |value: &Value| usize::try_from(value.as_u64().unwrap_or(0)).unwrap();
        let accessor = &self.json["accessors"][accessor];
        let view = &self.json["bufferViews"][number(&accessor["bufferView"])];
        let first = number(&view["byteOffset"]) + number(&accessor["byteOffset"]);
        let n_bytes = size * number(&accessor["count"]);
        &mut self.bin[first..first + n_bytes]
    }

    /// Changes each normal of the first `n` primitives.
    pub(crate) fn change_normals(mut self, n: usize, change: impl Fn([f32; 3]) -> [f32; 3]) -> Self {
        for accessor in self
            .accessors(|primitive| &primitive["attributes"]["NORMAL"])
            .into_iter()
            .take(n)
        {
            for bytes in self.elements(accessor, 12).as_chunks_mut::<12>().0 {
                let normal = [0, 4, 8].map(|k| f32::from_le_bytes(bytes[k..k + 4].try_into().unwrap()));
                bytes.copy_from_slice(change(normal).map(f32::to_le_bytes).as_flattened());
            }
        }
        self
    }

    /// Reverses every triangle.
    pub(crate) fn turn_faces(mut self) -> Self {
        for accessor in self.accessors(|primitive| &primitive["indices"]) {
            for [_, b, c] in self
                .elements(accessor, 2)
                .as_chunks_mut::<2>()
                .0
                .as_chunks_mut()
                .0
            {
                std::mem::swap(b, c);
            }
        }
        self
    }

    /// Adds a square of the first material that faces up, around a point in object space.
    pub(crate) fn add_square(mut self, [x, y, z]: [f32; 3], half_m: f32) -> Self {
        let corner = |along: f32, across: f32| [x + along * half_m, y, z + across * half_m];
        let corners = [
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, -1.0),
            corner(-1.0, -1.0),
        ];
        let triangles = [0, 1, 2, 0, 2, 3].map(|k: usize| corners[k]);
        let numbers = triangles.as_flattened().iter();
        self.bin.extend(numbers.flat_map(|number| number.to_le_bytes()));
        let first = self.bin.len() - 72;
        let n_views = push(
            &mut self.json["bufferViews"],
            json!({ "buffer": 0, "byteOffset": first, "byteLength": 72 }),
        );
        let position = push(
            &mut self.json["accessors"],
            json!({ "bufferView": n_views, "componentType": 5126, "type": "VEC3", "count": 6 }),
        );
        let primitive = json!({ "attributes": { "POSITION": position }, "material": 0 });
        let mesh = push(&mut self.json["meshes"], json!({ "primitives": [primitive] }));
        let node = push(&mut self.json["nodes"], json!({ "mesh": mesh }));
        push(&mut self.json["scenes"][0]["nodes"], json!(node));
        self
    }

    pub(crate) fn toy(&self) -> Toy {
        Toy::from_glb("toy.glb", &container(self.json.to_string().as_bytes(), &self.bin)).unwrap()
    }
}

/// Appends to a list and returns the index.
fn push(list: &mut Value, value: Value) -> usize {
    let list = list.as_array_mut().unwrap();
    list.push(value);
    list.len() - 1
}
