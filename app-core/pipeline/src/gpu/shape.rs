//! The size and format of a texture or of a view of it, from which all numbers of bytes are
//! computed.

use glam::UVec2;
use wgpu::{TextureFormat, TextureUsages};

/// Description of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) size_px: UVec2,
    pub(crate) n_layers: u32,
    pub(crate) n_levels: u32,
    pub(crate) format: TextureFormat,
    pub(crate) n_samples: u32,
    pub(crate) usage: TextureUsages,
}

impl Shape {
    /// A shape with one layer, one level and one sample per texel.
    pub(crate) fn of(size_px: UVec2, format: TextureFormat, usage: TextureUsages) -> Self {
        Self {
            size_px,
            n_layers: 1,
            n_levels: 1,
            format,
            n_samples: 1,
            usage,
        }
    }

    /// Number of texels of the finest level, over all layers.
    pub(crate) fn n_texels(&self) -> u64 {
        u64::from(self.size_px.x) * u64::from(self.size_px.y) * u64::from(self.n_layers)
    }

    /// Bytes of a texel with all its samples.
    pub(crate) fn texel_bytes(&self) -> u64 {
        // Formats without a size of their own are depth formats, which no pass here reads.
        let bytes = self.format.block_copy_size(None).unwrap_or(4);
        u64::from(bytes * self.n_samples)
    }

    /// Bytes of all layers and levels.
    pub(crate) fn n_bytes(&self) -> u64 {
        let level = |level: u32| {
            let side = |side_px: u32| u64::from((side_px >> level).max(1));
            side(self.size_px.x) * side(self.size_px.y)
        };
        let n_texels: u64 = (0..self.n_levels).map(level).sum();
        n_texels * u64::from(self.n_layers) * self.texel_bytes()
    }

    /// Bytes in memory: zero if the texture never leaves the chip.
    pub(crate) fn held_bytes(&self) -> u64 {
        if self.usage.contains(TextureUsages::TRANSIENT_ATTACHMENT) {
            0
        } else {
            self.n_bytes()
        }
    }
}
