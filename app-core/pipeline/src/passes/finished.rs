//! A finished picture as the passes at its end read it: the camera image, and the region's picture to lay over it.

use glam::UVec2;

use crate::geometry::rect::PixelRect;
use crate::passes::frame::{Frame, Picture};

/// A picture that was made or taken.
#[derive(Clone, Copy)]
pub(crate) struct Finished<'a> {
    pub(crate) frame: Frame<'a>,
    /// None where the camera image passes through.
    pub(crate) region: Option<Laid<'a>>,
    /// Of the camera image.
    pub(crate) size_px: UVec2,
}

/// The region's picture over the camera image.
#[derive(Clone, Copy)]
pub(crate) struct Laid<'a> {
    pub(crate) picture: Picture<'a>,
    pub(crate) rect: PixelRect,
    /// Part of it that is shown, the rest being the camera image: from 0 to 1.
    pub(crate) effect: f32,
}
