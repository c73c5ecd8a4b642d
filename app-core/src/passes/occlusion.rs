//! `occlusion`: shadows of the posed toy on the receivers from many light points, in one pass.

use std::ops::Range;

use glam::{UVec2, Vec4};
use wgpu::{CompareFunction, Face, VertexFormat};

use crate::counting::{CountingTargets, counting, not_counting, ordered};
use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::layout::{LightPoints, MAX_LIGHT_POINTS, MAX_RECEIVERS};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, RenderShape, Stages};
use crate::gpu::shaders::OCCLUSION;

use super::toy_mesh::{PoseBuffers, Stream, ToyMesh};

/// The pass for a number of receivers.
pub(crate) struct Occlusion {
    cover: wgpu::RenderPipeline,
    /// Shuts out pixels that show another receiver, where there are several.
    route: Option<wgpu::RenderPipeline>,
    n_receivers: u32,
}

/// Targets for maps of one size.
pub(crate) struct OcclusionTargets {
    /// What hidden points add up to.
    pub(crate) hidden: CountingTargets,
    /// Size of a texel in the region.
    texel_px: [f32; 2],
}

impl OcclusionTargets {
    /// For maps of `size_px` texels over a region of `region_px` pixels.
    pub(crate) fn new(gpu: &Gpu, size_px: UVec2, region_px: UVec2) -> Self {
        Self {
            hidden: CountingTargets::new(gpu, "occlusion", size_px),
            texel_px: (region_px.as_vec2() / size_px.as_vec2()).to_array(),
        }
    }
}

impl Occlusion {
    pub(crate) fn new(gpu: &Gpu, n_receivers: u32) -> Self {
        let module = gpu.module(&OCCLUSION);
        let stream = Stream::new(0, VertexFormat::Float32x3);
        let cover = RenderShape {
            targets: &[Some(counting())],
            n_samples: 1,
            depth: Some(ordered(CompareFunction::Greater)),
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
            targets: &[Some(not_counting())],
            depth: Some(ordered(CompareFunction::Always)),
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
            route: (n_receivers > 1).then(|| gpu.render_pipeline(&OCCLUSION, &module, &route_stages, &route)),
            n_receivers,
        }
    }

    /// Draws the caster from its points: 4 or a multiple of 16, up to 64, on each receiver.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        globals: &wgpu::Buffer,
        caster: &Caster<'_>,
        targets: &OcclusionTargets,
    ) {
        let n_points = u32::try_from(caster.points.len()).unwrap_or(0) / self.n_receivers.max(1);
        let uniform = light_points_uniform(caster.points, n_points, targets.texel_px);
        let points = gpu.uniform("light points", &uniform);
        let groups = |pipeline: &wgpu::RenderPipeline| {
            [(GROUP_GLOBALS, globals), (GROUP_PASS, &points)].map(|(group, buffer)| {
                let layout = pipeline.get_bind_group_layout(group);
                (group, gpu.bind(&layout, &[(0, buffer.as_entire_binding())]))
            })
        };
        let cover = groups(&self.cover);
        let route = self.route.as_ref().map(|pipeline| (pipeline, groups(pipeline)));
        let triangles = caster.triangles(n_points as usize);
        let mut render = targets.hidden.render(encoder, OCCLUSION.name);
        caster.toy.bind_positions(&mut render, &caster.pose.positions);
        for receiver in 0..self.n_receivers {
            if let Some((pipeline, groups)) = &route {
                bind(&mut render, pipeline, groups);
                render.draw(0..3, receiver..receiver + 1);
            }
            bind(&mut render, &self.cover, &cover);
            let instances = receiver * n_points..(receiver + 1) * n_points;
            render.draw_indexed(triangles.clone(), 0, instances);
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
        // The first receiver's space is the pose's own.
        let is_within = |point: &Vec4| self.pose.around.holds(point.as_dvec4());
        let is_any = self.points.iter().take(n_points).any(is_within);
        self.toy.shadow_ranges.seen_from(is_any)
    }
}
