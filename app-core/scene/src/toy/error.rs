//! Errors of a toy's file: always the file, the field and the reason.

use std::fmt;

use thiserror::Error;

use crate::words::{Listed, Number, Text};

/// A toy that cannot be used, or a request that it cannot meet.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ToyError {
    /// The file is not a glTF that can be posed.
    #[error("{file}: {field}: {problem}")]
    Malformed {
        /// The file as named by the caller.
        file: String,
        /// Path of the field in the glTF, as in `meshes[0].primitives[1].attributes.POSITION`.
        field: String,
        /// What is wrong with it.
        problem: ToyProblem,
    },
    /// No clip has this name.
    #[error("{file}: clip: none is called {:?}; it has {}", Text(name).to_string(), Names(known))]
    UnknownClip {
        /// The file as named by the caller.
        file: String,
        /// The name asked for.
        name: String,
        /// Every name that would have been found.
        known: Vec<String>,
    },
    /// A [`ClipId`](super::ClipId) of another toy.
    #[error("{file}: clip: number {clip} is asked for, but it has {n_clips} clips")]
    ForeignClip {
        /// The file as named by the caller.
        file: String,
        /// The number asked for.
        clip: usize,
        /// Number of clips, counted from 0.
        n_clips: usize,
    },
    /// No node has this name.
    #[error("{file}: node: none is called {:?}; it has {}", Text(name).to_string(), Names(known))]
    UnknownNode {
        /// The file as named by the caller.
        file: String,
        /// The name asked for.
        name: String,
        /// Every name that would have been found.
        known: Vec<String>,
    },
    /// A [`NodeId`](super::NodeId) of another toy.
    #[error("{file}: node: number {node} is asked for, but it has {n_nodes} nodes")]
    ForeignNode {
        /// The file as named by the caller.
        file: String,
        /// The number asked for.
        node: usize,
        /// Number of nodes, counted from 0.
        n_nodes: usize,
    },
    /// A clip that the file has, but that cannot be read.
    #[error("{file}: clip {:?}: cannot be read: {reason}", Text(name).to_string())]
    BrokenClip {
        /// The file as named by the caller.
        file: String,
        /// The name asked for.
        name: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A transform or a weight that no pose can be made of.
    #[error("{file}: pose: node {node}: {reason}")]
    NodePose {
        /// The file as named by the caller.
        file: String,
        /// Number of the node.
        node: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A time before the clip, or none at all.
    #[error("{file}: clip time: {} s is not a time from 0 on", Number(*time_secs))]
    Time {
        /// The file as named by the caller.
        file: String,
        /// The time asked for.
        time_secs: f64,
    },
    /// Numbers in range whose product is not.
    #[error("{file}: pose: the position of vertex {vertex} is not from -{max} to {max} along each axis")]
    PoseOverflow {
        /// The file as named by the caller.
        file: String,
        /// First vertex at fault.
        vertex: usize,
        /// Largest coordinate allowed, in units of the space that the toy is posed in.
        max: f64,
    },
}

/// Why a field of a toy's file is refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ToyProblem {
    /// Another kind of file.
    #[error("is {what}, not glTF 2.0: {way_out}")]
    Foreign {
        /// What it is.
        what: &'static str,
        /// What makes a toy of it.
        way_out: &'static str,
    },
    /// Not the JSON that glTF asks for.
    #[error("not glTF: {0}")]
    Json(String),
    /// Not the container that glTF asks for.
    #[error("not binary glTF: {0}")]
    Container(#[source] Box<gltf::Error>),
    /// The length in the header is impossible.
    #[error("the header gives a length of {found} bytes, which is less than itself")]
    HeaderLength {
        /// The length as written.
        found: u32,
    },
    /// A feature without which the file would look or move wrongly.
    #[error("the file requires the extension {name:?}, which is not supported: {way_out}")]
    Extension {
        /// Name of the extension.
        name: String,
        /// How the file is written without it.
        way_out: &'static str,
    },
    /// Data outside the file.
    #[error(
        "refers to data outside the file, which is not there: put the file beside its neighbours, or pack it with \
         `npx @gltf-transform/cli copy IN.gltf OUT.glb`"
    )]
    External,
    /// A file beside the toy's that cannot be read.
    #[error("{name}: {reason}")]
    Neighbour {
        /// Its name, as seen from the toy's file.
        name: String,
        /// What the caller said.
        reason: String,
    },
    /// A data URI that is none.
    #[error("is not a base64 data URI")]
    DataUri,
    /// A stream of meshopt that breaks its format.
    #[error("the compressed data is broken, or shorter or longer than it says")]
    Compressed,
    /// More than is allowed.
    #[error("{found} {what} are more than the {limit} allowed")]
    TooMany {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: u64,
        /// The most there may be.
        limit: u64,
    },
    /// Something that must be there.
    #[error("missing")]
    Missing,
    /// A value that glTF does not define.
    #[error("not a value that glTF allows")]
    NotAllowed,
    /// A reference to something that is not in the file.
    #[error("refers to {what} {index}, but the file has {n}, counted from 0")]
    NoSuch {
        /// What is referred to.
        what: &'static str,
        /// The index as written.
        index: usize,
        /// How many there are.
        n: usize,
    },
    /// An accessor of another shape.
    #[error("is {found}, but {expected} is needed")]
    WrongType {
        /// The shape that fits here.
        expected: String,
        /// The shape as written.
        found: String,
    },
    /// An accessor, a view or an image that reaches beyond its bytes.
    #[error("reaches to byte {end}, but there are {available}")]
    OutOfRange {
        /// One past the last byte asked for.
        end: u64,
        /// Bytes there are.
        available: usize,
    },
    /// Elements that overlap.
    #[error("a stride of {stride} bytes is less than the {element} bytes of an element")]
    Stride {
        /// The stride as written.
        stride: usize,
        /// Size of one element.
        element: usize,
    },
    /// Sparse indices out of order or out of range.
    #[error("sparse index {index} is not above the one before it and below {count}")]
    SparseIndex {
        /// The index as written.
        index: usize,
        /// Elements of the accessor.
        count: usize,
    },
    /// NaN or infinity.
    #[error("{n_bad} of {n} numbers are not finite, the first in element {first}")]
    NotFinite {
        /// How many numbers are at fault.
        n_bad: usize,
        /// How many there are.
        n: usize,
        /// The first element at fault.
        first: usize,
    },
    /// A number too small or too large.
    #[error("{value} in element {element} is not from {min} to {max}")]
    Range {
        /// The element at fault.
        element: usize,
        /// The number as written.
        value: f32,
        /// Smallest allowed.
        min: f32,
        /// Largest allowed.
        max: f32,
    },
    /// Two counts that must agree.
    #[error("has {found} {what}, but {expected} are needed")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// Key times that stand still or go back.
    #[error("key {key} is not later than the one before it")]
    KeyOrder {
        /// The key at fault, from 0.
        key: usize,
    },
    /// A matrix whose last row is not 0 0 0 1.
    #[error("matrix {element} is not affine")]
    NotAffine {
        /// The element at fault.
        element: usize,
    },
    /// An animated node that is given by a matrix.
    #[error("node {node} is given by a matrix that shears, which no animated node can have")]
    AnimatedMatrix {
        /// The node at fault.
        node: usize,
    },
    /// Nodes below themselves.
    #[error("node {node} stands in or below a cycle of nodes")]
    Cycle {
        /// The first node at fault.
        node: usize,
    },
    /// A node below two others.
    #[error("node {node} has two parents")]
    TwoParents {
        /// The node at fault.
        node: usize,
    },
    /// Nothing to draw.
    #[error("holds no triangles")]
    NoTriangles,
    /// A picture that cannot be decoded.
    #[error("the image cannot be decoded: {0}")]
    Image(#[from] image::ImageError),
}

impl ToyProblem {
    /// Adds the path of the field.
    pub(super) fn at(self, field: impl Into<String>) -> Flaw {
        Flaw {
            field: field.into(),
            problem: self,
        }
    }
}

/// A problem and its field: an error without its file yet.
#[derive(Debug)]
pub(super) struct Flaw {
    field: String,
    problem: ToyProblem,
}

impl Flaw {
    /// The field and the reason.
    pub(super) fn parts(&self) -> (String, String) {
        (self.field.clone(), self.problem.to_string())
    }

    pub(super) fn in_file(self, file: &str) -> ToyError {
        ToyError::Malformed {
            file: file.to_owned(),
            field: self.field,
            problem: self.problem,
        }
    }
}

/// Names in a sentence.
struct Names<'a>(&'a [String]);

impl fmt::Display for Names<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return write!(f, "none");
        }
        let names = Listed {
            items: self.0,
            between: ", ",
        };
        names.fmt(f)
    }
}
