//! Unsupported or repaired features of a toy's file.

use thiserror::Error;

use crate::words::Text;

/// An unsupported or repaired feature of a toy's file; the toy can be used nevertheless.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ToyWarning {
    /// Points and lines, whose shadows are not supported.
    #[error("{field}: not made of triangles, left out")]
    PrimitiveSkipped {
        /// Path of the primitive.
        field: String,
    },
    /// Skin weights that did not sum to one; they were scaled, or given to the first joint if all
    /// were 0.
    #[error("meshes: the skin weights of {n_vertices} vertices did not sum to 1 and were repaired")]
    WeightsRepaired {
        /// Number of repaired vertices, over the whole file.
        n_vertices: usize,
    },
    /// Vertex colours outside 0 to 1: clamped, as glTF requires.
    #[error("{field}: {n_vertices} colours were not from 0 to 1 and were clamped")]
    ColorsClamped {
        /// Path of the attribute.
        field: String,
        /// Number of repaired vertices.
        n_vertices: usize,
    },
    /// Normals of length zero: replaced by the adjacent faces'.
    #[error("{field}: {n_vertices} normals had no length and were taken from the faces")]
    NormalsFromFaces {
        /// Path of the attribute.
        field: String,
        /// Number of repaired vertices.
        n_vertices: usize,
    },
    /// Normals that pointed away from the outer side of most of their faces: reversed.
    #[error("{field}: {n_vertices} normals pointed into the toy and were turned around")]
    NormalsInverted {
        /// Path of the attribute.
        field: String,
        /// Number of repaired vertices.
        n_vertices: usize,
    },
    /// Closed pieces whose faces looked inwards: reversed.
    #[error("{field}: {n_triangles} triangles of closed pieces faced inwards and were turned around")]
    FacesInverted {
        /// Path of the primitive.
        field: String,
        /// Number of repaired triangles.
        n_triangles: usize,
    },
    /// A skin on a primitive without joints: drawn rigid.
    #[error("{field}: has a skin but no joints, drawn rigid")]
    SkinIgnored {
        /// Path of the primitive.
        field: String,
    },
    /// An external picture that the caller could not provide: the plain colour is used.
    #[error(
        "{field}: {} is not beside the toy or cannot be read, left out: the plain colour is used",
        Text(name)
    )]
    ImageOutside {
        /// Path of the image.
        field: String,
        /// Its name, relative to the toy's file.
        name: String,
    },
    /// A picture that is neither PNG, JPEG nor WebP: the plain colour is used.
    #[error("{field}: the image is not PNG, JPEG or WebP, left out: the plain colour is used")]
    ImageIgnored {
        /// Path of the image.
        field: String,
    },
    /// A picture in a known but unsupported format: the plain colour is used.
    #[error("{field}: the picture is {format}, which is not read: the plain colour is used; {way_out}")]
    FormatIgnored {
        /// Path of the texture or image.
        field: String,
        /// The format or extension.
        format: &'static str,
        /// The way to convert it.
        way_out: &'static str,
    },
    /// A texture without a picture: the plain colour is used.
    #[error("{field}: has no picture, left out: the plain colour is used")]
    TextureIgnored {
        /// Path of the texture.
        field: String,
    },
    /// A factor of the base colour outside 0 to 1: clamped.
    #[error("{field}: was not from 0 to 1 and was clamped")]
    FactorClamped {
        /// Path of the factor.
        field: String,
    },
    /// Rotations of length zero: a node's becomes the identity, a clip's the rotation of the key
    /// before.
    #[error("{field}: {n} rotations were quaternions of length zero and were replaced")]
    RotationsRepaired {
        /// Path of the rotation, or of the channel.
        field: String,
        /// Number of rotations.
        n: usize,
    },
    /// An animated node with a matrix, which is decomposed into translation, rotation and scale.
    #[error("{field}: the animated node is given by a matrix, which was decomposed")]
    MatrixDecomposed {
        /// Path of the channel.
        field: String,
    },
    /// An unreadable clip; the toy can be used without it.
    #[error("{field}: the clip is left out: {reason}")]
    ClipIgnored {
        /// Path of the animation, or of the field with the problem.
        field: String,
        /// The problem.
        reason: String,
    },
    /// Two clips of one name: the name finds the first.
    #[error(
        "animations[{second}]: is called {name:?}, as is animations[{first}]: ask for it as \"#{second}\""
    )]
    ClipsAlike {
        /// The name.
        name: String,
        /// The clip found by the name.
        first: usize,
        /// The other clip.
        second: usize,
    },
    /// A part that a clip mirrors, since its scale changes its sign: drawn from both sides.
    #[error("{field}: a clip mirrors it, so that it is drawn from both sides")]
    Mirrored {
        /// Path of the node.
        field: String,
    },
    /// Parts that a clip may mirror, with too many vertices to check in each pose.
    #[error(
        "{field}: the clip may mirror parts that have too many vertices to check: they are drawn from both sides"
    )]
    MirroredUnknown {
        /// Path of the animation.
        field: String,
    },
    /// A part with alpha blending: cut at half transparency instead.
    #[error(
        "{field}: alphaMode is BLEND, which is not supported: the toy is cut where alpha is below .5, and whole elsewhere"
    )]
    BlendCut {
        /// Path of the material.
        field: String,
    },
    /// A part that is cut by alpha more coarsely than its picture, to limit the triangles.
    #[error("{field}: is cut by alpha to {texels} texels, because finer cuts would take too many triangles")]
    CutCoarse {
        /// Path of the material.
        field: String,
        /// Texel size of the finest possible cut.
        texels: u32,
    },
    /// A part that is not cut by alpha, since even coarse cuts would have too many triangles.
    #[error(
        "{field}: is not cut by alpha and drawn whole, because its parts would have too many triangles: simplify the mesh"
    )]
    NotCut {
        /// Path of the material.
        field: String,
    },
    /// A part with alpha blending of which a cut would remove nothing, or all.
    #[error("{field}: alphaMode is BLEND, which is not supported: drawn whole")]
    BlendWhole {
        /// Path of the material.
        field: String,
    },
    /// An animated property that belongs to no node.
    #[error("{field}: animates {pointer:?}, which is not supported")]
    PointerIgnored {
        /// Path of the channel.
        field: String,
        /// The animated property.
        pointer: String,
    },
    /// Animated weights on a node without morph targets, or a channel without a target.
    #[error("{field}: moves nothing, left out")]
    ChannelIgnored {
        /// Path of the channel.
        field: String,
    },
    /// An extension that changes the toy's appearance.
    #[error("extensionsUsed: {name:?} is not supported")]
    ExtensionIgnored {
        /// Name of the extension.
        name: String,
    },
}
