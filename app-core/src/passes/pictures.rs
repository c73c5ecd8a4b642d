//! Pictures that a method reads: the camera frame and the scene's plates.

/// The camera frame and the plates, of the image's size.
pub(crate) struct Pictures<'a> {
    pub(crate) frame: &'a wgpu::TextureView,
    /// Exposure of `frame` over that of the frame that last updated the state.
    pub(crate) exposure_ratio: f32,
    pub(crate) plates: &'a wgpu::TextureView,
    /// Cameras and exposures of the plates.
    pub(crate) plate_views: &'a wgpu::Buffer,
}
