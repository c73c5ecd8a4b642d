//! A binary glTF file of one mesh.

use app_core::toy::binary_gltf;
use serde_json::{Value, json};

/// Vertices of a mesh; every list is empty or as long as the positions.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mesh {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// Linear colours.
    pub(super) colors: Vec<[f32; 3]>,
    /// Texture coordinates, from the top of the texture.
    pub(super) tex_coords: Vec<[f32; 2]>,
    pub(super) indices: Vec<u32>,
}

/// The texture of a mesh.
pub(super) struct Texture {
    pub(super) bytes: Vec<u8>,
    pub(super) media_type: &'static str,
}

/// The binary chunk while it is filled, and its description in the JSON tree.
#[derive(Default)]
struct Parts {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Parts {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.views
            .push(json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() }));
        self.bin.extend_from_slice(bytes);
        self.views.len() - 1
    }

    fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values
            .iter()
            .flatten()
            .flat_map(|value| value.to_le_bytes())
            .collect();
        let view = self.view(&bytes);
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            let all = (0..N).map(|axis| values.iter().map(|value| value[axis]).reduce(pick));
            all.map(|value| value.unwrap_or(0.0)).collect()
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": values.len(), "type": format!("VEC{N}"),
            "min": bound(f32::min), "max": bound(f32::max),
        }));
        self.accessors.len() - 1
    }

    fn indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        let view = self.view(&bytes);
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5125, "count": indices.len(), "type": "SCALAR",
        }));
        self.accessors.len() - 1
    }
}

/// The file. Its material is rough, seen from both sides.
pub(super) fn glb(mesh: &Mesh, texture: Option<&Texture>) -> Vec<u8> {
    let mut parts = Parts::default();
    let mut attributes = json!({ "POSITION": parts.floats(&mesh.positions) });
    if !mesh.normals.is_empty() {
        attributes["NORMAL"] = parts.floats(&mesh.normals).into();
    }
    if !mesh.colors.is_empty() {
        attributes["COLOR_0"] = parts.floats(&mesh.colors).into();
    }
    if !mesh.tex_coords.is_empty() {
        attributes["TEXCOORD_0"] = parts.floats(&mesh.tex_coords).into();
    }
    let indices = parts.indices(&mesh.indices);
    let mut material = json!({ "doubleSided": true, "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 1.0 } });
    let mut tree = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": attributes, "indices": indices, "material": 0 }] }],
    });
    if let Some(texture) = texture {
        let view = parts.view(&texture.bytes);
        tree["images"] = json!([{ "bufferView": view, "mimeType": texture.media_type }]);
        tree["textures"] = json!([{ "source": 0 }]);
        material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
    }
    tree["materials"] = json!([material]);
    tree["bufferViews"] = parts.views.into();
    tree["accessors"] = parts.accessors.into();
    tree["buffers"] = json!([{ "byteLength": parts.bin.len() }]);
    binary_gltf(tree.to_string().as_bytes(), &parts.bin)
}
