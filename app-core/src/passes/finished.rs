//! A finished picture as the passes at its end read it: the camera image, and the region's picture to lay over it.

use glam::UVec2;

use crate::camera_frame::YcbcrEncoding;
use crate::geometry::rect::PixelRect;
use crate::gpu::texture::TextureView;

/// A picture that was made or taken.
#[derive(Clone, Copy)]
pub(crate) struct Finished<'a> {
    pub(crate) frame: Frame<'a>,
    /// None where the camera image passes through.
    pub(crate) region: Option<Laid<'a>>,
    /// Of the camera image.
    pub(crate) size_px: UVec2,
}

/// The camera image, in the form that it came in.
#[derive(Clone, Copy)]
pub(crate) enum Frame<'a> {
    Picture(Picture<'a>),
    Planes(FramePlanes<'a>),
}

/// Views of luma and of chroma, which may be the platform's, and what their codes mean.
#[derive(Clone, Copy)]
pub(crate) struct FramePlanes<'a> {
    pub(crate) views: [&'a TextureView; 2],
    pub(crate) encoding: YcbcrEncoding,
}

/// Two views of an sRGB texture.
#[derive(Clone, Copy)]
pub(crate) struct Picture<'a> {
    /// Decoded where it is read.
    pub(crate) light: &'a TextureView,
    /// Its codes.
    pub(crate) codes: &'a TextureView,
}

/// The region's picture over the camera image.
#[derive(Clone, Copy)]
pub(crate) struct Laid<'a> {
    pub(crate) picture: Picture<'a>,
    pub(crate) rect: PixelRect,
    /// Part of it that is shown, the rest being the camera image: from 0 to 1.
    pub(crate) effect: f32,
}
