//! Interpolation of two poses, node by node.

use std::sync::Arc;

use super::Toy;
use super::error::ToyError;
use super::graph::{Local, Trs};
use super::moment::{NodeId, NodePose, Pose};

impl Toy {
    /// The interpolated pose by its nodes: `a` at a share of 0, `b` at 1. Rotations take the
    /// shorter way at constant speed; all else is linear. A node that was authored as a matrix
    /// stays as it is.
    ///
    /// # Errors
    /// When either pose is none of this toy's.
    pub fn blended(&self, a: &Pose, b: &Pose, share: f64) -> Result<Pose, ToyError> {
        let [(from, from_weights), (to, to_weights)] = [self.locals(a)?, self.locals(b)?];
        let pairs = from.iter().zip(&to).enumerate();
        let parent_from_node = pairs.filter_map(|(node, pair)| match pair {
            (Local::Decomposed(a), Local::Decomposed(b)) => Some((NodeId(node), between(a, b, share))),
            _ => None,
        });
        let weights: Vec<f64> = from_weights
            .iter()
            .zip(&to_weights)
            .map(|(a, b)| a + share * (b - a))
            .collect();
        let morphed = self.rig.graph.nodes.iter().enumerate();
        let morph_weights = morphed
            .filter(|(_, node)| !node.morph_weights.is_empty())
            .map(|(index, node)| (NodeId(index), weights[node.morph_weights.clone()].to_vec()));
        Ok(Pose::Nodes(Arc::new(NodePose {
            parent_from_node: parent_from_node.collect(),
            morph_weights: morph_weights.collect(),
        })))
    }
}

fn between(a: &Trs, b: &Trs, share: f64) -> Trs {
    Trs {
        translation: a.translation.lerp(b.translation, share),
        rotation: a.rotation.slerp(b.rotation, share),
        scale: a.scale.lerp(b.scale, share),
    }
}
