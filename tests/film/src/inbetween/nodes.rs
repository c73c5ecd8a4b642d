//! Poses of prints that are in no clip: node by node, by their names.

use std::collections::BTreeMap;
use std::sync::Arc;

use app_core::scene::Pose;
use app_core::toy::{NodePose, Toy, ToyError, Trs};
use glam::{DQuat, DVec3};
use serde::Deserialize;

/// Transforms of nodes by name; other nodes stay as authored.
pub(super) type NodeRecords = BTreeMap<String, NodeRecord>;

/// Transform from a node to its parent; missing parts stay as authored.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NodeRecord {
    translation: Option<[f64; 3]>,
    /// x, y, z, w of a quaternion, of any length but zero.
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// The pose with these nodes.
///
/// # Errors
/// When the toy has no node of a name.
pub(super) fn pose(toy: &Toy, records: &NodeRecords) -> Result<Pose, ToyError> {
    let node = |(name, record): (&String, &NodeRecord)| {
        let id = toy.find_node(name)?;
        let authored = toy.authored_transform(id)?.unwrap_or(Trs {
            translation: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            scale: DVec3::ONE,
        });
        let set = Trs {
            translation: record.translation.map_or(authored.translation, DVec3::from_array),
            rotation: record.rotation.map_or(authored.rotation, DQuat::from_array),
            scale: record.scale.map_or(authored.scale, DVec3::from_array),
        };
        Ok((id, set))
    };
    let nodes = records.iter().map(node).collect::<Result<Vec<_>, ToyError>>()?;
    let pose = Pose::Nodes(Arc::new(NodePose {
        parent_from_node: nodes,
        ..NodePose::default()
    }));
    // An impossible pose is refused here, where the key is known.
    toy.bounds_of_pose(&pose)?;
    Ok(pose)
}
