//! What `occlusion` and `coverage` share: a target that counts, for each pixel, how many of a pass's instances show there.
//!
//! Blending adds up. Each instance has a depth of its own, above those before it, and what is not above what is there is
//! rejected: so triangles of one instance that overlap count once.

use wgpu::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthStencilState, TextureFormat,
};

use crate::gpu::pipeline::nearest_surface;

/// Format of the count, in whole codes.
pub(crate) const COUNT_FORMAT: TextureFormat = TextureFormat::R8Unorm;
/// Format of the depths that tell instances apart.
pub(crate) const ORDER_FORMAT: TextureFormat = TextureFormat::Depth16Unorm;

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

/// The depths of the instances; those that count are `Greater` than what is there.
pub(crate) fn ordered(compare: CompareFunction) -> DepthStencilState {
    DepthStencilState {
        format: ORDER_FORMAT,
        depth_compare: Some(compare),
        ..nearest_surface()
    }
}
