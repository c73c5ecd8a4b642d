//! Common parts of `occlusion` and `coverage`: a target that counts, for each pixel, the instances
//! of a pass that cover it.
//!
//! Blending counts, up or down. Each instance has a depth of its own, above those before it, and
//! fragments that are not above the stored depth are rejected. Thus overlapping triangles of one
//! instance count once.
//!
//! Far from every silhouette all instances cover the same pixels: the shape is drawn once and
//! counts in full.

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

/// Depths that identify the last drawn instance in each pixel; they never leave the chip.
pub(crate) struct InstanceOrder(Texture);

impl InstanceOrder {
    pub(crate) fn new(gpu: &Gpu, label: &str, size_px: UVec2) -> Self {
        Self(Texture::samples(gpu, label, size_px, (ORDER_FORMAT, 1)))
    }

    /// Begins a pass that counts, starting from the target's content.
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
    /// Draws for each instance, of both sides of each triangle or of the outer one.
    each: [Draw; 2],
    /// The same, for instances that need fewer tests.
    plain: [Draw; 2],
    /// A single draw for all instances, likewise.
    once: [Draw; 2],
    tiles: Draw,
}

impl CountingDraws {
    /// `each` draws one instance; its shader also has `vs_once` and `fs_cover_all`, and for plain
    /// instances `vs_plain` and `fs_cover_plain`.
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

    /// Any of the pipelines, for binding groups that all share.
    pub(crate) fn any(&self) -> &Draw {
        &self.each[0]
    }

    /// Counts instances of a posed shape, the first `n_plain` of which are plain.
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
        // The draws run in sequence, since each counts above those before it.
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

/// A target that adds the drawn values or subtracts them.
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

/// A target that keeps the counted values.
pub(crate) fn not_counting(counting: &ColorTargetState) -> ColorTargetState {
    ColorTargetState {
        write_mask: ColorWrites::empty(),
        ..counting.format.into()
    }
}

/// The depth state of the instances; for those that count, the comparison with the stored depth is
/// `Greater`.
pub(crate) fn ordered(compare: CompareFunction) -> DepthStencilState {
    DepthStencilState {
        format: ORDER_FORMAT,
        depth_compare: Some(compare),
        ..nearest_surface()
    }
}
