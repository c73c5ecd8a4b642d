//! `occlusion`: shadows of the posed toy on the receivers from many light points, in one pass.

use glam::{UVec2, Vec4};
use wgpu::{CompareFunction, VertexFormat};

use crate::geometry::rect::PixelRect;
use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, Stream};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Part, Shader, part};
use crate::gpu::shared::shared_struct;
use crate::model::plan::Plan;
use crate::passes::counting::{CountingDraws, CountingTargets, TILES, counting, not_counting, ordered};
use crate::passes::globals::{GLOBALS, GLOBALS_GROUP, GlobalsOnDevice};
use crate::passes::parts::FLATTEN;
use crate::passes::toy_mesh::{Detail, PoseBuffers, Saves, Side, SilhouetteTarget, ToyMesh};
use crate::scene::MAX_RECEIVERS;

/// Increment per hidden light point.
pub(crate) const HIDDEN: Part = part!("common/hidden");
pub(crate) const SHADER: Shader = Shader::new(&[
    &GLOBALS,
    &FLATTEN,
    &HIDDEN,
    &TILES,
    &part!("lighting/occlusion", structs: [LightPoints]),
]);
const SLOTS: &[Slot] = &[Slot::uniform::<LightPoints>()];
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3)];
/// Maximum number of light points of one pass: each adds three codes, and 255 is the last.
pub(crate) const MAX_LIGHT_POINTS: usize = 64;

shared_struct! {
    /// Points of a light, receiver by receiver.
    pub(crate) struct LightPoints {
        pub points: [[f32; 4]; MAX_LIGHT_POINTS * MAX_RECEIVERS],
        pub texel_px: [f32; 2],
        pub n_points: u32,
        pub _pad: u32,
    }
}

impl LightPoints {
    /// For maps of `size_px` texels over a region of `region_px` pixels. `points` are a multiple of 16, up to 64, in the
    /// space of the first receiver, then those of the next.
    fn new(points: &[Vec4], n_points: u32, (size_px, region_px): (UVec2, UVec2)) -> Self {
        let mut light_points = Self {
            points: [[0.0; 4]; MAX_LIGHT_POINTS * MAX_RECEIVERS],
            texel_px: (region_px.as_vec2() / size_px.as_vec2()).to_array(),
            n_points,
            _pad: 0,
        };
        for (slot, point) in light_points.points.iter_mut().zip(points) {
            *slot = point.to_array();
        }
        light_points
    }
}

/// The points of one light, on the device.
pub(crate) struct LightPointsBuffer {
    /// Those in the space of the first receiver, then those of the next.
    pub(crate) points: Vec<Vec4>,
    /// Points of the light; each is in `points` once per receiver.
    pub(crate) n_points: u32,
    /// Size of the maps and of the region, in texels and pixels.
    sizes: (UVec2, UVec2),
    uniform: Buffer,
}

impl LightPointsBuffer {
    /// `sizes` are those of the maps, in texels, and of the region, in pixels.
    pub(crate) fn new(gpu: &Gpu, points: Vec<Vec4>, n_receivers: u32, sizes: (UVec2, UVec2)) -> Self {
        let n_points = u32::try_from(points.len()).unwrap_or(0) / n_receivers.max(1);
        Self {
            uniform: gpu.uniform("light points", &LightPoints::new(&points, n_points, sizes)),
            points,
            n_points,
            sizes,
        }
    }

    /// Replaces the points by as many.
    pub(crate) fn write(&mut self, gpu: &Gpu, points: Vec<Vec4>) {
        gpu.write(
            &self.uniform,
            &[LightPoints::new(&points, self.n_points, self.sizes)],
        );
        self.points = points;
    }

    /// The points in anchor space, which is that of the first receiver.
    pub(crate) fn in_anchor(&self) -> &[Vec4] {
        &self.points[..self.n_points as usize]
    }
}

/// Counts of hidden points, of each light and of the ambient light.
pub(crate) struct Targets {
    pub(crate) lights: Vec<CountingTargets>,
    pub(crate) ambient: CountingTargets,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            lights: (0..plan.n_lights)
                .map(|_| CountingTargets::new(gpu, "occlusion", plan.region.size_px))
                .collect(),
            ambient: CountingTargets::new(gpu, "occlusion", plan.ambient_px),
        }
    }
}

pub(crate) struct Pass {
    cover: CountingDraws,
    /// Masks pixels that show another receiver, where there are several.
    route: Draw,
}

/// A posed toy, and the points of a light whose occlusion is tested.
pub(crate) struct Inputs<'a> {
    pub(crate) globals: GlobalsOnDevice<'a>,
    pub(crate) n_receivers: u32,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pose: &'a PoseBuffers,
    pub(crate) light: &'a LightPointsBuffer,
    /// What casts the shadow.
    pub(crate) caster: Detail,
    /// Which light it is; none of what comes from all sides.
    pub(crate) side: Option<Side>,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, SLOTS, &[], &[]];
        let cover = DrawSpec {
            vertex: "vs_flatten",
            streams: STREAMS,
            targets: vec![counting()],
            depth: Some(ordered(CompareFunction::Greater)),
            ..DrawSpec::fullscreen(&SHADER, "fs_cover", groups, &[])
        };
        let route = DrawSpec {
            vertex: "vs_route",
            targets: vec![not_counting()],
            depth: Some(ordered(CompareFunction::Always)),
            ..DrawSpec::fullscreen(&SHADER, "fs_route", groups, &[])
        };
        Self {
            // Counter-clockwise seen from outside is so in the shadow, too: light and camera are above the receiver.
            cover: CountingDraws::new(gpu, &cover),
            route: gpu.draw(&route),
        }
    }

    /// Draws the caster from the light's points on each receiver, and counts the hidden points in the target.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &CountingTargets) {
        let of_pose = (inputs.pose, inputs.side);
        let points = (inputs.light.in_anchor(), inputs.caster);
        let projection = inputs.globals.uniform.onto_first_receiver(points.0);
        // Each receiver would have silhouettes of its own.
        let projection = projection.filter(|_| inputs.n_receivers == 1);
        let target = projection.as_ref().map(|projection| SilhouetteTarget {
            projection,
            part: PixelRect {
                origin_px: UVec2::ZERO,
                size_px: targets.count.size_px(),
            },
            saves: Saves::Triangles,
        });
        let corners = inputs.toy.corners(recorder.gpu, of_pose, points, target);
        let cover = self.cover.any();
        let groups = [
            recorder.bind(cover, GROUP_SCENE, &[inputs.globals.buffer.into()]),
            recorder.bind(cover, GROUP_PASS, &[(&inputs.light.uniform).into()]),
        ];
        let (n_receivers, n_points) = (inputs.n_receivers, inputs.light.n_points);
        let mut render = targets.render(recorder, SHADER.name);
        let drawn = (&corners, inputs.pose);
        for receiver in 0..n_receivers {
            if n_receivers > 1 {
                render.begin(&self.route, &groups);
                render.draw(0..3, receiver..receiver + 1);
            }
            let instances = receiver * n_points..(receiver + 1) * n_points;
            let n_plain = inputs.n_whole_shadows(receiver);
            self.cover
                .count(&mut render, &groups, drawn, (instances, n_plain));
        }
    }
}

impl Inputs<'_> {
    /// Points of the light, from the first on, whose shadows of the toy on a receiver need not be cut off.
    fn n_whole_shadows(&self, receiver: u32) -> u32 {
        let points = self
            .light
            .points
            .chunks(self.light.n_points.max(1) as usize)
            .nth(receiver as usize);
        let globals = self.globals.uniform;
        let n_whole =
            globals.n_whole_shadows(receiver as usize, points.unwrap_or_default(), &self.pose.around);
        u32::try_from(n_whole).unwrap_or(0)
    }
}
