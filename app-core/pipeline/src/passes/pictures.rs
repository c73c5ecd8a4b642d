//! Pictures that a method reads: the camera frame and the scene's plates.

use crate::gpu::buffer::Buffer;
use crate::gpu::texture::TextureView;
use crate::passes::frame::Frame;

/// The camera frame and the plates, of the image's size.
pub(crate) struct Pictures<'a> {
    pub(crate) frame: Frame<'a>,
    /// How many the state has learned from before.
    pub(crate) n_before: u32,
    /// Exposure of `frame` over that of the frame that last updated the state.
    pub(crate) exposure_ratio: f32,
    pub(crate) plates: &'a TextureView,
    /// Cameras and exposures of the plates.
    pub(crate) plate_views: &'a Buffer,
    /// Whether the first plate was taken from this very camera.
    pub(crate) is_same_view: bool,
}
