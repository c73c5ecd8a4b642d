//! Parts that a clip mirrors: a scale that passes through zero, as in puppets that turn around.

use std::collections::BTreeSet;

use glam::DAffine3;
use gltf::json::animation::Property;

use super::clip::{Channel, Clip};
use super::geometry::Geometry;
use super::rig::{Rig, Set};
use super::surface::{Surface, is_mirrored, n_transforms};
use super::warning::ToyWarning;

/// Largest number of checked moments of a clip, beside those at which a scale changes its sign.
const MAX_MOMENTS: usize = 64;

/// Largest number of checked transforms in all clips together: some seconds' work.
const MAX_TRANSFORMS: usize = 16 << 20;

/// For each surface, whether any clip mirrors it relative to its rest pose, or may do so if there
/// is too much to check.
pub(super) fn by_clips(
    rig: &Rig,
    geometries: &[Geometry],
    surfaces: &[Surface],
    warnings: &mut Vec<ToyWarning>,
) -> Vec<bool> {
    let mut found = vec![false; surfaces.len()];
    let mut unknown = vec![false; surfaces.len()];
    let mut n_left = MAX_TRANSFORMS;
    for (index, clip) in rig.clips.iter().enumerate() {
        let mut open = moved_by_flips(rig, clip, surfaces);
        open.retain(|&place| !found[place]);
        for time_secs in moments(rig, clip) {
            if open.is_empty() {
                break;
            }
            let of_surfaces = open
                .iter()
                .map(|&place| n_transforms(&surfaces[place], &geometries[surfaces[place].geometry]));
            let n = rig.graph.nodes.len() + of_surfaces.sum::<usize>();
            if n > n_left {
                open.iter().for_each(|&place| unknown[place] = true);
                warnings.push(ToyWarning::MirroredUnknown {
                    field: format!("animations[{index}]"),
                });
                break;
            }
            n_left -= n;
            let pose = rig.pose(&Set::Clip(clip, time_secs), DAffine3::IDENTITY);
            open.retain(|&place| {
                let surface = &surfaces[place];
                found[place] =
                    is_mirrored(surface, &geometries[surface.geometry], &pose) != surface.is_mirrored;
                !found[place]
            });
        }
    }
    let all = surfaces.iter().zip(&found);
    let nodes: BTreeSet<usize> = all
        .filter(|(_, found)| **found)
        .map(|(surface, _)| surface.node)
        .collect();
    warnings.extend(nodes.into_iter().map(|node| ToyWarning::Mirrored {
        field: format!("nodes[{node}]"),
    }));
    let both = found.into_iter().zip(unknown);
    both.map(|(found, unknown)| found || unknown).collect()
}

/// For each node, whether a clip gives it or an ancestor a scale of another sign than at rest.
fn below_flips(rig: &Rig, clip: &Clip) -> Vec<bool> {
    let mut below = vec![false; rig.graph.nodes.len()];
    for channel in scales(clip) {
        below[channel.node] |= has_flip(rig, channel);
    }
    for &node in &rig.graph.parents_first {
        let parent = rig.graph.nodes[node].parent;
        below[node] |= parent.is_some_and(|parent| below[parent]);
    }
    below
}

/// The channels of scales.
fn scales(clip: &Clip) -> impl Iterator<Item = &Channel> {
    let channels = clip.channels.iter();
    channels.filter(|channel| channel.property == Property::Scale)
}

fn rest_scale(rig: &Rig, channel: &Channel) -> [f64; 3] {
    let rest = rig.graph.nodes[channel.node].rest.decomposed();
    rest.map_or([1.0; 3], |trs| trs.scale.to_array())
}

fn has_flip(rig: &Rig, channel: &Channel) -> bool {
    let rest = rest_scale(rig, channel);
    let keys = channel.track.values.as_chunks::<3>().0.iter();
    keys.flat_map(|key| key.iter().zip(rest))
        .any(|(value, rest)| f64::from(*value) * rest < 0.0)
}

/// Times of the keys at which a scale has other signs than at the key before, or than at rest for
/// the first key: however short a flip is, one of them is in it.
fn sign_changes(rig: &Rig, channel: &Channel) -> Vec<f64> {
    let rest = rest_scale(rig, channel);
    let mut before = [false; 3];
    let mut changes = Vec::new();
    for &time_secs in &channel.track.times_secs {
        let mut scale = [0.0; 3];
        channel.track.sample(time_secs, &mut scale);
        let now = [0, 1, 2].map(|axis| scale[axis] * rest[axis] < 0.0);
        if now != before {
            changes.push(time_secs);
        }
        before = now;
    }
    changes
}

/// Surfaces below such a node, or with a joint there.
fn moved_by_flips(rig: &Rig, clip: &Clip, surfaces: &[Surface]) -> Vec<usize> {
    let nodes = below_flips(rig, clip);
    let skins = rig.skins.iter();
    let skins: Vec<bool> = skins
        .map(|skin| skin.joints.iter().any(|&joint| nodes[joint]))
        .collect();
    let is_moved = |surface: &Surface| nodes[surface.node] || surface.skin.is_some_and(|skin| skins[skin]);
    let all = surfaces.iter().enumerate();
    all.filter_map(|(place, surface)| is_moved(surface).then_some(place))
        .collect()
}

/// Times at which scales change their signs, then those of all keys of scale and between them; of
/// the latter a selection if there are many.
fn moments(rig: &Rig, clip: &Clip) -> Vec<f64> {
    let in_order = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    };
    let mut moments = in_order(
        scales(clip)
            .flat_map(|channel| sign_changes(rig, channel))
            .collect(),
    );
    let keys = scales(clip).flat_map(|channel| channel.track.times_secs.iter().copied());
    let keys = in_order(keys.collect());
    let middles = keys.windows(2).map(|pair| f64::midpoint(pair[0], pair[1]));
    let all: Vec<f64> = keys.iter().copied().chain(middles).collect();
    let step = all.len().div_ceil(MAX_MOMENTS).max(1);
    moments.extend(all.into_iter().step_by(step));
    moments
}
