//! The rig: nodes, skins and clips, and their transforms at one moment.

use glam::{DAffine3, DVec3};
use gltf::json::animation::Property;

use super::clip::Clip;
use super::graph::{Graph, Local, Trs};
use super::moment::NodePose;
use super::skin::Skin;

pub(super) struct Rig {
    pub(super) graph: Graph,
    pub(super) skins: Vec<Skin>,
    pub(super) clips: Vec<Clip>,
}

/// Source of the nodes' transforms.
pub(super) enum Set<'a> {
    Authored,
    /// A clip at a time.
    Clip(&'a Clip, f64),
    Nodes(&'a NodePose),
}

/// The rig at one moment. `anchor` is the posing space.
pub(super) struct RigPose {
    pub(super) anchor_from_node: Vec<DAffine3>,
    /// For each skin and each joint, the transform of a mesh's vertices.
    pub(super) anchor_from_mesh_by_joint: Vec<Vec<DAffine3>>,
    morph_weights: Vec<f64>,
}

impl Rig {
    /// Poses the rig.
    pub(super) fn pose(&self, set: &Set<'_>, anchor_from_object: DAffine3) -> RigPose {
        let (locals, morph_weights) = self.locals(set);
        self.posed(&locals, morph_weights, anchor_from_object)
    }

    /// Each node's transform to its parent, and the weights of all morph targets.
    pub(super) fn locals(&self, set: &Set<'_>) -> (Vec<Local>, Vec<f64>) {
        let mut locals: Vec<Local> = self.graph.nodes.iter().map(|node| node.rest).collect();
        let mut morph_weights = self.graph.rest_weights.clone();
        match *set {
            Set::Authored => {}
            Set::Clip(clip, time_secs) => self.apply_clip(clip, time_secs, &mut locals, &mut morph_weights),
            Set::Nodes(pose) => self.apply_nodes(pose, &mut locals, &mut morph_weights),
        }
        (locals, morph_weights)
    }

    fn posed(&self, locals: &[Local], morph_weights: Vec<f64>, anchor_from_object: DAffine3) -> RigPose {
        let mut anchor_from_node = vec![DAffine3::IDENTITY; locals.len()];
        for &node in &self.graph.parents_first {
            let parent = self.graph.nodes[node].parent;
            let anchor_from_parent = parent.map_or(anchor_from_object, |parent| anchor_from_node[parent]);
            anchor_from_node[node] = anchor_from_parent * locals[node].parent_from_node();
        }
        let by_joint = |skin: &Skin| {
            let joints = skin.joints.iter().zip(&skin.joint_from_mesh);
            joints
                .map(|(&joint, &joint_from_mesh)| anchor_from_node[joint] * joint_from_mesh)
                .collect()
        };
        let anchor_from_mesh_by_joint = self.skins.iter().map(by_joint).collect();
        RigPose {
            anchor_from_node,
            anchor_from_mesh_by_joint,
            morph_weights,
        }
    }

    /// The morph weights of a node's mesh, one for each target.
    pub(super) fn morph_weights<'p>(&self, pose: &'p RigPose, node: usize) -> &'p [f64] {
        &pose.morph_weights[self.graph.nodes[node].morph_weights.clone()]
    }

    /// The caller has checked `pose`.
    fn apply_nodes(&self, pose: &NodePose, locals: &mut [Local], morph_weights: &mut [f64]) {
        for (node, trs) in &pose.parent_from_node {
            locals[node.0] = Local::Decomposed(Trs {
                rotation: trs.rotation.normalize(),
                ..*trs
            });
        }
        for (node, weights) in &pose.morph_weights {
            morph_weights[self.graph.nodes[node.0].morph_weights.clone()].copy_from_slice(weights);
        }
    }

    fn apply_clip(&self, clip: &Clip, time_secs: f64, locals: &mut [Local], morph_weights: &mut [f64]) {
        for channel in &clip.channels {
            let track = &channel.track;
            let sampled = || {
                let mut xyz = [0.0; 3];
                track.sample(time_secs, &mut xyz);
                DVec3::from_array(xyz)
            };
            match (channel.property, &mut locals[channel.node]) {
                (Property::MorphTargetWeights, _) => {
                    let weights = self.graph.nodes[channel.node].morph_weights.clone();
                    track.sample(time_secs, &mut morph_weights[weights]);
                }
                (Property::Translation, Local::Decomposed(Trs { translation, .. })) => {
                    *translation = sampled()
                }
                (Property::Scale, Local::Decomposed(Trs { scale, .. })) => *scale = sampled(),
                (Property::Rotation, Local::Decomposed(Trs { rotation, .. })) => {
                    *rotation = track.sample_rotation(time_secs);
                }
                // Refused when the clip is read.
                (_, Local::Matrix(_)) => {}
            }
        }
    }
}
