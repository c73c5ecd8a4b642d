//! Buffers and views as passes hold them; where nothing is drawn, only counted, no more than their sizes.

use super::meter::Held;
use super::shape::Shape;
use super::work::Id;

/// A buffer.
#[derive(Debug)]
pub(crate) struct Buffer {
    pub raw: Option<wgpu::Buffer>,
    pub(super) id: Id,
    pub(super) n_bytes: u64,
    pub(super) _held: Held,
}

/// A view of a texture, or of some of its layers.
#[derive(Debug)]
pub(crate) struct TextureView {
    pub raw: Option<wgpu::TextureView>,
    /// The texture's, of which those with several layers have one each.
    pub(super) id: Id,
    pub(super) shape: Shape,
    /// Whether the core made it; what a platform lends no cached group holds.
    pub(super) is_own: bool,
}
