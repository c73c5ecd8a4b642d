//! Pictures that passes read: the camera frame in its original form, the plates, and the picture
//! that is finally shown.

use std::sync::OnceLock;

use glam::UVec2;

use crate::geometry::rect::PixelRect;
use crate::gpu::{Buffer, Gpu, Mat3Columns, Mirrors, Render, TextureView, mirrors, n_pixels, shared_struct};
use crate::passes::thing_marks::Things;
use app_scene::camera_frame::YcbcrEncoding;
use app_scene::grain::Grain;

/// Planes as sRGB codes; a shader binds the chroma plane as `chroma`.
pub(crate) const PLANES: Mirrors = mirrors!("common/planes", structs: [Encoding]);

shared_struct! {
    /// Map from the planes' codes to sRGB codes.
    pub(crate) struct Encoding {
        pub srgb_from_ycbcr: Mat3Columns,
        pub origin: [f32; 3],
        pub _pad: u32,
    }
}

/// The camera image, in its original form.
#[derive(Clone, Copy)]
pub(crate) enum Frame<'a> {
    Picture(Picture<'a>),
    Planes(FramePlanes<'a>),
}

/// Two views of an sRGB texture.
#[derive(Clone, Copy)]
pub(crate) struct Picture<'a> {
    /// View that decodes the codes.
    pub(crate) light: &'a TextureView,
    /// View of the codes.
    pub(crate) codes: &'a TextureView,
}

/// Views of luma and chroma, which may belong to the platform, and the encoding of their codes.
#[derive(Clone, Copy)]
pub(crate) struct FramePlanes<'a> {
    pub(crate) views: [&'a TextureView; 2],
    pub(crate) encoding: YcbcrEncoding,
}

/// Pipelines by the form of the picture, a constant of `common/frame`: the ones for planes, which
/// phones deliver, are compiled ahead, the ones for pictures when the first comes.
pub(crate) struct ByForm<T> {
    of_planes: T,
    of_picture: OnceLock<T>,
    make: Box<Make<T>>,
}

/// Creates a pipeline with a value of the constant.
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
    /// Uniform for `common/frame`.
    pub(crate) fn uniform(&self) -> Encoding {
        match self {
            Self::Picture(_) => bytemuck::Zeroable::zeroed(),
            Self::Planes(planes) => planes.uniform(),
        }
    }

    /// The picture, which also takes the place of the chroma that it lacks; or both planes.
    pub(crate) fn views(&self) -> [&'a TextureView; 2] {
        match self {
            Self::Picture(picture) => [picture.light; 2],
            Self::Planes(planes) => planes.views,
        }
    }
}

/// The noise of a picture, and the picture's number, by which its noise differs from that of
/// others.
#[derive(Clone, Copy)]
pub(crate) struct PictureGrain {
    pub(crate) grain: Grain,
    pub(crate) picture: u32,
}

/// The camera frame and the plates, of the image's size.
pub(crate) struct Pictures<'a> {
    pub(crate) frame: Frame<'a>,
    /// The frame's noise.
    pub(crate) grain: Option<PictureGrain>,
    /// Number of frames from which the state was estimated before.
    pub(crate) n_before: u32,
    /// Exposure of `frame` relative to that of the frame that last updated the state.
    pub(crate) exposure_ratio: f32,
    pub(crate) plates: &'a TextureView,
    /// Cameras and exposures of the plates.
    pub(crate) plate_views: &'a Buffer,
    /// Whether the first plate was taken by this very camera.
    pub(crate) is_same_view: bool,
    /// Objects in the frame beside the toy.
    pub(crate) things: Option<&'a Things>,
    /// People in the frame.
    pub(crate) people: Option<&'a Things>,
}

/// The picture that is shown: the camera image, and the region's picture over it.
#[derive(Clone, Copy)]
pub(crate) struct ComposedFrame<'a> {
    pub(crate) frame: Frame<'a>,
    /// `None` if the camera image passes through.
    pub(crate) region: Option<RegionOverlay<'a>>,
    /// Size of the camera image.
    pub(crate) size_px: UVec2,
}

/// The region's picture over the camera image.
#[derive(Clone, Copy)]
pub(crate) struct RegionOverlay<'a> {
    pub(crate) picture: Picture<'a>,
    pub(crate) rect: PixelRect,
    /// Opacity of the region's picture over the camera image, from 0 to 1.
    pub(crate) effect: f32,
}

/// Number of pixels of disjoint rectangles.
pub(crate) fn n_pixels_of(parts: &[PixelRect]) -> u64 {
    parts.iter().map(|part| n_pixels(part.size_px)).sum()
}

/// Fills disjoint rectangles of a target with the fullscreen pipeline that is set.
pub(crate) fn fill_parts(render: &mut Render<'_>, parts: &[PixelRect]) {
    for part in parts {
        render.clip((part.origin_px, part.size_px));
        render.draw(0..3, 0..1);
    }
}
