//! What a method reads of the camera and of the scene's plates.

/// The camera frame and the plates, of the image's size.
pub(crate) struct Pictures<'a> {
    pub(crate) frame: &'a wgpu::TextureView,
    /// Exposure of `frame` over that of the frame learned from before it.
    pub(crate) exposure_ratio: f32,
    pub(crate) plates: &'a wgpu::TextureView,
    /// Where the plates were taken from, and how they were exposed.
    pub(crate) plate_views: &'a wgpu::Buffer,
}
