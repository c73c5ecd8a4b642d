//! Parts that a clip mirrors: a scale that passes through zero, as in puppets that turn around.

use std::collections::BTreeSet;

use glam::DAffine3;
use gltf::json::animation::Property;

use super::clip::{Channel, Clip};
use super::geometry::Geometry;
use super::rig::{Rig, Set};
use super::surface::{Surface, is_mirrored, n_transforms};
use super::warning::ToyWarning;

/// Largest number of checked moments of a clip.
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
        for time_secs in moments(clip) {
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
    for channel in clip
        .channels
        .iter()
        .filter(|channel| channel.property == Property::Scale)
    {
        below[channel.node] |= has_flip(rig, channel);
    }
    for &node in &rig.graph.parents_first {
        let parent = rig.graph.nodes[node].parent;
        below[node] |= parent.is_some_and(|parent| below[parent]);
    }
    below
}

fn has_flip(rig: &Rig, channel: &Channel) -> bool {
    let rest = rig.graph.nodes[channel.node].rest.decomposed();
    let rest = rest.map_or([1.0; 3], |trs| trs.scale.to_array());
    let keys = channel.track.values.as_chunks::<3>().0.iter();
    keys.flat_map(|key| key.iter().zip(rest))
        .any(|(value, rest)| f64::from(*value) * rest < 0.0)
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

/// Times of its keys of scale, and between them; a selection if there are many.
fn moments(clip: &Clip) -> Vec<f64> {
    let scales = clip
        .channels
        .iter()
        .filter(|channel| channel.property == Property::Scale);
    let mut times: Vec<f64> = scales
        .flat_map(|channel| channel.track.times_secs.iter().copied())
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let middles = times.windows(2).map(|pair| f64::midpoint(pair[0], pair[1]));
    let all: Vec<f64> = times.iter().copied().chain(middles).collect();
    let step = all.len().div_ceil(MAX_MOMENTS).max(1);
    all.into_iter().step_by(step).collect()
}
