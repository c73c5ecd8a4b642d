//! Buffers and views as passes hold them; if work is only counted, they are no more than sizes.

use super::meter::CountedBytes;
use super::shape::Shape;
use super::work::Id;

/// A buffer.
#[derive(Debug)]
pub(crate) struct Buffer {
    pub raw: Option<wgpu::Buffer>,
    pub(super) id: Id,
    pub(super) n_bytes: u64,
    pub(super) _held: CountedBytes,
}

/// A view of a texture, or of some of its layers.
#[derive(Debug)]
pub(crate) struct TextureView {
    pub raw: Option<wgpu::TextureView>,
    /// Identifier of the texture; textures with several layers have one for each.
    pub(super) id: Id,
    pub(super) shape: Shape,
    /// Whether the core created it; cached groups do not hold the platform's textures.
    pub(super) is_own: bool,
}
