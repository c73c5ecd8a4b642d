//! Errors of a toy's file, each with file, field and reason.

use std::fmt;

use thiserror::Error;

use crate::words::{Listed, Number, Text};

/// A toy that cannot be used, or an invalid request to a toy.
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
        /// The problem.
        problem: ToyProblem,
    },
    /// No clip has this name.
    #[error("{file}: clip: none is called {:?}; it has {}", Text(name).to_string(), Names(known))]
    UnknownClip {
        /// The file as named by the caller.
        file: String,
        /// The name asked for.
        name: String,
        /// All valid names.
        known: Vec<String>,
    },
    /// A [`ClipId`](super::ClipId) of another toy.
    #[error("{file}: clip: there is no number {clip}; it has {n_clips} clips, counted from 0")]
    ForeignClip {
        /// The file as named by the caller.
        file: String,
        /// The requested number.
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
        /// All valid names.
        known: Vec<String>,
    },
    /// A [`NodeId`](super::NodeId) of another toy.
    #[error("{file}: node: there is no number {node}; it has {n_nodes} nodes, counted from 0")]
    ForeignNode {
        /// The file as named by the caller.
        file: String,
        /// The requested number.
        node: usize,
        /// Number of nodes, counted from 0.
        n_nodes: usize,
    },
    /// A clip of the file that cannot be read.
    #[error("{file}: clip {:?}: cannot be read: {reason}", Text(name).to_string())]
    BrokenClip {
        /// The file as named by the caller.
        file: String,
        /// The name asked for.
        name: String,
        /// The reason.
        reason: String,
    },
    /// An invalid transform or weight in a pose.
    #[error("{file}: pose: node {node}: {reason}")]
    NodePose {
        /// The file as named by the caller.
        file: String,
        /// Number of the node.
        node: usize,
        /// The reason.
        reason: &'static str,
    },
    /// A time that is negative or not finite.
    #[error("{file}: clip time: {} s is not a time from 0 on", Number(*time_secs))]
    Time {
        /// The file as named by the caller.
        file: String,
        /// The requested time.
        time_secs: f64,
    },
    /// Valid numbers whose product is out of range.
    #[error("{file}: pose: the position of vertex {vertex} is not from -{max} to {max} along each axis")]
    PoseOverflow {
        /// The file as named by the caller.
        file: String,
        /// First vertex out of range.
        vertex: usize,
        /// Largest coordinate allowed, in units of the posing space.
        max: f64,
    },
}

/// The reason why a field of a toy's file is refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ToyProblem {
    /// Another kind of file.
    #[error("is {what}, not glTF 2.0: {way_out}")]
    Foreign {
        /// The kind.
        what: &'static str,
        /// The way to convert it.
        way_out: &'static str,
    },
    /// Not the JSON of glTF.
    #[error("not glTF: {0}")]
    Json(String),
    /// Not the container of binary glTF.
    #[error("not binary glTF: {0}")]
    Container(#[source] Box<gltf::Error>),
    /// The length in the header is impossible.
    #[error("the header gives a length of {found} bytes, which is less than itself")]
    HeaderLength {
        /// The length as written.
        found: u32,
    },
    /// A required extension that is not supported.
    #[error("the file requires the extension {name:?}, which is not supported: {way_out}")]
    Extension {
        /// Name of the extension.
        name: String,
        /// The way to export the file without it.
        way_out: &'static str,
    },
    /// A reference to data outside the file.
    #[error(
        "refers to data outside the file, which is not there: put the file beside its neighbours, or pack it with \
         `npx @gltf-transform/cli copy IN.gltf OUT.glb`"
    )]
    External,
    /// A file beside the toy's that cannot be read.
    #[error("{name}: {reason}")]
    Neighbour {
        /// Its name, relative to the toy's file.
        name: String,
        /// The caller's reason.
        reason: String,
    },
    /// An invalid data URI.
    #[error("is not a base64 data URI")]
    DataUri,
    /// An invalid stream of meshopt.
    #[error("the compressed data is broken, or has another length than stated")]
    Compressed,
    /// A count above its limit.
    #[error("{found} {what} are more than the {limit} allowed")]
    TooMany {
        /// The counted things.
        what: &'static str,
        /// Their number.
        found: u64,
        /// The limit.
        limit: u64,
    },
    /// A required part that is missing.
    #[error("missing")]
    Missing,
    /// A value that glTF does not define.
    #[error("not a value that glTF allows")]
    NotAllowed,
    /// A reference to a missing part of the file.
    #[error("refers to {what} {index}, but the file has {n}, counted from 0")]
    NoSuch {
        /// Kind of the target.
        what: &'static str,
        /// The index as written.
        index: usize,
        /// Number of such parts.
        n: usize,
    },
    /// An accessor of the wrong type.
    #[error("is {found}, but {expected} is needed")]
    WrongType {
        /// The required type.
        expected: String,
        /// The type in the file.
        found: String,
    },
    /// An accessor, a view or an image that reaches beyond its bytes.
    #[error("reaches to byte {end}, but there are {available}")]
    OutOfRange {
        /// End of the range.
        end: u64,
        /// Number of available bytes.
        available: usize,
    },
    /// Overlapping elements.
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
        /// Number of elements of the accessor.
        count: usize,
    },
    /// NaN or infinity.
    #[error("{n_bad} of {n} numbers are not finite, the first in element {first}")]
    NotFinite {
        /// Number of invalid values.
        n_bad: usize,
        /// Number of all values.
        n: usize,
        /// The first element with one.
        first: usize,
    },
    /// A number too small or too large.
    #[error("{value} in element {element} is not from {min} to {max}")]
    Range {
        /// The element.
        element: usize,
        /// The number as written.
        value: f32,
        /// Smallest allowed.
        min: f32,
        /// Largest allowed.
        max: f32,
    },
    /// Two counts that must be equal.
    #[error("has {found} {what}, but {expected} are needed")]
    Count {
        /// The counted things.
        what: &'static str,
        /// Their number.
        found: usize,
        /// The required number.
        expected: usize,
    },
    /// Key times that do not increase.
    #[error("key {key} is not later than the one before it")]
    KeyOrder {
        /// Index of the key, from 0.
        key: usize,
    },
    /// A matrix whose last row is not 0 0 0 1.
    #[error("matrix {element} is not affine")]
    NotAffine {
        /// The element.
        element: usize,
    },
    /// An animated node with a shearing matrix.
    #[error("node {node} is given by a matrix that shears, which no animated node can have")]
    AnimatedMatrix {
        /// The node.
        node: usize,
    },
    /// A cycle of nodes.
    #[error("node {node} stands in or below a cycle of nodes")]
    Cycle {
        /// The first such node.
        node: usize,
    },
    /// A node with two parents.
    #[error("node {node} has two parents")]
    TwoParents {
        /// The node.
        node: usize,
    },
    /// A file without triangles.
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
