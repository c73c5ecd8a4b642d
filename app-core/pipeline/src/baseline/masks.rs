//! `masks`: the paper's mask 3a: the pixels in which the camera sees the physical toy.

use wgpu::{StoreOp, TextureFormat, VertexFormat};

use crate::baseline::plan::BaselinePlan;
use crate::gpu::{
    Buffer, Draw, DrawSpec, GROUP_SCENE, Gpu, Recorder, Shader, Stream, Texture, cleared, shader,
};
use crate::passes::globals::GLOBALS_GROUP;
use crate::passes::toy_mesh::ToyMesh;

pub(crate) const SHADER: Shader = shader!("baseline/masks");
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3)];
const FORMAT: TextureFormat = TextureFormat::R8Unorm;

pub(crate) struct Pass {
    draw: Draw,
}

/// Targets of the region's size.
pub(crate) struct Targets {
    pub(crate) mask: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &BaselinePlan) -> Self {
        Self {
            mask: Texture::target(gpu, "masks", plan.region.size_px, FORMAT),
        }
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [GLOBALS_GROUP, &[], &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec {
                vertex: "vs_project",
                streams: STREAMS,
                ..DrawSpec::fullscreen(&SHADER, "fs_set", groups, &[FORMAT])
            }),
        }
    }

    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        globals: &Buffer,
        toy: &ToyMesh,
        targets: &Targets,
    ) {
        let group = recorder.bind(&self.draw, GROUP_SCENE, &[globals.into()]);
        let colors = [Some(cleared(&targets.mask.view))];
        let mut render = recorder.render(SHADER.name, &colors, None, StoreOp::Discard);
        render.begin(&self.draw, &[group]);
        toy.draw_positions(&mut render, &toy.physical.positions, 0..1);
    }
}
