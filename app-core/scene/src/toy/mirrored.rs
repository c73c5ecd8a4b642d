//! Parts that a clip turns inside out: a scale that goes through zero, as in puppets that turn round.

use std::collections::BTreeSet;

use glam::DAffine3;
use gltf::json::animation::Property;

use super::clip::Clip;
use super::geometry::Geometry;
use super::rig::{Rig, Set};
use super::surface::{Surface, is_mirrored};
use super::warning::ToyWarning;

/// Moments of a clip that are looked at.
const MAX_MOMENTS: usize = 64;

/// For each surface, whether any clip mirrors it against how it is at rest.
pub(super) fn by_clips(
    rig: &Rig,
    geometries: &[Geometry],
    surfaces: &[Surface],
    warnings: &mut Vec<ToyWarning>,
) -> Vec<bool> {
    let mut found = vec![false; surfaces.len()];
    for clip in rig.clips.iter().filter(|clip| has_flip(rig, clip)) {
        for time_secs in moments(clip) {
            let pose = rig.pose(&Set::Clip(clip, time_secs), DAffine3::IDENTITY);
            for (surface, found) in surfaces.iter().zip(&mut found).filter(|(_, found)| !**found) {
                *found = is_mirrored(surface, &geometries[surface.geometry], &pose) != surface.is_mirrored;
            }
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
    found
}

/// Whether a clip gives a scale another sign than it has at rest.
fn has_flip(rig: &Rig, clip: &Clip) -> bool {
    let scales = clip
        .channels
        .iter()
        .filter(|channel| channel.property == Property::Scale);
    scales.into_iter().any(|channel| {
        let rest = rig.graph.nodes[channel.node].rest.decomposed();
        let rest = rest.map_or([1.0; 3], |trs| trs.scale.to_array());
        let keys = channel.track.values.as_chunks::<3>().0.iter();
        keys.flat_map(|key| key.iter().zip(rest))
            .any(|(value, rest)| f64::from(*value) * rest < 0.0)
    })
}

/// Times of its keys of scale, and between them; not all of many.
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
