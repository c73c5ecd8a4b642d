//! `gbuffer`: the physical toy in the camera's view: base colour, normal, received light and depth.

use glam::Vec3;
use wgpu::{Face, StoreOp, TextureFormat};

use crate::gpu::bindings::GROUP_SCENE;
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, nearest_surface};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::Texture;
use crate::model::lighting::self_shadow;
use crate::model::lighting::self_shadow::{GROUP_SELF_SHADOW, SELF_SHADOW_GROUP};
use crate::model::plan::Plan;
use crate::passes::globals::GLOBALS_GROUP;
use crate::passes::materials::MATERIAL_GROUP;
use crate::passes::toy_mesh::{LOOK_STREAMS, Sided, ToyMesh};

pub(crate) const SHADER: Shader = shader!("capture/gbuffer");
/// Format of the base colour, whose alpha is the part of the surface's view above the horizon.
pub(crate) const BASE_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Format of the normals.
const NORMAL_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
/// Format of each light's cosine times its visibility, which is from 0 to 1.
pub(crate) const RECEIVED_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

pub(crate) struct Pass {
    /// Draws with both sides of each triangle, or with the side that faces the camera.
    draws: [Draw; 2],
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) camera_in_anchor: Vec3,
    pub(crate) globals: &'a Buffer,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) self_shadow: &'a self_shadow::Targets,
}

/// Targets of the physical box's size.
pub(crate) struct Targets {
    pub(crate) base: Texture,
    pub(crate) normal: Texture,
    pub(crate) received: Texture,
    pub(crate) depth: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let target = |label, format| Texture::target(gpu, label, plan.physical_box.size_px, format);
        Self {
            base: target("gbuffer base", BASE_FORMAT),
            normal: target("gbuffer normal", NORMAL_FORMAT),
            received: target("gbuffer received", RECEIVED_FORMAT),
            depth: target("gbuffer depth", TextureFormat::Depth32Float),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, &[], MATERIAL_GROUP, SELF_SHADOW_GROUP];
        let targets = [BASE_FORMAT, NORMAL_FORMAT, RECEIVED_FORMAT];
        let draw = |culled| {
            gpu.draw(&DrawSpec {
                vertex: "vs_project",
                streams: &LOOK_STREAMS,
                depth: Some(nearest_surface()),
                culled,
                ..DrawSpec::fullscreen(&SHADER, "fs_describe", groups, &targets)
            })
        };
        Self {
            draws: [None, Some(Face::Back)].map(draw),
        }
    }

    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let maps = inputs.self_shadow.resources(recorder.gpu, inputs.self_shadow);
        let [draw, culled] = &self.draws;
        let groups = [
            recorder.bind(draw, GROUP_SCENE, &[inputs.globals.into()]),
            recorder.bind(draw, GROUP_SELF_SHADOW, &maps),
        ];
        let materials = inputs.toy.bind_materials(recorder, draw);
        let colors = [&targets.base, &targets.normal, &targets.received];
        let colors = colors.map(|texture| Some(cleared(&texture.view)));
        let mut render = recorder.render(SHADER.name, &colors, Some(&targets.depth.view), StoreOp::Store);
        render.part_of(inputs.plan.part_drawn(&inputs.plan.physical_box));
        let sided = Sided {
            both: draw,
            culled,
            groups: &groups,
            camera_in_anchor: inputs.camera_in_anchor,
        };
        let toy = inputs.toy;
        toy.draw_parts(&mut render, &sided, &[&toy.physical], &materials);
    }
}
