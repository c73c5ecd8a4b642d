//! Animation clips: animated values of nodes, and durations.

use gltf::json::accessor::Type;
use gltf::json::animation::{
    Animation, Channel as JsonChannel, Interpolation as JsonInterpolation, Property,
};

use super::accessor::Source;
use super::check::check_count;
use super::container::{allowed, get};
use super::error::{Flaw, ToyProblem, ToyWarning};
use super::graph::{Graph, Local};
use super::limits::{KEY_SECS, NUMBER};
use super::track::{Interpolation, Track};

/// Index of a clip within its toy, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ClipId(pub(super) usize);

impl ClipId {
    /// Index of the clip in [`Toy::clips`](super::Toy::clips), from 0.
    pub fn index(self) -> usize {
        self.0
    }
}

/// One animation of the file.
pub struct Clip {
    /// Name as authored, which need not be unique.
    pub name: Option<String>,
    /// Time of the last key; 0 or more.
    pub duration_secs: f64,
    pub(super) channels: Vec<Channel>,
}

/// One moving value of one node.
pub(super) struct Channel {
    pub(super) node: usize,
    pub(super) property: Property,
    pub(super) track: Track,
}

pub(super) fn read(
    source: &Source,
    graph: &Graph,
    warnings: &mut Vec<ToyWarning>,
) -> Result<Vec<Clip>, Flaw> {
    let mut clips = Vec::with_capacity(source.root.animations.len());
    for (i, animation) in source.root.animations.iter().enumerate() {
        let mut channels = Vec::with_capacity(animation.channels.len());
        for (j, channel) in animation.channels.iter().enumerate() {
            let field = format!("animations[{i}].channels[{j}]");
            let node = channel.target.node;
            get(source.root, &field, node, "node")?;
            let property = allowed(channel.target.path, &format!("{field}.target.path"))?;
            let Some(width) = width(graph, node.value(), property, &field)? else {
                warnings.push(ToyWarning::ChannelIgnored { field });
                continue;
            };
            let track = read_track(source, animation, channel, &format!("animations[{i}]"), width)?;
            if property == Property::Rotation
                && let Some(element) = track.zero_rotation()
            {
                return Err(ToyProblem::ZeroRotation { element }.at(field));
            }
            channels.push(Channel {
                node: node.value(),
                property,
                track,
            });
        }
        let duration_secs = channels
            .iter()
            .map(|channel| channel.track.end_secs())
            .fold(0.0, f64::max);
        clips.push(Clip {
            name: animation.name.clone(),
            duration_secs,
            channels,
        });
    }
    Ok(clips)
}

/// Numbers of one value; `None` where the channel has nothing to move.
fn width(graph: &Graph, node: usize, property: Property, field: &str) -> Result<Option<usize>, Flaw> {
    let target = &graph.nodes[node];
    let is_matrix = matches!(target.rest, Local::Matrix(_));
    match property {
        Property::MorphTargetWeights => {
            Ok((!target.morph_weights.is_empty()).then_some(target.morph_weights.len()))
        }
        _ if is_matrix => Err(ToyProblem::AnimatedMatrix { node }.at(field)),
        Property::Rotation => Ok(Some(4)),
        Property::Translation | Property::Scale => Ok(Some(3)),
    }
}

fn read_track(
    source: &Source,
    animation: &Animation,
    channel: &JsonChannel,
    field: &str,
    width: usize,
) -> Result<Track, Flaw> {
    let (index, n) = (channel.sampler.value(), animation.samplers.len());
    let sampler = animation.samplers.get(index).ok_or_else(|| {
        ToyProblem::NoSuch {
            what: "sampler",
            index,
            n,
        }
        .at(format!("{field}.channels"))
    })?;
    let field = format!("{field}.samplers[{index}]");
    let interpolation = match allowed(sampler.interpolation, &format!("{field}.interpolation"))? {
        JsonInterpolation::Step => Interpolation::Step,
        JsonInterpolation::Linear => Interpolation::Linear,
        JsonInterpolation::CubicSpline => Interpolation::Cubic,
    };
    let times_secs = read_times(source, &format!("{field}.input"), sampler.input)?;
    let shape = match allowed(channel.target.path, &field)? {
        Property::Translation | Property::Scale => Type::Vec3,
        Property::Rotation => Type::Vec4,
        Property::MorphTargetWeights => Type::Scalar,
    };
    let output = format!("{field}.output");
    let values = match shape {
        // Of any length, which is taken out in 64 bits.
        Type::Vec4 => source.floats(&output, sampler.output, shape)?,
        _ => source.floats_within(&output, sampler.output, shape, &NUMBER)?,
    };
    let expected = times_secs
        .len()
        .saturating_mul(interpolation.values_per_key())
        .saturating_mul(width);
    check_count("numbers", values.len(), expected, &output)?;
    Ok(Track {
        times_secs,
        values,
        width,
        interpolation,
    })
}

fn read_times(
    source: &Source,
    field: &str,
    input: gltf::json::Index<gltf::json::Accessor>,
) -> Result<Vec<f64>, Flaw> {
    let times = source.floats_within(field, input, Type::Scalar, &KEY_SECS)?;
    if times.is_empty() {
        return Err(ToyProblem::Count {
            what: "keys",
            found: 0,
            expected: 1,
        }
        .at(field));
    }
    if let Some(i) = times.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(ToyProblem::KeyOrder { key: i + 1 }.at(field));
    }
    Ok(times.into_iter().map(f64::from).collect())
}
