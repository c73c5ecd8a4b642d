//! `occlusion`: shadows of the posed toy on the receivers from many light points, 16 of them a pass.

use std::ops::Range;

use glam::{UVec2, Vec4};
use wgpu::{
    BlendComponent, BlendFactor, BlendOperation, BlendState, ColorTargetState, ColorWrites, CompareFunction,
    DepthStencilState, Face, StencilFaceState, StencilOperation, StencilState, TextureFormat, VertexFormat,
};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, resolved};
use crate::gpu::layout::{LightPoints, MAX_LIGHT_POINTS, MAX_RECEIVERS};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, RenderShape, Stages};
use crate::gpu::shaders::OCCLUSION;
use crate::gpu::texture::{Texture, TextureShape};

use super::toy_mesh::{PoseBuffers, Stream, ToyMesh};

/// Light points that one colour target holds: four channels of four multisample positions.
const POINTS_PER_TARGET: u32 = 16;
const N_SAMPLES: u32 = 4;
const FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;
/// Format of the number of the receiver that a pixel shows, from 1; 0 where it shows none.
const ROUTE_FORMAT: TextureFormat = TextureFormat::Stencil8;

/// The pass for a number of receivers.
pub(crate) struct Occlusion {
    cover: wgpu::RenderPipeline,
    /// Which receiver a pixel shows, where there are several.
    route: Option<wgpu::RenderPipeline>,
    n_receivers: u32,
}

/// Targets for maps of one size: multisampled ones that stay on the chip, and what they are resolved to.
pub(crate) struct OcclusionTargets {
    samples: Texture,
    route: Option<Texture>,
    /// One for each 16 points; what a map of fewer points does not draw keeps what it had.
    pub(crate) hidden: Vec<Texture>,
    /// Size of a texel in the region.
    texel_px: [f32; 2],
}

impl OcclusionTargets {
    /// For maps of `size_px` texels over a region of `region_px` pixels, of up to `n_points` points.
    pub(crate) fn new(
        gpu: &Gpu,
        (size_px, region_px): (UVec2, UVec2),
        n_points: usize,
        n_receivers: u32,
    ) -> Self {
        let texture = |label, format, n_samples| {
            let shape = TextureShape {
                size_px: size_px.to_array(),
                format,
                n_samples,
            };
            Texture::target(gpu, label, shape)
        };
        let n_targets = n_points.div_ceil(POINTS_PER_TARGET as usize);
        Self {
            samples: texture("occlusion samples", FORMAT, N_SAMPLES),
            route: (n_receivers > 1).then(|| texture("occlusion route", ROUTE_FORMAT, N_SAMPLES)),
            hidden: (0..n_targets).map(|_| texture("occlusion", FORMAT, 1)).collect(),
            texel_px: (region_px.as_vec2() / size_px.as_vec2()).to_array(),
        }
    }
}

impl Occlusion {
    pub(crate) fn new(gpu: &Gpu, n_receivers: u32) -> Self {
        let module = gpu.module(&OCCLUSION);
        let stream = Stream::new(0, VertexFormat::Float32x3);
        let is_routed = n_receivers > 1;
        let cover = RenderShape {
            targets: &[Some(saturating())],
            n_samples: N_SAMPLES,
            depth: is_routed.then(|| stencil(CompareFunction::Equal, StencilOperation::Keep)),
            // Counter-clockwise seen from outside is so in the shadow, too: light and camera are above the receiver.
            culled: Some(Face::Back),
            constants: &[],
        };
        let cover_stages = Stages {
            vertex: "vs_flatten",
            fragment: "fs_cover",
            buffers: &[stream.layout()],
        };
        let route = RenderShape {
            targets: &[Some(ColorTargetState {
                write_mask: ColorWrites::empty(),
                ..FORMAT.into()
            })],
            depth: Some(stencil(CompareFunction::Always, StencilOperation::Replace)),
            culled: None,
            ..cover
        };
        let route_stages = Stages {
            vertex: "vs_route",
            fragment: "fs_route",
            buffers: &[],
        };
        Self {
            cover: gpu.render_pipeline(&OCCLUSION, &module, &cover_stages, &cover),
            route: is_routed.then(|| gpu.render_pipeline(&OCCLUSION, &module, &route_stages, &route)),
            n_receivers,
        }
    }

    /// Draws the caster from its points, 4 or a multiple of 16 on each receiver.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        caster: &Caster<'_>,
        targets: &OcclusionTargets,
    ) {
        let n_points = u32::try_from(caster.points.len()).unwrap_or(0) / self.n_receivers;
        let uniform = light_points_uniform(caster.points, n_points, targets.texel_px);
        let triangles = caster.triangles(n_points as usize);
        let points = gpu.uniform("light points", &uniform);
        let groups = |pipeline: &wgpu::RenderPipeline| {
            [(GROUP_GLOBALS, globals), (GROUP_PASS, &points)].map(|(group, buffer)| {
                let layout = pipeline.get_bind_group_layout(group);
                (group, gpu.bind(&layout, &[(0, buffer.as_entire_binding())]))
            })
        };
        let cover = groups(&self.cover);
        let route = self.route.as_ref().map(|pipeline| (pipeline, groups(pipeline)));
        let first_points = (0..n_points).step_by(POINTS_PER_TARGET as usize);
        for (first, hidden) in first_points.zip(&targets.hidden) {
            let colors = [Some(resolved(&targets.samples.view, &hidden.view))];
            let stencil = targets.route.as_ref().map(|route| &route.view);
            let mut render = encoder.render_routed(OCCLUSION.name, &colors, stencil);
            if let Some((pipeline, groups)) = &route {
                bind(&mut render, pipeline, groups);
                for receiver in 0..self.n_receivers {
                    render.set_stencil_reference(receiver + 1);
                    render.draw(0..3, receiver..receiver + 1);
                }
            }
            bind(&mut render, &self.cover, &cover);
            caster.toy.bind_positions(&mut render, &caster.pose.positions);
            for receiver in 0..self.n_receivers {
                render.set_stencil_reference(receiver + 1);
                let start = receiver * n_points + first;
                let instances = start..start + n_points.min(POINTS_PER_TARGET);
                render.draw_indexed(triangles.clone(), 0, instances);
            }
        }
    }
}

fn bind(
    render: &mut wgpu::RenderPass<'_>,
    pipeline: &wgpu::RenderPipeline,
    groups: &[(u32, wgpu::BindGroup)],
) {
    render.set_pipeline(pipeline);
    for (index, group) in groups {
        render.set_bind_group(*index, group, &[]);
    }
}

/// A target to which each fragment adds zeros and ones, up to one.
///
/// The largest of them would be the same; sums are what all phones blend in hardware.
fn saturating() -> ColorTargetState {
    let sum = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::One,
        operation: BlendOperation::Add,
    };
    ColorTargetState {
        format: FORMAT,
        blend: Some(BlendState {
            color: sum,
            alpha: sum,
        }),
        write_mask: ColorWrites::ALL,
    }
}

fn stencil(compare: CompareFunction, pass_op: StencilOperation) -> DepthStencilState {
    let face = StencilFaceState {
        compare,
        pass_op,
        ..StencilFaceState::IGNORE
    };
    DepthStencilState {
        format: ROUTE_FORMAT,
        depth_write_enabled: None,
        depth_compare: None,
        stencil: StencilState {
            front: face,
            back: face,
            read_mask: !0,
            write_mask: !0,
        },
        bias: wgpu::DepthBiasState::default(),
    }
}

fn light_points_uniform(points: &[Vec4], n_points: u32, texel_px: [f32; 2]) -> LightPoints {
    let mut uniform = LightPoints {
        points: [[0.0; 4]; MAX_LIGHT_POINTS * MAX_RECEIVERS],
        texel_px,
        n_points,
        _pad: 0,
    };
    for (slot, point) in uniform.points.iter_mut().zip(points) {
        *slot = point.to_array();
    }
    uniform
}

/// A posed toy and the light points that it hides.
pub(crate) struct Caster<'a> {
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pose: &'a PoseBuffers,
    /// Those in the space of the first receiver, then those of the next.
    pub(crate) points: &'a [Vec4],
}

impl Caster<'_> {
    /// What to draw of it, of which only triangles that face the light are seen.
    fn triangles(&self, n_points: usize) -> Range<u32> {
        let ranges = &self.toy.shadow_ranges;
        // The first receiver's space is the pose's own.
        let is_within = |point: &Vec4| self.pose.around.holds(point.as_dvec4());
        if self.points.iter().take(n_points).any(is_within) {
            ranges.both_sides.clone()
        } else {
            ranges.facing.clone()
        }
    }
}
