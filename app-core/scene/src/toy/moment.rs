//! Poses of a toy: as authored, at a moment of a clip, or by the transforms of its nodes.

use std::sync::Arc;

use super::Toy;
use super::clip::ClipId;
use super::error::ToyError;
use super::graph::Trs;

/// A pose of a toy.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Pose {
    /// The nodes as they were authored.
    #[default]
    Authored,
    /// A moment of an animation clip.
    Clip {
        /// The clip.
        clip: ClipId,
        /// Time within it; a time beyond its end means its end.
        time_secs: f64,
    },
    /// The nodes as set by the caller, for example from physics or an app's own rig.
    Nodes(Arc<NodePose>),
}

/// Index of a node within its toy, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub(super) usize);

/// Transforms of nodes, joints among them, and weights of morph targets; other nodes stay as
/// authored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodePose {
    /// Transforms from nodes to their parents.
    pub parent_from_node: Vec<(NodeId, Trs)>,
    /// Weights, one for each morph target of the node's mesh.
    pub morph_weights: Vec<(NodeId, Vec<f64>)>,
}

impl Pose {
    /// The clip, if it is a moment of one.
    #[must_use]
    pub fn clip(&self) -> Option<ClipId> {
        match self {
            Self::Clip { clip, .. } => Some(*clip),
            Self::Authored | Self::Nodes(_) => None,
        }
    }
}

impl Toy {
    /// Finds a node by its authored name, the first of several.
    ///
    /// # Errors
    /// [`ToyError::UnknownNode`], which lists the existing names.
    pub fn find_node(&self, name: &str) -> Result<NodeId, ToyError> {
        let names = &self.rig.graph.names;
        let found = names.iter().position(|one| one.as_deref() == Some(name));
        found.map(NodeId).ok_or_else(|| ToyError::UnknownNode {
            file: self.file.clone(),
            name: name.to_owned(),
            known: names.iter().flatten().cloned().collect(),
        })
    }

    /// The authored transform of a node; `None` if that is a matrix.
    ///
    /// # Errors
    /// A node of another toy.
    pub fn authored_transform(&self, node: NodeId) -> Result<Option<Trs>, ToyError> {
        Ok(self.node(node)?.rest.decomposed())
    }
}
