//! What `occlusion` and `coverage` share: a target that counts, for each pixel, how many of a pass's instances show there.
//!
//! Blending counts, up or down. Each instance has a depth of its own, above those before it, and what is not above what is there is
//! rejected: so triangles of one instance that overlap count once.
//!
//! Where no silhouette comes near, all instances show the same: what is there is drawn once and counts in full.

use std::ops::Range;

use glam::UVec2;
use wgpu::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthStencilState, Face, StoreOp, TextureFormat,
};

use crate::gpu::{Attachment, Draw, DrawSpec, Gpu, Group, Recorder, Render, Texture, nearest_surface};
use crate::passes::toy_mesh::{Corners, PoseBuffers};

/// Format of the depths that order the instances.
const ORDER_FORMAT: TextureFormat = TextureFormat::Depth16Unorm;

/// Depths that tell which instance was drawn last in each pixel; they never leave the chip.
pub(crate) struct InstanceOrder(Texture);

impl InstanceOrder {
    pub(crate) fn new(gpu: &Gpu, label: &str, size_px: UVec2) -> Self {
        Self(Texture::samples(gpu, label, size_px, (ORDER_FORMAT, 1)))
    }

    /// Begins a pass that counts, from what is in the target.
    pub(crate) fn render<'a>(
        &self,
        recorder: &'a mut Recorder<'_>,
        pass: &'static str,
        count: Attachment<'_>,
    ) -> Render<'a> {
        recorder.render(pass, &[Some(count)], Some(&self.0.view), StoreOp::Discard)
    }
}

/// Pipelines that count a shape's instances.
pub(crate) struct CountingDraws {
    /// Once for each instance; both sides of each triangle, or the outer one.
    each: [Draw; 2],
    /// The same where less has to be looked at.
    plain: [Draw; 2],
    /// Once for all of them; the same.
    once: [Draw; 2],
    tiles: Draw,
}

impl CountingDraws {
    /// `each` draws one instance; the shader has `vs_once` and `fs_cover_all` beside it, and for instances that have it plain
    /// `vs_plain` and `fs_cover_plain`.
    pub(crate) fn new(gpu: &Gpu, each: &DrawSpec) -> Self {
        let plain = DrawSpec {
            vertex: "vs_plain",
            fragment: "fs_cover_plain",
            ..each.clone()
        };
        let once = DrawSpec {
            vertex: "vs_once",
            fragment: "fs_cover_all",
            ..each.clone()
        };
        let tiles = DrawSpec {
            vertex: "vs_tile",
            fragment: "fs_tile",
            targets: each.targets.iter().map(not_counting).collect(),
            depth: Some(ordered(CompareFunction::Always)),
            ..each.clone()
        };
        let sided = |spec: &DrawSpec| {
            [None, Some(Face::Back)].map(|culled| {
                gpu.draw(&DrawSpec {
                    culled,
                    ..spec.clone()
                })
            })
        };
        Self {
            each: sided(each),
            plain: sided(&plain),
            once: sided(&once),
            tiles: gpu.draw(&tiles),
        }
    }

    /// One of them, to bind groups for all.
    pub(crate) fn any(&self) -> &Draw {
        &self.each[0]
    }

    /// Counts instances of a shape in a pose, of which the first `n_plain` have it plain.
    pub(crate) fn count(
        &self,
        render: &mut Render<'_>,
        groups: &[Group],
        (corners, pose): (&Corners<'_>, &PoseBuffers),
        instances: Range<u32>,
        n_plain: u32,
    ) {
        let sided = usize::from(corners.is_culled);
        if let Some(silhouette) = &corners.silhouette {
            render.begin(&self.tiles, groups);
            silhouette.draw_tiles(render, true);
            render.begin(&self.once[sided], &[]);
            corners.bind(render, pose);
            corners.draw(render, instances.start..instances.start + 1);
            render.begin(&self.tiles, &[]);
            silhouette.draw_tiles(render, false);
        } else {
            groups.iter().for_each(|group| render.set(group));
        }
        // One after the other, since each counts above those before it.
        let first_other = (instances.start + n_plain).min(instances.end);
        let plain = (&self.plain[sided], instances.start..first_other);
        let others = (&self.each[sided], first_other..instances.end);
        for (draw, instances) in [plain, others] {
            if !instances.is_empty() {
                render.begin(draw, &[]);
                corners.draw_each(render, pose, instances);
            }
        }
    }
}

/// A target that adds up what is drawn, or takes it from what is there.
pub(crate) fn counting(format: TextureFormat, operation: BlendOperation) -> ColorTargetState {
    let count = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation,
    };
    ColorTargetState {
        format,
        blend: Some(BlendState {
            color: count,
            alpha: count,
        }),
        write_mask: ColorWrites::ALL,
    }
}

/// One that leaves what was counted.
pub(crate) fn not_counting(counting: &ColorTargetState) -> ColorTargetState {
    ColorTargetState {
        write_mask: ColorWrites::empty(),
        ..counting.format.into()
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
