//! `warp`: for each texel of the new shadow, the position in the frame of its vertex's real shadow.

use wgpu::{StoreOp, TextureFormat, VertexFormat};

use crate::baseline::plan::BaselinePlan;
use crate::gpu::{
    Buffer, Draw, DrawSpec, GROUP_SCENE, Gpu, Recorder, Shader, Stream, Texture, TextureLayers, cleared,
    nearest_surface, shader,
};
use crate::passes::globals::GLOBALS_GROUP;
use crate::passes::toy_mesh::{PoseBuffers, ToyMesh};
use app_scene::scene::MAX_RECEIVERS;

pub(crate) const SHADER: Shader = shader!("baseline/warp");
/// Vertices of the shown pose, which is drawn, and of the physical one.
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3), (1, VertexFormat::Float32x3)];
/// Format of the warp: source position and height need more precision than f16 has.
const FORMAT: TextureFormat = TextureFormat::Rgba32Float;
/// Instances per light, one per receiver.
#[allow(clippy::cast_possible_truncation, reason = "a handful")]
const N_SLOTS: u32 = MAX_RECEIVERS as u32;

pub(crate) struct Pass {
    draw: Draw,
}

/// The shadow that a posed toy casts from one light.
pub(crate) struct Inputs<'a> {
    pub(crate) globals: &'a Buffer,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) pose: &'a PoseBuffers,
    pub(crate) light: u32,
    pub(crate) n_receivers: u32,
}

/// Targets of the region's size.
pub(crate) struct Targets {
    /// One layer per light.
    pub(crate) maps: TextureLayers,
    depth: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &BaselinePlan) -> Self {
        let size_px = plan.region.size_px;
        Self {
            maps: TextureLayers::targets(gpu, "warp", (size_px, plan.n_lights), FORMAT),
            depth: Texture::target(gpu, "warp depth", size_px, TextureFormat::Depth32Float),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, &[], &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec {
                vertex: "vs_warp",
                streams: STREAMS,
                depth: Some(nearest_surface()),
                ..DrawSpec::fullscreen(&SHADER, "fs_source", groups, &[FORMAT])
            }),
        }
    }

    /// Warps the shadow on each receiver into the light's layer.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let Some(layer) = targets.maps.layers.get(inputs.light as usize) else {
            return;
        };
        let group = recorder.bind(&self.draw, GROUP_SCENE, &[inputs.globals.into()]);
        let (colors, depth) = ([Some(cleared(layer))], Some(&targets.depth.view));
        let mut render = recorder.render(SHADER.name, &colors, depth, StoreOp::Discard);
        render.begin(&self.draw, &[group]);
        let toy = inputs.toy;
        render.set_vertices(1, &toy.physical.positions);
        let first = inputs.light * N_SLOTS;
        let instances = first..first + inputs.n_receivers;
        toy.draw_positions(&mut render, &inputs.pose.positions, instances);
    }
}
