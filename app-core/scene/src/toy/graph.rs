//! The nodes of the file: their hierarchy, and their transforms when nothing is animated.

use std::ops::Range;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf::json::{self, Root, mesh::Mesh};

use super::check::{check_count, check_finite, check_limit, check_range};
use super::container::get;
use super::error::{Flaw, ToyProblem};
use super::limits::{MAX_MORPH_WEIGHTS, MAX_NODES, NUMBER};
use super::warning::ToyWarning;

/// All nodes of the file, whether in the scene or not: a joint may be outside of it.
pub(super) struct Graph {
    pub(super) nodes: Vec<Node>,
    /// Their names as authored.
    pub(super) names: Vec<Option<String>>,
    /// All nodes, parents before children.
    pub(super) parents_first: Vec<usize>,
    /// Morph weights as authored; [`Node::morph_weights`] are ranges in this list.
    pub(super) rest_weights: Vec<f64>,
}

pub(super) struct Node {
    pub(super) parent: Option<usize>,
    pub(super) rest: Local,
    /// One weight for each morph target of the node's mesh.
    pub(super) morph_weights: Range<usize>,
}

/// Transform from a node to its parent.
#[derive(Clone, Copy)]
pub(super) enum Local {
    Matrix(DAffine3),
    Decomposed(Trs),
}

impl Local {
    pub(super) fn decomposed(self) -> Option<Trs> {
        match self {
            Self::Matrix(_) => None,
            Self::Decomposed(trs) => Some(trs),
        }
    }

    /// The transform decomposed; `None` if it shears.
    pub(super) fn taken_apart(self) -> Option<Trs> {
        const TOLERANCE: f64 = 1e-4;
        let matrix = match self {
            Self::Decomposed(trs) => return Some(trs),
            Self::Matrix(matrix) => matrix,
        };
        let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
        let again = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
        let size = scale.abs().max_element();
        let is_same = again.matrix3.abs_diff_eq(matrix.matrix3, TOLERANCE * size);
        (is_same && rotation.is_normalized()).then_some(Trs {
            translation,
            rotation,
            scale,
        })
    }

    pub(super) fn parent_from_node(self) -> DAffine3 {
        match self {
            Self::Matrix(matrix) => matrix,
            Self::Decomposed(trs) => {
                DAffine3::from_scale_rotation_translation(trs.scale, trs.rotation, trs.translation)
            }
        }
    }
}

/// Transform from a node to its parent: scale first, then rotation (of unit length), then
/// translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trs {
    /// In units of the file.
    pub translation: DVec3,
    /// Unit quaternion.
    pub rotation: DQuat,
    /// Scale along each axis.
    pub scale: DVec3,
}

pub(super) fn read(root: &Root, warnings: &mut Vec<ToyWarning>) -> Result<Graph, Flaw> {
    let n_nodes = check_limit("nodes", root.nodes.len(), MAX_NODES, "nodes")?;
    let parents = parents(root)?;
    let parents_first = parents_first(&parents)?;
    let mut rest_weights = Vec::new();
    let mut nodes = Vec::with_capacity(n_nodes);
    for (i, (node, parent)) in root.nodes.iter().zip(parents).enumerate() {
        let field = format!("nodes[{i}]");
        let first = rest_weights.len();
        append_weights(root, node, &field, &mut rest_weights)?;
        let rest = local(node, &field, warnings)?;
        nodes.push(Node {
            parent,
            rest,
            morph_weights: first..rest_weights.len(),
        });
    }
    Ok(Graph {
        nodes,
        names: root.nodes.iter().map(|node| node.name.clone()).collect(),
        parents_first,
        rest_weights,
    })
}

/// The nodes of the default scene (or the first, or all nodes if there is no scene), each once.
pub(super) fn scene_nodes(root: &Root) -> Result<Vec<usize>, Flaw> {
    let scene = match root.scene {
        Some(index) => Some(get(root, "scene", index, "scene")?),
        None => root.scenes.first(),
    };
    let Some(scene) = scene else {
        return Ok((0..root.nodes.len()).collect());
    };
    let mut is_reached = vec![false; root.nodes.len()];
    let mut waiting: Vec<usize> = scene.nodes.iter().rev().map(json::Index::value).collect();
    let mut reached = Vec::new();
    while let Some(node) = waiting.pop() {
        let no_such = ToyProblem::NoSuch {
            what: "node",
            index: node,
            n: root.nodes.len(),
        };
        let seen = is_reached
            .get_mut(node)
            .ok_or_else(|| no_such.at("scenes.nodes"))?;
        if std::mem::replace(seen, true) {
            continue;
        }
        reached.push(node);
        waiting.extend(
            root.nodes[node]
                .children
                .iter()
                .flatten()
                .rev()
                .map(json::Index::value),
        );
    }
    Ok(reached)
}

fn parents(root: &Root) -> Result<Vec<Option<usize>>, Flaw> {
    let mut parents = vec![None; root.nodes.len()];
    for (i, node) in root.nodes.iter().enumerate() {
        for &child in node.children.iter().flatten() {
            let field = format!("nodes[{i}].children");
            get(root, &field, child, "node")?;
            if parents[child.value()].replace(i).is_some() {
                return Err(ToyProblem::TwoParents { node: child.value() }.at(field));
            }
        }
    }
    Ok(parents)
}

/// Orders the nodes so that each follows its parent; fails if one is its own ancestor.
fn parents_first(parents: &[Option<usize>]) -> Result<Vec<usize>, Flaw> {
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); parents.len()];
    let mut order = Vec::with_capacity(parents.len());
    for (node, parent) in parents.iter().enumerate() {
        match parent {
            Some(parent) => children[*parent].push(node),
            None => order.push(node),
        }
    }
    let mut done = 0;
    while let Some(&node) = order.get(done) {
        order.append(&mut children[node]);
        done += 1;
    }
    // Each node has at most one parent, so the remaining ones are in cycles, and their lists are
    // not empty.
    match children.iter().position(|left| !left.is_empty()) {
        Some(node) => Err(ToyProblem::Cycle { node }.at(format!("nodes[{node}].children"))),
        None => Ok(order),
    }
}

fn append_weights(root: &Root, node: &json::Node, field: &str, all: &mut Vec<f64>) -> Result<(), Flaw> {
    let Some(mesh) = node.mesh else { return Ok(()) };
    let mesh = get(root, field, mesh, "mesh")?;
    let n_targets = n_morph_targets(mesh);
    let n_weights = check_limit(
        "morph weights",
        all.len().saturating_add(n_targets),
        MAX_MORPH_WEIGHTS,
        field,
    )?;
    if let Some(weights) = node.weights.as_ref().or(mesh.weights.as_ref()) {
        let field = format!("{field}.weights");
        check_count("weights", weights.len(), n_targets, &field)?;
        check_range(&field, weights, 1, &NUMBER)?;
        all.extend(weights.iter().copied().map(f64::from));
    }
    all.resize(n_weights, 0.0);
    Ok(())
}

/// Number of a mesh's morph targets, by its first primitive; the others must have the same number.
pub(super) fn n_morph_targets(mesh: &Mesh) -> usize {
    mesh.primitives
        .first()
        .and_then(|primitive| primitive.targets.as_ref())
        .map_or(0, Vec::len)
}

fn local(node: &json::Node, field: &str, warnings: &mut Vec<ToyWarning>) -> Result<Local, Flaw> {
    if let Some(matrix) = &node.matrix {
        return affine(matrix, &format!("{field}.matrix"), 0).map(Local::Matrix);
    }
    let vector = |name: &str, written: Option<[f32; 3]>, default: [f32; 3]| {
        let value = written.unwrap_or(default);
        check_range(&format!("{field}.{name}"), &value, 3, &NUMBER)?;
        Ok(DVec3::from_array(value.map(f64::from)))
    };
    let field_of_rotation = format!("{field}.rotation");
    let rotation = node.rotation.unwrap_or_default().0;
    check_finite(&field_of_rotation, &rotation, 4)?;
    let rotation = unit_rotation(rotation.map(f64::from)).unwrap_or_else(|| {
        let field = field_of_rotation;
        warnings.push(ToyWarning::RotationsRepaired { field, n: 1 });
        DQuat::IDENTITY
    });
    Ok(Local::Decomposed(Trs {
        translation: vector("translation", node.translation, [0.0; 3])?,
        rotation,
        scale: vector("scale", node.scale, [1.0; 3])?,
    }))
}

/// The rotation of a quaternion (x, y, z, w) of any length but zero.
pub(super) fn unit_rotation(xyzw: [f64; 4]) -> Option<DQuat> {
    let rotation = DQuat::from_array(xyzw);
    let length = rotation.length();
    (length > 0.0).then(|| rotation / length)
}

/// Reads a column-major 4 x 4 matrix. `element` names it in the error.
pub(super) fn affine(columns: &[f32; 16], field: &str, element: usize) -> Result<DAffine3, Flaw> {
    // Exporters that invert numerically leave rounding errors in the last row.
    const TOLERANCE: f32 = 1e-4;
    check_range(field, columns, 16, &NUMBER)?;
    let [a, b, c, d] = [0, 4, 8, 12].map(|i| [columns[i], columns[i + 1], columns[i + 2], columns[i + 3]]);
    let last_row = [a[3], b[3], c[3], d[3] - 1.0];
    if last_row.iter().any(|value| value.abs() > TOLERANCE) {
        return Err(ToyProblem::NotAffine { element }.at(field));
    }
    let column = |c: [f32; 4]| DVec3::new(c[0].into(), c[1].into(), c[2].into());
    let matrix3 = DMat3::from_cols(column(a), column(b), column(c));
    Ok(DAffine3 {
        matrix3,
        translation: column(d),
    })
}
