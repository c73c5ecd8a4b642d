//! A toy of four boxes, as a binary glTF file: two legs, a body, and a head that moves.

use measure::glb::Glb;
use serde_json::json;

/// Name of the clip, which lasts one second.
pub(crate) const CLIP: &str = "look round";
/// Index of the head's node, which the clip moves.
const HEAD: usize = 3;

struct BoxPart {
    centre_m: [f32; 3],
    half_m: [f32; 3],
    /// Linear colour.
    color: [f32; 3],
}

#[rustfmt::skip] // Each part has a line of its own.
const PARTS: [BoxPart; 4] = [
    BoxPart { centre_m: [-0.03, 0.025, 0.0], half_m: [0.012, 0.025, 0.02], color: [0.5, 0.35, 0.2] },
    BoxPart { centre_m: [0.03, 0.025, 0.0], half_m: [0.012, 0.025, 0.02], color: [0.5, 0.35, 0.2] },
    BoxPart { centre_m: [0.0, 0.065, 0.0], half_m: [0.05, 0.02, 0.025], color: [0.25, 0.45, 0.6] },
    BoxPart { centre_m: [0.045, 0.1, 0.0], half_m: [0.02, 0.02, 0.02], color: [0.6, 0.5, 0.15] },
];

/// Base colour of a triangle of the toy, linear; each box has twelve.
pub(crate) fn base_color(triangle: usize) -> glam::DVec3 {
    glam::Vec3::from(PARTS[triangle / 12].color).as_dvec3()
}

/// Index of the material of a triangle.
pub(crate) fn material(triangle: usize) -> usize {
    triangle / 12
}

/// The file. In a second the head rises, moves across the body and turns by 60 degrees.
pub(crate) fn glb() -> Vec<u8> {
    let mut glb = Glb::new();
    for (index, part) in PARTS.iter().enumerate() {
        let (positions, normals, corners) = box_mesh(part.half_m);
        let attributes =
            json!({ "POSITION": glb.floats("VEC3", &positions), "NORMAL": glb.floats("VEC3", &normals) });
        let indices = glb.u32s(&corners);
        glb.mesh(json!({ "attributes": attributes, "indices": indices, "material": index }));
        glb.push("nodes", json!({ "mesh": index, "translation": part.centre_m }));
        let [r, g, b] = part.color;
        let color = json!({ "baseColorFactor": [r, g, b, 1.0] });
        glb.push("materials", json!({ "pbrMetallicRoughness": color }));
    }
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let times = glb.floats("SCALAR", &[0.0, 1.0]);
    let places = glb.floats("VEC3", &[0.045, 0.1, 0.0, -0.04, 0.125, 0.03]);
    let turns = glb.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.866_025_4]);
    let sampler = |output: usize| json!({ "input": times, "output": output });
    let channel =
        |sampler: usize, path: &str| json!({ "sampler": sampler, "target": { "node": HEAD, "path": path } });
    let clip = json!({
        "name": CLIP,
        "samplers": [sampler(places), sampler(turns)],
        "channels": [channel(0, "translation"), channel(1, "rotation")],
    });
    glb.push("animations", clip);
    glb.bytes()
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
                // From the other side, the corners are in the opposite order.
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
