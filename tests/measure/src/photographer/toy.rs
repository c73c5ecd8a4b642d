//! The toy of a world as a glTF binary: each part is a node with its own mesh and material.

use glam::{DQuat, DVec3};
use serde_json::json;

use super::motion::Key;
use super::shape::Mesh;
use super::world::{Part, World};
use crate::glb::Glb;

/// Name of the clip that moves the parts.
pub const CLIP: &str = "move";
/// Name of the clip that keeps them still.
pub const STILL_CLIP: &str = "still";
/// End of that clip.
const STILL_SECS: f64 = 10.0;

/// Variants of a toy's file; none of them changes the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToyFile {
    /// Whether a second clip keeps each part at rest.
    pub has_still_clip: bool,
    /// Whether there are an unused material, mesh and node.
    pub has_unused: bool,
    /// Seed of another order of triangles and corners.
    pub order: Option<u64>,
    /// Sum of the weights with which parts follow joints instead of nodes.
    pub skin_weight: Option<f32>,
}

/// The file of a world's toy.
#[must_use]
pub fn toy_glb(world: &World, file: &ToyFile) -> Vec<u8> {
    let mut glb = Glb::new();
    if file.has_unused {
        glb.push("materials", json!({ "name": "unused" }));
        let mesh = add_mesh(&mut glb, &world.parts[0].shape.mesh(), 0);
        glb.push("nodes", json!({ "mesh": mesh, "scale": [7.0, 7.0, 7.0] }));
    }
    let first = usize::from(file.has_unused);
    for (index, part) in world.parts.iter().enumerate() {
        add_part(&mut glb, part, index, file);
    }
    let nodes: Vec<usize> = (first..first + world.parts.len()).collect();
    glb.json["scenes"][0]["nodes"] = nodes.into();
    if let Some(weight) = file.skin_weight {
        add_skin(&mut glb, first, world, weight);
    }
    add_clip(&mut glb, CLIP, first, world, |part| part.keys.clone());
    if file.has_still_clip {
        let rest = |part: &Part| {
            [0.0, STILL_SECS].map(|time_secs| Key {
                time_secs,
                stance: part.rest,
            })
        };
        add_clip(&mut glb, STILL_CLIP, first, world, |part| rest(part).to_vec());
    }
    glb.bytes()
}

fn add_part(glb: &mut Glb, part: &Part, index: usize, file: &ToyFile) {
    let [r, g, b] = floats(part.color);
    let color = json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0 });
    let material = glb.push("materials", json!({ "pbrMetallicRoughness": color }));
    let mut mesh = part.shape.mesh();
    if let Some(seed) = file.order {
        mesh = reordered(&mesh, seed.wrapping_add(index as u64));
    }
    let mesh = add_mesh(glb, &mesh, material);
    let (place, turn) = (floats(part.rest.place_m), turn_floats(part.rest.turn));
    glb.push(
        "nodes",
        json!({ "mesh": mesh, "translation": place, "rotation": turn }),
    );
}

fn add_mesh(glb: &mut Glb, mesh: &Mesh, material: usize) -> usize {
    let flat = |vectors: &[DVec3]| vectors.iter().copied().flat_map(floats).collect::<Vec<f32>>();
    let position = glb.floats("VEC3", &flat(&mesh.positions));
    let normal = glb.floats("VEC3", &flat(&mesh.normals));
    let indices = glb.u32s(&mesh.indices);
    let attributes = json!({ "POSITION": position, "NORMAL": normal });
    glb.mesh(json!({ "attributes": attributes, "indices": indices, "material": material }))
}

/// Moves each part's mesh to its own node, which follows the part's node as a joint, by two
/// weights.
fn add_skin(glb: &mut Glb, first: usize, world: &World, weight: f32) {
    let joints: Vec<usize> = (first..first + world.parts.len()).collect();
    let skin = glb.push("skins", json!({ "joints": joints }));
    for (index, part) in world.parts.iter().enumerate() {
        let n_corners = part.shape.mesh().positions.len();
        #[allow(clippy::cast_possible_truncation, reason = "a toy here has few parts")]
        let joint = index as u16;
        let followed = glb.u16s("VEC4", &[joint, joint, 0, 0].repeat(n_corners));
        let weights = [0.25 * weight, 0.75 * weight, 0.0, 0.0].repeat(n_corners);
        let weights = glb.floats("VEC4", &weights);
        let mesh = first + index;
        let attributes = &mut glb.json["meshes"][mesh]["primitives"][0]["attributes"];
        attributes["JOINTS_0"] = followed.into();
        attributes["WEIGHTS_0"] = weights.into();
        if let Some(node) = glb.json["nodes"][mesh].as_object_mut() {
            node.remove("mesh");
        }
        let shown = glb.push("nodes", json!({ "mesh": mesh, "skin": skin }));
        if let Some(nodes) = glb.json["scenes"][0]["nodes"].as_array_mut() {
            nodes.push(shown.into());
        }
    }
}

fn add_clip(glb: &mut Glb, name: &str, first: usize, world: &World, keys_of: impl Fn(&Part) -> Vec<Key>) {
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for (index, part) in world.parts.iter().enumerate() {
        let keys = keys_of(part);
        if keys.is_empty() {
            continue;
        }
        let times: Vec<f32> = keys.iter().map(|key| float(key.time_secs)).collect();
        let places: Vec<f32> = keys.iter().flat_map(|key| floats(key.stance.place_m)).collect();
        let turns: Vec<f32> = keys.iter().flat_map(|key| turn_floats(key.stance.turn)).collect();
        let input = glb.floats("SCALAR", &times);
        let outputs = [
            ("translation", glb.floats("VEC3", &places)),
            ("rotation", glb.floats("VEC4", &turns)),
        ];
        for (path, output) in outputs {
            let target = json!({ "node": first + index, "path": path });
            channels.push(json!({ "sampler": samplers.len(), "target": target }));
            samplers.push(json!({ "input": input, "output": output }));
        }
    }
    if !channels.is_empty() {
        let clip = json!({ "name": name, "samplers": samplers, "channels": channels });
        glb.push("animations", clip);
    }
}

/// The same triangles, in another order and starting at another corner each.
fn reordered(mesh: &Mesh, seed: u64) -> Mesh {
    let mut triangles: Vec<&[u32]> = mesh.indices.chunks_exact(3).collect();
    let hash = |triangle: &&[u32]| {
        let word = u64::from(triangle[0]) << 40 | u64::from(triangle[1]) << 20 | u64::from(triangle[2]);
        (word ^ seed).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(17)
    };
    triangles.sort_by_key(hash);
    let turned = triangles.iter().enumerate();
    let corners = turned.flat_map(|(index, triangle)| (0..3).map(move |k| triangle[(k + index) % 3]));
    Mesh {
        indices: corners.collect(),
        ..mesh.clone()
    }
}

#[allow(clippy::cast_possible_truncation, reason = "glTF stores 32-bit floats")]
fn float(value: f64) -> f32 {
    value as f32
}

fn floats(vector: DVec3) -> [f32; 3] {
    vector.to_array().map(float)
}

fn turn_floats(turn: DQuat) -> [f32; 4] {
    turn.to_array().map(float)
}
