//! `masks`: the paper's mask 3a, where the camera sees the physical toy.

use wgpu::{StoreOp, TextureFormat, VertexFormat};

use crate::baseline::plan::BaselinePlan;
use crate::gpu::bindings::GROUP_SCENE;
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, Stream};
use crate::gpu::recorder::{Recorder, cleared};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::Texture;
use crate::passes::globals::GLOBALS_GROUP;
use crate::passes::toy_mesh::ToyMesh;

pub(crate) const SHADER: Shader = shader!("baseline/masks");
const STREAMS: &[Stream] = &[(0, VertexFormat::Float32x3)];
const FORMAT: TextureFormat = TextureFormat::R8Unorm;

pub(crate) struct Pass {
    draw: Draw,
}

/// Of the region's size.
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
