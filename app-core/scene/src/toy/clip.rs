//! Animation clips: animated values of nodes, and durations.

use std::collections::HashMap;

use gltf::json::accessor::Type;
use gltf::json::animation::{
    Animation, Channel as JsonChannel, Interpolation as JsonInterpolation, Property,
};

use super::accessor::Source;
use super::check::check_count;
use super::container::{allowed, get};
use super::error::{Flaw, ToyProblem};
use super::graph::{Graph, Local};
use super::limits::{KEY_SECS, NUMBER};
use super::track::{Interpolation, Track};
use super::warning::ToyWarning;

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
    /// The reason why it cannot be read, if so.
    pub(super) flaw: Option<String>,
    pub(super) channels: Vec<Channel>,
}

/// An animated property of a node.
pub(super) struct Channel {
    pub(super) node: usize,
    pub(super) property: Property,
    pub(super) track: Track,
}

/// Reads all clips; for unreadable ones, only the reason is kept. Matrices of animated nodes are
/// decomposed in `graph`.
pub(super) fn read(
    source: &Source,
    graph: &mut Graph,
    broken: &HashMap<usize, String>,
    warnings: &mut Vec<ToyWarning>,
) -> Vec<Clip> {
    let mut clips: Vec<Clip> = Vec::with_capacity(source.root.animations.len());
    for (i, animation) in source.root.animations.iter().enumerate() {
        let mut said = Vec::new();
        let read = match broken.get(&i) {
            Some(reason) => Err((format!("animations[{i}]"), reason.clone())),
            None => read_channels(source, graph, animation, (i, &mut said)).map_err(|flaw| flaw.parts()),
        };
        let (channels, flaw) = match read {
            Ok(channels) => (channels, None),
            Err((field, reason)) => {
                let flaw = format!("{field}: {reason}");
                said = vec![ToyWarning::ClipIgnored { field, reason }];
                (Vec::new(), Some(flaw))
            }
        };
        warnings.append(&mut said);
        let ends_secs = channels.iter().map(|channel| channel.track.end_secs());
        let clip = Clip {
            name: animation.name.clone(),
            duration_secs: ends_secs.fold(0.0, f64::max),
            flaw,
            channels,
        };
        let alike = |other: &Clip| clip.name.is_some() && other.name == clip.name;
        if let (Some(first), Some(name)) = (clips.iter().position(alike), &clip.name) {
            let (name, second) = (name.clone(), i);
            warnings.push(ToyWarning::ClipsAlike { name, first, second });
        }
        clips.push(clip);
    }
    clips
}

fn read_channels(
    source: &Source,
    graph: &mut Graph,
    animation: &Animation,
    (i, warnings): (usize, &mut Vec<ToyWarning>),
) -> Result<Vec<Channel>, Flaw> {
    let mut channels = Vec::with_capacity(animation.channels.len());
    for (j, channel) in animation.channels.iter().enumerate() {
        let field = format!("animations[{i}].channels[{j}]");
        let node = channel.target.node;
        get(source.root, &field, node, "node")?;
        let property = allowed(channel.target.path, &format!("{field}.target.path"))?;
        let Some(width) = width(graph, node.value(), property) else {
            warnings.push(ToyWarning::ChannelIgnored { field });
            continue;
        };
        if property != Property::MorphTargetWeights {
            take_apart(graph, node.value(), &field, warnings)?;
        }
        let mut track = read_track(source, animation, channel, &format!("animations[{i}]"), width)?;
        if property == Property::Rotation {
            let n = track.repair_rotations();
            if n > 0 {
                warnings.push(ToyWarning::RotationsRepaired { field, n });
            }
        }
        channels.push(Channel {
            node: node.value(),
            property,
            track,
        });
    }
    Ok(channels)
}

/// Number of components of a value; `None` if the channel animates nothing.
fn width(graph: &Graph, node: usize, property: Property) -> Option<usize> {
    match property {
        Property::MorphTargetWeights => {
            let n_weights = graph.nodes[node].morph_weights.len();
            (n_weights > 0).then_some(n_weights)
        }
        Property::Rotation => Some(4),
        Property::Translation | Property::Scale => Some(3),
    }
}

/// Decomposes the matrix of a node whose parts are animated.
fn take_apart(
    graph: &mut Graph,
    node: usize,
    field: &str,
    warnings: &mut Vec<ToyWarning>,
) -> Result<(), Flaw> {
    let rest = &mut graph.nodes[node].rest;
    if matches!(rest, Local::Matrix(_)) {
        let trs = rest
            .taken_apart()
            .ok_or_else(|| ToyProblem::AnimatedMatrix { node }.at(field))?;
        *rest = Local::Decomposed(trs);
        let field = field.to_owned();
        warnings.push(ToyWarning::MatrixDecomposed { field });
    }
    Ok(())
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
        // Quaternions of any length, normalised in 64 bits.
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
