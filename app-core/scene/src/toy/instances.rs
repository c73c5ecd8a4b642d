//! Instances of a mesh at one node: each becomes a node below it.
//!
//! Source: the glTF extension `EXT_mesh_gpu_instancing`.

use gltf::json::accessor::Type;
use gltf::json::scene::UnitQuaternion;
use gltf::json::{Index, Node, Root};

use super::accessor::Source;
use super::check::{check_count, check_limit};
use super::container::Container;
use super::error::Flaw;
use super::limits::{MAX_NODES, NUMBER};
use super::mend::Instances;

/// Transforms of instances to their node; each list is complete or absent.
struct Copies {
    n: usize,
    translations: Option<Vec<f32>>,
    rotations: Option<Vec<f32>>,
    scales: Option<Vec<f32>>,
}

/// Adds the nodes.
pub(super) fn expand(container: &mut Container) -> Result<(), Flaw> {
    for instances in std::mem::take(&mut container.extras.instances) {
        let copies = read(&Source::new(container), &instances)?;
        add(&mut container.root, instances.node, &copies)?;
    }
    Ok(())
}

fn read(source: &Source, instances: &Instances) -> Result<Copies, Flaw> {
    let field = |name: &str| {
        let node = instances.node;
        format!("nodes[{node}].extensions.EXT_mesh_gpu_instancing.attributes.{name}")
    };
    let floats = |name: &str, accessor: Option<u32>, shape| {
        accessor
            .map(|accessor| source.floats_within(&field(name), Index::new(accessor), shape, &NUMBER))
            .transpose()
    };
    let translations = floats("TRANSLATION", instances.translation, Type::Vec3)?;
    let rotations = floats("ROTATION", instances.rotation, Type::Vec4)?;
    let scales = floats("SCALE", instances.scale, Type::Vec3)?;
    let found = [
        ("TRANSLATION", translations.as_ref().map(|all| all.len() / 3)),
        ("ROTATION", rotations.as_ref().map(|all| all.len() / 4)),
        ("SCALE", scales.as_ref().map(|all| all.len() / 3)),
    ];
    let n = found.iter().find_map(|(_, n)| *n).unwrap_or(1);
    for (name, found) in found {
        check_count("copies", found.unwrap_or(n), n, &field(name))?;
    }
    Ok(Copies {
        n,
        translations,
        rotations,
        scales,
    })
}

fn add(root: &mut Root, node: usize, copies: &Copies) -> Result<(), Flaw> {
    let first = root.nodes.len();
    check_limit("nodes", first.saturating_add(copies.n), MAX_NODES, "nodes")?;
    let Some(parent) = root.nodes.get_mut(node) else {
        return Ok(());
    };
    let (mesh, weights) = (parent.mesh.take(), parent.weights.take());
    // Instances follow their node; glTF has no skinned ones.
    parent.skin = None;
    let indices = (0..copies.n).filter_map(|i| u32::try_from(first + i).ok());
    parent
        .children
        .get_or_insert_default()
        .extend(indices.map(Index::new));
    let triple = |all: &Option<Vec<f32>>, i: usize| all.as_ref()?.as_chunks::<3>().0.get(i).copied();
    let quaternion = |i: usize| copies.rotations.as_ref()?.as_chunks::<4>().0.get(i).copied();
    root.nodes.extend((0..copies.n).map(|i| Node {
        mesh,
        weights: weights.clone(),
        translation: triple(&copies.translations, i),
        rotation: quaternion(i).map(UnitQuaternion),
        scale: triple(&copies.scales, i),
        ..Node::default()
    }));
    Ok(())
}
