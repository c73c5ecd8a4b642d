//! What a view shows of the receivers, with the light that reaches them in the physical pose.

use crate::gpu::texture::TextureView;

/// Maps of the region that passes which learn from the receivers read, each pixel by pixel.
#[derive(Clone, Copy)]
pub(crate) struct Observed<'a> {
    pub(crate) validity: &'a TextureView,
    /// Of each light.
    pub(crate) visibility: &'a TextureView,
    /// Of the ambient light; smaller, and filtered.
    pub(crate) ambient: &'a TextureView,
}
