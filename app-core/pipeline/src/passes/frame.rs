//! The camera's picture on the device, in whichever form it came, as passes read it.

use std::sync::OnceLock;

use crate::gpu::context::Gpu;
use crate::gpu::shader::{Part, part};
use crate::gpu::shared::{Mat3Columns, shared_struct};
use crate::gpu::texture::TextureView;
use app_scene::camera_frame::YcbcrEncoding;

/// Planes as sRGB codes, of which a shader binds those of chroma as `chroma`.
pub(crate) const PLANES: Part = part!("common/planes", structs: [Encoding]);
/// The picture as light, which is bound with a method's scene.
pub(crate) const FRAME: Part = part!("common/frame");

shared_struct! {
    /// Map from the planes' codes to sRGB codes.
    pub(crate) struct Encoding {
        pub srgb_from_ycbcr: Mat3Columns,
        pub origin: [f32; 3],
        pub _pad: u32,
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

/// Pipelines by the form of the picture, which [`FRAME`] has as a constant: for planes, which phones deliver, compiled ahead, for
/// pictures when the first comes.
pub(crate) struct ByForm<T> {
    of_planes: T,
    of_picture: OnceLock<T>,
    make: Box<Make<T>>,
}

/// Makes a pipeline with a value of the constant.
type Make<T> = dyn Fn(&Gpu, (&'static str, u32)) -> T + Send + Sync;

impl<T> ByForm<T> {
    pub(crate) fn new(
        gpu: &Gpu,
        make: impl Fn(&Gpu, (&'static str, u32)) -> T + Send + Sync + 'static,
    ) -> Self {
        Self {
            of_planes: make(gpu, ("IS_PLANAR", 1)),
            of_picture: OnceLock::new(),
            make: Box::new(make),
        }
    }

    pub(crate) fn of(&self, gpu: &Gpu, frame: &Frame<'_>) -> &T {
        match frame {
            Frame::Planes(_) => &self.of_planes,
            Frame::Picture(_) => self.of_picture.get_or_init(|| (self.make)(gpu, ("IS_PLANAR", 0))),
        }
    }
}

impl FramePlanes<'_> {
    pub(crate) fn uniform(&self) -> Encoding {
        let map = self.encoding.srgb_from_ycbcr();
        Encoding {
            srgb_from_ycbcr: [0, 1, 2].map(|index| map.matrix.col(index).extend(0.0).to_array()),
            origin: map.origin.to_array(),
            _pad: 0,
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
