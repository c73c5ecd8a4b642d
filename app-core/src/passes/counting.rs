//! What `occlusion` and `coverage` share: a target that counts, for each pixel, how many of a pass's instances show there.
//!
//! Blending adds up. Each instance has a depth of its own, above those before it, and what is not above what is there is
//! rejected: so triangles of one instance that overlap count once.

use glam::UVec2;
use wgpu::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthStencilState, StoreOp, TextureFormat,
};

use crate::gpu::context::Gpu;
use crate::gpu::pipeline::nearest_surface;
use crate::gpu::recorder::{Recorder, Render, cleared};
use crate::gpu::texture::Texture;

/// Format of the count, in whole codes.
const COUNT_FORMAT: TextureFormat = TextureFormat::R8Unorm;
/// Format of the depths that order the instances.
const ORDER_FORMAT: TextureFormat = TextureFormat::Depth16Unorm;

/// What is counted, and in which order.
pub(crate) struct CountingTargets {
    /// Which instance was drawn last; never leaves the chip.
    order: Texture,
    pub(crate) count: Texture,
}

impl CountingTargets {
    pub(crate) fn new(gpu: &Gpu, label: &str, size_px: UVec2) -> Self {
        Self {
            order: Texture::samples(gpu, &format!("{label} order"), size_px, (ORDER_FORMAT, 1)),
            count: Texture::target(gpu, label, size_px, COUNT_FORMAT),
        }
    }

    /// Begins a pass that counts from nothing.
    pub(crate) fn render<'a>(&self, recorder: &'a mut Recorder<'_>, pass: &'static str) -> Render<'a> {
        let colors = [Some(cleared(&self.count.view))];
        recorder.render(pass, &colors, Some(&self.order.view), StoreOp::Discard)
    }
}

/// The target that adds up what is drawn.
pub(crate) fn counting() -> ColorTargetState {
    let sum = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation: BlendOperation::Add,
    };
    ColorTargetState {
        format: COUNT_FORMAT,
        blend: Some(BlendState {
            color: sum,
            alpha: sum,
        }),
        write_mask: ColorWrites::ALL,
    }
}

/// A target that leaves what was counted.
pub(crate) fn not_counting() -> ColorTargetState {
    ColorTargetState {
        write_mask: ColorWrites::empty(),
        ..COUNT_FORMAT.into()
    }
}

/// The depths of the instances; those that count are `Greater` than what is there.
pub(crate) fn ordered(compare: CompareFunction) -> DepthStencilState {
    DepthStencilState {
        format: ORDER_FORMAT,
        depth_compare: Some(compare),
        ..nearest_surface()
    }
}
