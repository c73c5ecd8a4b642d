//! `occlusion`: visibility of the lights behind the posed toy, from its shadows on the receivers
//! for many points of each light, in one pass.

use glam::{UVec2, Vec4};
use wgpu::{BlendOperation, Color, CompareFunction, TextureFormat, VertexFormat};

use crate::geometry::rect::PixelRect;
use crate::gpu::bindings::{GROUP_PASS, GROUP_SCENE, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, Stream, multiplied};
use crate::gpu::recorder::{Recorder, cleared_to};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::{Texture, TextureView, fractions, half_float};
use crate::model::plan::Plan;
use crate::passes::counting::{CountingDraws, InstanceOrder, counting, not_counting, ordered};
use crate::passes::globals::{GLOBALS_GROUP, GlobalsOnDevice};
use crate::passes::toy_mesh::{
    CasterLod, Corners, PoseBuffers, Savings, SeenToy, Side, SilhouetteTarget, ToyMesh,
};
use app_scene::scene::{MAX_LIGHTS, MAX_RECEIVERS};

pub(crate) const SHADER: Shader =
    shader!("lighting/occlusion", structs: [LightPoints], constants: [MOST_POINTS]);
const SLOTS: &[Slot] = &[Slot::uniform::<LightPoints>()];
const UPRIGHT_SLOTS: &[Slot] = &[Slot::uniform::<LightPoints>(), Slot::Texture];
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3)];
/// Maximum number of points of one light.
pub(crate) const MAX_LIGHT_POINTS: usize = 64;
/// Maximum number of points of all lights that one pass draws into a map.
#[allow(clippy::cast_possible_truncation, reason = "some hundreds")]
const MOST_POINTS: u32 = (MAX_LIGHTS * MAX_LIGHT_POINTS) as u32;

shared_struct! {
    /// Points of a light, receiver by receiver.
    pub(crate) struct LightPoints {
        pub points: [[f32; 4]; MAX_LIGHT_POINTS * MAX_RECEIVERS],
        pub share: [f32; 4],
        pub texel_px: [f32; 2],
        pub n_points: u32,
        pub n_before: u32,
    }
}

impl LightPoints {
    /// Takes `points`: 16, 32 or 64 in the space of the first receiver, then those of the next.
    fn new(points: &[Vec4], n_points: u32, part: &PartOfMap) -> Self {
        let (size_px, region_px) = part.sizes;
        let mut light_points = Self {
            points: [[0.0; 4]; MAX_LIGHT_POINTS * MAX_RECEIVERS],
            share: part.share(n_points),
            texel_px: (region_px.as_vec2() / size_px.as_vec2()).to_array(),
            n_points,
            n_before: part.n_before(),
        };
        for (slot, point) in light_points.points.iter_mut().zip(points) {
            *slot = point.to_array();
        }
        light_points
    }
}

/// Place in a map to which a light's visibility is written.
#[derive(Clone, Copy)]
pub(crate) struct PartOfMap {
    /// Sizes of the map in texels, and of the region in pixels.
    sizes: (UVec2, UVec2),
    format: TextureFormat,
    channel: usize,
}

impl PartOfMap {
    /// A light's own channel, in 8 bits: it has at most 64 points.
    pub(crate) fn of_light(plan: &Plan, channel: usize) -> Self {
        Self {
            sizes: (plan.region.size_px, plan.region.size_px),
            format: fractions(plan.n_channels()),
            channel,
        }
    }

    /// The ambient light's map.
    pub(crate) fn of_ambient(plan: &Plan) -> Self {
        Self {
            sizes: (plan.ambient_px, plan.region.size_px),
            format: AMBIENT_FORMAT,
            channel: 0,
        }
    }

    /// Number of points that the lights before it in the map may have.
    #[allow(clippy::cast_possible_truncation, reason = "some hundreds")]
    const fn n_before(&self) -> u32 {
        (MAX_LIGHT_POINTS * self.channel) as u32
    }

    /// Allocates the map that contains this part.
    fn map(&self, gpu: &Gpu, label: &str) -> Texture {
        Texture::target(gpu, label, self.sizes.0, self.format)
    }

    /// Amount that each of `n_points` subtracts from the visibility, in the light's channel.
    ///
    /// With 8 bits it is a whole code, and all points together take all 255: for 16, 32 and 64
    /// points the error is below 1/255. Floats of 16 bits are exact.
    fn share(&self, n_points: u32) -> [f32; 4] {
        let n_points = n_points.max(1);
        let of_each = if self.format == AMBIENT_FORMAT {
            1.0 / n_points as f32
        } else {
            255_u32.div_ceil(n_points) as f32 / 255.0
        };
        let mut share = [0.0; 4];
        if let Some(channel) = share.get_mut(self.channel) {
            *channel = of_each;
        }
        share
    }
}

/// The points of one light, on the device.
pub(crate) struct LightPointsBuffer {
    /// Points in the space of the first receiver, then those in the space of the next.
    pub(crate) points: Vec<Vec4>,
    /// Points of the light; each is in `points` once per receiver.
    pub(crate) n_points: u32,
    part: PartOfMap,
    uniform: Buffer,
}

impl LightPointsBuffer {
    pub(crate) fn new(gpu: &Gpu, points: Vec<Vec4>, n_receivers: u32, part: PartOfMap) -> Self {
        let n_points = n_each(&points, n_receivers);
        Self {
            uniform: gpu.uniform("light points", &LightPoints::new(&points, n_points, &part)),
            points,
            n_points,
            part,
        }
    }

    /// Replaces the points, for the same number of receivers.
    pub(crate) fn write(&mut self, gpu: &Gpu, points: Vec<Vec4>, n_receivers: u32) {
        self.n_points = n_each(&points, n_receivers);
        let light_points = LightPoints::new(&points, self.n_points, &self.part);
        gpu.write(&self.uniform, &[light_points]);
        self.points = points;
    }

    /// The points in the space of each receiver in turn.
    pub(crate) fn by_receiver(&self) -> impl Iterator<Item = &[Vec4]> {
        self.points.chunks(self.n_points.max(1) as usize)
    }

    /// The points in anchor space, which is that of the first receiver.
    pub(crate) fn in_anchor(&self) -> &[Vec4] {
        &self.points[..self.n_points as usize]
    }
}

/// Number of points of a light for each receiver.
fn n_each(points: &[Vec4], n_receivers: u32) -> u32 {
    u32::try_from(points.len()).unwrap_or(0) / n_receivers.max(1)
}

/// Format of the ambient light's visibility at a reduced resolution: 16 bits are the most that all
/// drivers can filter.
const AMBIENT_FORMAT: TextureFormat = half_float(1);

/// Visibility maps of one pose.
pub(crate) struct Targets {
    /// One channel per light. If the first receiver reflects, one more has the share of its
    /// reflection that the toy does not hide.
    pub(crate) lights: Texture,
    pub(crate) ambient: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        Self {
            lights: PartOfMap::of_light(plan, 0).map(gpu, "visibility"),
            ambient: PartOfMap::of_ambient(plan).map(gpu, "ambient"),
        }
    }
}

/// Index of the point that was drawn last, over the region and over the ambient map.
pub(crate) struct Orders {
    pub(crate) lights: InstanceOrder,
    pub(crate) ambient: InstanceOrder,
}

impl Orders {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let order = |size_px| InstanceOrder::new(gpu, "occlusion order", size_px);
        Self {
            lights: order(plan.region.size_px),
            ambient: order(plan.ambient_px),
        }
    }
}

/// Formats of the maps: ambient light, one light, two lights, more lights.
const FORMATS: [TextureFormat; 4] = [AMBIENT_FORMAT, fractions(1), fractions(2), fractions(MAX_LIGHTS)];

pub(crate) struct Pass {
    of_formats: [(TextureFormat, Draws); FORMATS.len()],
}

struct Draws {
    cover: CountingDraws,
    /// Masks pixels that show another receiver, if there are several.
    route: Draw,
    /// Takes from upright receivers the light of the level ones that the toy's shadows take; for
    /// the ambient light alone.
    upright: Option<Draw>,
}

impl Draws {
    fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        let groups = [GLOBALS_GROUP, SLOTS, &[], &[]];
        let visibility = counting(format, BlendOperation::ReverseSubtract);
        let route = DrawSpec {
            vertex: "vs_route",
            targets: vec![not_counting(&visibility)],
            depth: Some(ordered(CompareFunction::Always)),
            ..DrawSpec::fullscreen(&SHADER, "fs_route", groups, &[])
        };
        let cover = DrawSpec {
            vertex: "vs_flatten",
            streams: STREAMS,
            targets: vec![visibility],
            depth: Some(ordered(CompareFunction::Greater)),
            ..DrawSpec::fullscreen(&SHADER, "fs_cover", groups, &[])
        };
        let upright = DrawSpec {
            targets: vec![multiplied(format)],
            depth: Some(ordered(CompareFunction::Always)),
            ..DrawSpec::fullscreen(
                &SHADER,
                "fs_upright",
                [GLOBALS_GROUP, UPRIGHT_SLOTS, &[], &[]],
                &[],
            )
        };
        Self {
            upright: (format == AMBIENT_FORMAT).then(|| gpu.draw(&upright)),
            // A face that is counter-clockwise from outside is counter-clockwise in the shadow,
            // too: light and camera are above the receiver.
            cover: CountingDraws::new(gpu, &cover),
            route: gpu.draw(&route),
        }
    }
}

/// A posed toy that casts shadows.
pub(crate) struct Inputs<'a> {
    pub(crate) globals: GlobalsOnDevice<'a>,
    pub(crate) n_receivers: u32,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pose: &'a PoseBuffers,
    /// The mesh that casts the shadow.
    pub(crate) caster: CasterLod,
    /// Visibilities of the lights in this pose, for the ambient light of upright receivers.
    pub(crate) shadows: Option<&'a TextureView>,
}

/// A light from which shadows are drawn.
#[derive(Clone, Copy)]
pub(crate) struct Light<'a> {
    pub(crate) points: &'a LightPointsBuffer,
    /// The side that faces it; `None` for ambient light.
    pub(crate) side: Option<Side>,
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            of_formats: FORMATS.map(|format| (format, Draws::new(gpu, format))),
        }
    }

    /// Draws the caster from the lights' points on each receiver, and subtracts the hidden points
    /// from each light's channel of the map.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        inputs: &Inputs<'_>,
        lights: &[Light<'_>],
        map: &Texture,
        order: &InstanceOrder,
    ) {
        let Some((_, draws)) = self.of_formats.iter().find(|(format, _)| *format == map.format()) else {
            return;
        };
        let cover = draws.cover.any();
        let bound = |points: &LightPointsBuffer| {
            [
                recorder.bind(cover, GROUP_SCENE, &[inputs.globals.buffer.into()]),
                recorder.bind(cover, GROUP_PASS, &[(&points.uniform).into()]),
            ]
        };
        let corners = |light| inputs.corners(recorder.gpu, light, map.size_px());
        let drawn: Vec<_> = lights
            .iter()
            .map(|light| (light.points, bound(light.points), corners(*light)))
            .collect();
        let upright = draws.upright.as_ref().zip(inputs.shadows).map(|(draw, shadows)| {
            let points = lights.first().map(|light| (&light.points.uniform).into());
            let resources: Vec<_> = points.into_iter().chain([shadows.into()]).collect();
            let groups = [
                recorder.bind(draw, GROUP_SCENE, &[inputs.globals.buffer.into()]),
                recorder.bind(draw, GROUP_PASS, &resources),
            ];
            (draw, groups)
        });
        let mut render = order.render(recorder, SHADER.name, cleared_to(&map.view, Color::WHITE));
        for (points, groups, corners) in drawn {
            for receiver in 0..inputs.n_receivers {
                if inputs.n_receivers > 1 {
                    render.begin(&draws.route, &groups);
                    render.draw(0..3, receiver..receiver + 1);
                }
                let instances = receiver * points.n_points..(receiver + 1) * points.n_points;
                let n_plain = inputs.n_whole_shadows(points, receiver);
                let drawn = (&corners, inputs.pose);
                draws.cover.count(&mut render, &groups, drawn, instances, n_plain);
            }
        }
        if let Some((draw, groups)) = &upright {
            render.begin(draw, groups);
            render.draw(0..3, 0..1);
        }
    }
}

impl<'a> Inputs<'a> {
    /// Corners to draw for a light onto a map of this size in texels.
    fn corners(&self, gpu: &Gpu, light: Light<'a>, map_px: UVec2) -> Corners<'a> {
        let points = light.points.in_anchor();
        let projection = self.globals.uniform.onto_receiver(0, points);
        // Each receiver would have silhouettes in another space.
        let projection = projection.filter(|_| self.n_receivers == 1);
        let target = projection.as_ref().map(|projection| SilhouetteTarget {
            projection,
            part: PixelRect {
                origin_px: UVec2::ZERO,
                size_px: map_px,
            },
            savings: Savings::Triangles,
        });
        let seen = SeenToy {
            pose: self.pose,
            side: light.side,
            points,
            lod: self.caster,
        };
        self.toy.corners(gpu, &seen, target)
    }

    /// Number of a light's points, from the first on, whose shadows of the toy on a receiver need
    /// no clipping.
    fn n_whole_shadows(&self, light: &LightPointsBuffer, receiver: u32) -> u32 {
        let points = light.by_receiver().nth(receiver as usize);
        let globals = self.globals.uniform;
        let n_whole =
            globals.n_whole_shadows(receiver as usize, points.unwrap_or_default(), &self.pose.around);
        u32::try_from(n_whole).unwrap_or(0)
    }
}
