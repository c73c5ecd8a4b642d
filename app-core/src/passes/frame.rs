//! The camera's picture on the device, in whichever form it came, as passes read it.

use crate::camera_frame::YcbcrEncoding;
use crate::gpu::shader::{Part, part};
use crate::gpu::shared::{Mat3Columns, shared_struct};
use crate::gpu::texture::TextureView;

/// Planes as sRGB codes, which a shader binds as `encoding` and `chroma`.
pub(crate) const PLANES: Part = part!("common/planes", structs: [Encoding]);
/// The picture as light, which is bound with a method's scene.
pub(crate) const FRAME: Part = part!("common/frame");

shared_struct! {
    /// Map from the planes' codes to sRGB codes.
    pub(crate) struct Encoding {
        pub srgb_from_ycbcr: Mat3Columns,
        pub origin: [f32; 3],
        pub is_planar: u32,
    }
}

/// The camera image, in the form that it came in.
#[derive(Clone, Copy)]
pub(crate) enum Frame<'a> {
    Picture(Picture<'a>),
    Planes(FramePlanes<'a>),
}

/// Two views of an sRGB texture.
#[derive(Clone, Copy)]
pub(crate) struct Picture<'a> {
    /// Decoded where it is read.
    pub(crate) light: &'a TextureView,
    /// Its codes.
    pub(crate) codes: &'a TextureView,
}

/// Views of luma and of chroma, which may be the platform's, and what their codes mean.
#[derive(Clone, Copy)]
pub(crate) struct FramePlanes<'a> {
    pub(crate) views: [&'a TextureView; 2],
    pub(crate) encoding: YcbcrEncoding,
}

impl FramePlanes<'_> {
    pub(crate) fn uniform(&self) -> Encoding {
        let map = self.encoding.srgb_from_ycbcr();
        Encoding {
            srgb_from_ycbcr: map.columns(),
            origin: map.origin.to_array(),
            is_planar: 1,
        }
    }
}

impl<'a> Frame<'a> {
    /// For [`FRAME`].
    pub(crate) fn uniform(&self) -> Encoding {
        match self {
            Self::Picture(_) => bytemuck::Zeroable::zeroed(),
            Self::Planes(planes) => planes.uniform(),
        }
    }

    /// The picture, which stands in for the chroma that it does not have; or both planes.
    pub(crate) fn views(&self) -> [&'a TextureView; 2] {
        match self {
            Self::Picture(picture) => [picture.light; 2],
            Self::Planes(planes) => planes.views,
        }
    }
}
