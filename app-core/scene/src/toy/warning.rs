//! What of a toy's file is not supported, or was repaired.

use thiserror::Error;

use crate::words::Text;

/// An unsupported feature of a toy's file; the toy is usable all the same.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ToyWarning {
    /// Points and lines, whose shadows are not supported.
    #[error("{field}: not made of triangles, left out")]
    PrimitiveSkipped {
        /// Path of the primitive.
        field: String,
    },
    /// Skin weights that did not sum to one; they were scaled, or given to the first joint where all were 0.
    #[error("meshes: the skin weights of {n_vertices} vertices did not sum to 1 and were repaired")]
    WeightsRepaired {
        /// Vertices touched, over the whole file.
        n_vertices: usize,
    },
    /// Colours of vertices outside 0 to 1: clamped, as glTF asks for.
    #[error("{field}: {n_vertices} colours were not from 0 to 1 and were clamped")]
    ColorsClamped {
        /// Path of the attribute.
        field: String,
        /// Vertices touched.
        n_vertices: usize,
    },
    /// Normals of length zero: taken from the faces around them.
    #[error("{field}: {n_vertices} normals had no length and were taken from the faces")]
    NormalsFromFaces {
        /// Path of the attribute.
        field: String,
        /// Vertices touched.
        n_vertices: usize,
    },
    /// Normals that pointed away from the outer side of most of their faces: turned around.
    #[error("{field}: {n_vertices} normals pointed into the toy and were turned around")]
    NormalsInverted {
        /// Path of the attribute.
        field: String,
        /// Vertices touched.
        n_vertices: usize,
    },
    /// Closed pieces whose faces looked inwards: turned around.
    #[error("{field}: {n_triangles} triangles of closed pieces faced inwards and were turned around")]
    FacesInverted {
        /// Path of the primitive.
        field: String,
        /// Triangles touched.
        n_triangles: usize,
    },
    /// A skin on a primitive that has no joints: drawn rigid.
    #[error("{field}: has a skin but no joints, drawn rigid")]
    SkinIgnored {
        /// Path of the primitive.
        field: String,
    },
    /// A picture outside the file that nobody gave: the plain colour is used.
    #[error(
        "{field}: {} is not beside the toy or cannot be read, left out: the plain colour is used",
        Text(name)
    )]
    ImageOutside {
        /// Path of the image.
        field: String,
        /// Its name, as seen from the toy's file.
        name: String,
    },
    /// A picture that is neither PNG, JPEG nor WebP: the plain colour is used.
    #[error("{field}: the image is not PNG, JPEG or WebP, left out: the plain colour is used")]
    ImageIgnored {
        /// Path of the image.
        field: String,
    },
    /// A picture in a format that is known and not read: the plain colour is used.
    #[error("{field}: the picture is {format}, which is not read: the plain colour is used; {way_out}")]
    FormatIgnored {
        /// Path of the texture or image.
        field: String,
        /// The format or the extension that it is of.
        format: &'static str,
        /// What makes a picture that is read.
        way_out: &'static str,
    },
    /// A texture that has no picture: the plain colour is used.
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
    /// Rotations of length zero: those of a node are none, those of a clip are the key's before.
    #[error("{field}: {n} rotations were quaternions of length zero and were replaced")]
    RotationsRepaired {
        /// Path of the rotation, or of the channel.
        field: String,
        /// How many there were.
        n: usize,
    },
    /// An animated node that is given by a matrix: taken apart into translation, rotation and scale.
    #[error("{field}: the animated node is given by a matrix, which was taken apart")]
    MatrixDecomposed {
        /// Path of the channel.
        field: String,
    },
    /// A clip that cannot be read; the toy is usable without it.
    #[error("{field}: the clip is left out: {reason}")]
    ClipIgnored {
        /// Path of the animation, or of what is wrong in it.
        field: String,
        /// What is wrong.
        reason: String,
    },
    /// Two clips of one name: the first is meant by it.
    #[error(
        "animations[{second}]: is called {name:?}, as is animations[{first}]: ask for it as \"#{second}\""
    )]
    ClipsAlike {
        /// The name.
        name: String,
        /// The clip that the name finds.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A part whose scale changes its sign in a clip, so that it is mirrored: seen from both sides.
    #[error("{field}: a clip mirrors it, so that it is drawn from both sides")]
    Mirrored {
        /// Path of the node.
        field: String,
    },
    /// Parts below a scale that changes its sign, and too many vertices to look at in each pose of the clip.
    #[error(
        "{field}: the clip may mirror parts that have too many vertices to look at: they are drawn from both sides"
    )]
    MirroredUnknown {
        /// Path of the animation.
        field: String,
    },
    /// A part that blends with what is behind: cut where it is more clear than not.
    #[error(
        "{field}: alphaMode is BLEND, which is not followed: the toy is cut where alpha is below .5, and whole elsewhere"
    )]
    BlendCut {
        /// Path of the material.
        field: String,
    },
    /// A part that is cut by alpha less finely than its picture, because there would be too many triangles.
    #[error("{field}: is cut by alpha to {texels} texels, because finer cuts would take too many triangles")]
    CutCoarse {
        /// Path of the material.
        field: String,
        /// Size of the finest cut.
        texels: u32,
    },
    /// A part that is not cut by alpha, because even coarse cuts would make too many triangles.
    #[error(
        "{field}: is not cut by alpha and drawn whole, because its parts would have too many triangles: simplify the mesh"
    )]
    NotCut {
        /// Path of the material.
        field: String,
    },
    /// A part that blends with what is behind, of which nothing is cut, or of which nothing would be left.
    #[error("{field}: alphaMode is BLEND, which is not followed: drawn whole")]
    BlendWhole {
        /// Path of the material.
        field: String,
    },
    /// An animated property of the file that is none of a node.
    #[error("{field}: animates {pointer:?}, which is not followed")]
    PointerIgnored {
        /// Path of the channel.
        field: String,
        /// What it animates.
        pointer: String,
    },
    /// Animated weights on a node without morph targets, or a channel without a target.
    #[error("{field}: moves nothing, left out")]
    ChannelIgnored {
        /// Path of the channel.
        field: String,
    },
    /// An extension that changes how the toy looks.
    #[error("extensionsUsed: {name:?} is not followed")]
    ExtensionIgnored {
        /// Name of the extension.
        name: String,
    },
}
