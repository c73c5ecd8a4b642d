//! Skins: joints of each vertex, and their weights.

use glam::{DAffine3, DMat3, DVec3};
use gltf::json::accessor::Type;
use gltf::json::mesh::{Primitive, Semantic};
use gltf::json::validation::Checked;

use super::accessor::Source;
use super::check::{check_count, check_limit};
use super::container::get;
use super::error::{Flaw, ToyProblem};
use super::graph::affine;
use super::limits::{MAX_JOINT_SETS, MAX_JOINTS, NUMBER};

pub(super) struct Skin {
    /// Nodes of the joints.
    pub(super) joints: Vec<usize>,
    /// The inverse bind matrix of each joint.
    pub(super) joint_from_mesh: Vec<DAffine3>,
}

/// The joints that the vertices of a primitive follow.
#[derive(Clone)]
pub(super) struct Influences {
    /// Number of joints per vertex, a multiple of four.
    pub(super) n_per_vertex: usize,
    /// Indices of joints within the skin; 0 if the weight is 0.
    pub(super) joints: Vec<u16>,
    /// Weights, not negative; those of a vertex sum to one.
    pub(super) weights: Vec<f32>,
    /// Number of vertices whose weights were repaired to sum to one.
    pub(super) n_repaired: usize,
}

impl Influences {
    /// The joints of one vertex, each with its weight.
    pub(super) fn of(&self, vertex: usize) -> impl Iterator<Item = (u16, f32)> + '_ {
        let range = vertex * self.n_per_vertex..(vertex + 1) * self.n_per_vertex;
        let joints = self.joints[range.clone()].iter().copied();
        joints.zip(self.weights[range].iter().copied())
    }

    /// The weighted mean of the joints' transforms for one vertex.
    pub(super) fn blend(&self, vertex: usize, palette: &[DAffine3]) -> DAffine3 {
        let mut blend = DAffine3 {
            matrix3: DMat3::ZERO,
            translation: DVec3::ZERO,
        };
        for (joint, weight) in self.of(vertex) {
            if weight > 0.0 {
                let (joint, weight) = (&palette[usize::from(joint)], f64::from(weight));
                blend.matrix3 += joint.matrix3 * weight;
                blend.translation += joint.translation * weight;
            }
        }
        blend
    }

    /// One more than the highest joint in use.
    pub(super) fn n_joints_needed(&self) -> usize {
        self.joints
            .iter()
            .max()
            .map_or(0, |&joint| usize::from(joint) + 1)
    }

    /// Exchanges two vertices.
    pub(super) fn swap(&mut self, a: usize, b: usize) {
        for k in 0..self.n_per_vertex {
            let (a, b) = (a * self.n_per_vertex + k, b * self.n_per_vertex + k);
            self.joints.swap(a, b);
            self.weights.swap(a, b);
        }
    }

    pub(super) fn gather(&self, sources: &[u32]) -> Self {
        let n = self.n_per_vertex;
        let rows = || {
            sources
                .iter()
                .map(|&source| source as usize * n..(source as usize + 1) * n)
        };
        Self {
            n_per_vertex: n,
            joints: rows().flat_map(|row| &self.joints[row]).copied().collect(),
            weights: rows().flat_map(|row| &self.weights[row]).copied().collect(),
            n_repaired: self.n_repaired,
        }
    }
}

pub(super) fn read_skins(source: &Source) -> Result<Vec<Skin>, Flaw> {
    let mut n_joints = 0;
    let mut skins = Vec::with_capacity(source.root.skins.len());
    for (i, skin) in source.root.skins.iter().enumerate() {
        let field = format!("skins[{i}].joints");
        n_joints = check_limit("joints", n_joints + skin.joints.len(), MAX_JOINTS, &field)?;
        for &joint in &skin.joints {
            get(source.root, &field, joint, "node")?;
        }
        let joint_from_mesh = match skin.inverse_bind_matrices {
            Some(index) => read_matrices(source, &format!("skins[{i}].inverseBindMatrices"), index)?,
            None => vec![DAffine3::IDENTITY; skin.joints.len()],
        };
        let (found, expected) = (joint_from_mesh.len(), skin.joints.len());
        if found < expected {
            let problem = ToyProblem::Count {
                what: "matrices",
                found,
                expected,
            };
            return Err(problem.at(format!("skins[{i}].inverseBindMatrices")));
        }
        skins.push(Skin {
            joints: skin.joints.iter().map(|joint| joint.value()).collect(),
            joint_from_mesh,
        });
    }
    Ok(skins)
}

fn read_matrices(
    source: &Source,
    field: &str,
    index: gltf::json::Index<gltf::json::Accessor>,
) -> Result<Vec<DAffine3>, Flaw> {
    let values = source.floats_within(field, index, Type::Mat4, &NUMBER)?;
    values
        .as_chunks()
        .0
        .iter()
        .enumerate()
        .map(|(i, columns)| affine(columns, field, i))
        .collect()
}

/// Reads every set of joints and weights; `None` if there is none.
pub(super) fn read_influences(
    source: &Source,
    field: &str,
    primitive: &Primitive,
    n_vertices: usize,
) -> Result<Option<Influences>, Flaw> {
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let mut sets = Vec::new();
    for set in 0..MAX_JOINT_SETS {
        let (Some(joints), Some(weights)) = (
            attribute(Semantic::Joints(set)),
            attribute(Semantic::Weights(set)),
        ) else {
            break;
        };
        let (joints_field, weights_field) = (
            format!("{field}.attributes.JOINTS_{set}"),
            format!("{field}.attributes.WEIGHTS_{set}"),
        );
        let joints = source.integers(&joints_field, joints, Type::Vec4)?;
        let weights = source.floats(&weights_field, weights, Type::Vec4)?;
        for (field, found) in [
            (joints_field, joints.len() / 4),
            (weights_field, weights.len() / 4),
        ] {
            check_count("elements", found, n_vertices, &field)?;
        }
        sets.push((joints, weights));
    }
    if sets.is_empty() {
        return Ok(None);
    }
    let n_per_vertex = 4 * sets.len();
    source.charge(field, 2 * n_per_vertex * n_vertices)?;
    let mut influences = Influences {
        n_per_vertex,
        joints: Vec::new(),
        weights: Vec::new(),
        n_repaired: 0,
    };
    for vertex in 0..n_vertices {
        for (joints, weights) in &sets {
            let row = 4 * vertex..4 * vertex + 4;
            influences.weights.extend_from_slice(&weights[row.clone()]);
            // An index that does not fit is out of every skin's range, and is refused later.
            influences
                .joints
                .extend(joints[row].iter().map(|&j| u16::try_from(j).unwrap_or(u16::MAX)));
        }
        repair(&mut influences, vertex);
    }
    Ok(Some(influences))
}

/// Makes the weights of one vertex sum to one, and replaces joints without weight by joint 0.
fn repair(influences: &mut Influences, vertex: usize) {
    // Eight bits cannot represent thirds: a smaller difference is the rounding of a good exporter.
    const TOLERANCE: f32 = 1.0 / 255.0;
    let row = vertex * influences.n_per_vertex..(vertex + 1) * influences.n_per_vertex;
    let (weights, joints) = (&mut influences.weights[row.clone()], &mut influences.joints[row]);
    let has_negative = weights.iter().any(|&weight| weight < 0.0);
    // Summed in f64, where no sum of a few f32 can overflow.
    let sum: f64 = weights.iter().map(|&weight| f64::from(weight.max(0.0))).sum();
    if has_negative || (sum - 1.0).abs() > f64::from(TOLERANCE) {
        influences.n_repaired += 1;
    }
    for (i, (weight, joint)) in weights.iter_mut().zip(joints).enumerate() {
        *weight = match sum > 0.0 {
            true => scaled(*weight, sum),
            false => f32::from(u8::from(i == 0)),
        };
        if *weight <= 0.0 {
            *joint = 0;
        }
    }
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a fraction of one, stored as it was read"
)]
fn scaled(weight: f32, sum: f64) -> f32 {
    (f64::from(weight.max(0.0)) / sum) as f32
}
