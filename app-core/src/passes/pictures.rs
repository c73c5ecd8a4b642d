//! What a method reads of the camera and of the scene's plates.

/// The camera frame and the plates, of the image's size.
pub(crate) struct Pictures<'a> {
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plates: &'a wgpu::TextureView,
    /// Where the plates were taken from, and how they were exposed.
    pub(crate) plate_views: &'a wgpu::Buffer,
}
