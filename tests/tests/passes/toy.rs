//! A toy of four boxes, as a binary glTF file: two legs, a body, and a head that moves.

use measure::glb::container;
use serde_json::{Value, json};

/// Name of the clip, which lasts one second.
pub(crate) const CLIP: &str = "look round";
/// Index of the head's node, which the clip moves.
const HEAD: usize = 3;

struct BoxPart {
    centre_m: [f32; 3],
    half_m: [f32; 3],
    /// Linear.
    color: [f32; 3],
}

const PARTS: [BoxPart; 4] = [
    BoxPart {
        centre_m: [-0.03, 0.025, 0.0],
        half_m: [0.012, 0.025, 0.02],
        color: [0.5, 0.35, 0.2],
    },
    BoxPart {
        centre_m: [0.03, 0.025, 0.0],
        half_m: [0.012, 0.025, 0.02],
        color: [0.5, 0.35, 0.2],
    },
    BoxPart {
        centre_m: [0.0, 0.065, 0.0],
        half_m: [0.05, 0.02, 0.025],
        color: [0.25, 0.45, 0.6],
    },
    BoxPart {
        centre_m: [0.045, 0.1, 0.0],
        half_m: [0.02, 0.02, 0.02],
        color: [0.6, 0.5, 0.15],
    },
];

/// Base colour of a triangle of the toy, linear; each box has twelve.
pub(crate) fn base_color(triangle: usize) -> glam::DVec3 {
    glam::Vec3::from(PARTS[triangle / 12].color).as_dvec3()
}

/// The file. In a second the head rises, moves across the body and turns by 60 degrees.
pub(crate) fn glb() -> Vec<u8> {
    let mut bin = Bin::default();
    let mut nodes = Vec::new();
    let mut meshes = Vec::new();
    let mut materials = Vec::new();
    for (index, part) in PARTS.iter().enumerate() {
        let (positions, normals, corners) = box_mesh(part.half_m);
        let attributes =
            json!({ "POSITION": bin.floats("VEC3", &positions), "NORMAL": bin.floats("VEC3", &normals) });
        let indices = bin.indices(&corners);
        meshes.push(
            json!({ "primitives": [{ "attributes": attributes, "indices": indices, "material": index }] }),
        );
        nodes.push(json!({ "mesh": index, "translation": part.centre_m }));
        let [r, g, b] = part.color;
        materials.push(json!({ "pbrMetallicRoughness": { "baseColorFactor": [r, g, b, 1.0] } }));
    }
    let times = bin.floats("SCALAR", &[0.0, 1.0]);
    let places = bin.floats("VEC3", &[0.045, 0.1, 0.0, -0.04, 0.125, 0.03]);
    let turns = bin.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.866_025_4]);
    let sampler = |output: usize| json!({ "input": times, "output": output });
    let channel =
        |sampler: usize, path: &str| json!({ "sampler": sampler, "target": { "node": HEAD, "path": path } });
    let json = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1, 2, 3] }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "animations": [{
            "name": CLIP,
            "samplers": [sampler(places), sampler(turns)],
            "channels": [channel(0, "translation"), channel(1, "rotation")],
        }],
        "buffers": [{ "byteLength": bin.bytes.len() }],
        "bufferViews": bin.views,
        "accessors": bin.accessors,
    });
    container(json.to_string().as_bytes(), &bin.bytes)
}

#[derive(Default)]
struct Bin {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Bin {
    fn floats(&mut self, shape: &str, values: &[f32]) -> usize {
        let width = match shape {
            "SCALAR" => 1,
            "VEC3" => 3,
            _ => 4,
        };
        self.accessor(
            bytemuck::cast_slice(values),
            json!({ "componentType": 5126, "type": shape, "count": values.len() / width }),
        )
    }

    fn indices(&mut self, values: &[u32]) -> usize {
        self.accessor(
            bytemuck::cast_slice(values),
            json!({ "componentType": 5125, "type": "SCALAR", "count": values.len() }),
        )
    }

    fn accessor(&mut self, bytes: &[u8], mut accessor: Value) -> usize {
        self.views
            .push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        accessor["bufferView"] = (self.views.len() - 1).into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

/// Six faces of four corners each, counter-clockwise from outside: positions, normals, indices.
fn box_mesh(half_m: [f32; 3]) -> (Vec<f32>, Vec<f32>, Vec<u32>) {
    let (mut positions, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let first = u32::try_from(positions.len() / 3).unwrap();
            let (across, along) = ((axis + 1) % 3, (axis + 2) % 3);
            for (s, t) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let mut position = half_m;
                let mut normal = [0.0; 3];
                position[axis] *= side;
                // Seen from the other side, the corners go round the other way.
                position[across] *= s * side;
                position[along] *= t;
                normal[axis] = side;
                positions.extend(position);
                normals.extend(normal);
            }
            indices.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner));
        }
    }
    (positions, normals, indices)
}
