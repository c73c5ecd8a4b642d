//! `retarget`: the published picture: plate in the masks, the new shadow over it, the toy by projective texturing.

use wgpu::{CompareFunction, DepthStencilState, StoreOp, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, resolved};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, RenderShape, Stages, nearest_surface, view};
use crate::gpu::shaders::RETARGET;

use super::composite::PICTURE_FORMAT;
use super::toy_mesh::{Stream, ToyMesh};

/// Multisampling of the toy's silhouette.
pub(crate) const N_SAMPLES: u32 = 4;

pub(crate) struct Retarget {
    receiver: wgpu::RenderPipeline,
    toy: wgpu::RenderPipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct RetargetInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) published: &'a wgpu::Buffer,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plate: &'a wgpu::TextureView,
    pub(crate) masks: &'a wgpu::TextureView,
    pub(crate) eligible: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) terms: &'a wgpu::TextureView,
}

/// Textures of the region's size: two multisampled ones that stay on the chip, and the picture.
pub(crate) struct RetargetTargets<'a> {
    pub(crate) samples: &'a wgpu::TextureView,
    pub(crate) depth: &'a wgpu::TextureView,
    pub(crate) picture: &'a wgpu::TextureView,
}

impl Retarget {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let module = gpu.module(&RETARGET);
        let streams = [
            Stream::new(0, VertexFormat::Float32x3),
            Stream::new(1, VertexFormat::Float32x3),
        ];
        let buffers: Vec<_> = streams.iter().map(Stream::layout).collect();
        let receiver = Stages {
            vertex: "vs_fullscreen",
            fragment: "fs_receiver",
            buffers: &[],
        };
        let toy = Stages {
            vertex: "vs_toy",
            fragment: "fs_toy",
            buffers: &buffers,
        };
        Self {
            receiver: gpu.render_pipeline(&RETARGET, &module, &receiver, &picture_shape(behind_all())),
            toy: gpu.render_pipeline(&RETARGET, &module, &toy, &picture_shape(nearest_surface())),
            linear: gpu.linear_sampler(),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        toy: &ToyMesh,
        inputs: &RetargetInputs<'_>,
        targets: &RetargetTargets<'_>,
    ) {
        let globals = (0, inputs.globals.as_entire_binding());
        let published = (2, inputs.published.as_entire_binding());
        let receiver_shared = gpu.bind(
            &self.receiver.get_bind_group_layout(GROUP_GLOBALS),
            &[globals.clone(), published],
        );
        let toy_shared = gpu.bind(&self.toy.get_bind_group_layout(GROUP_GLOBALS), &[globals]);
        let receiver_own = gpu.bind(
            &self.receiver.get_bind_group_layout(GROUP_PASS),
            &[
                (0, view(inputs.frame)),
                (1, view(inputs.plate)),
                (2, view(inputs.masks)),
                (3, view(inputs.visibility)),
                (4, view(inputs.terms)),
                (6, view(inputs.eligible)),
            ],
        );
        let toy_own = gpu.bind(
            &self.toy.get_bind_group_layout(GROUP_PASS),
            &[
                (0, view(inputs.frame)),
                (5, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        );
        let colors = [Some(resolved(targets.samples, targets.picture))];
        let mut render = encoder.render(RETARGET.name, &colors, Some(targets.depth), StoreOp::Discard);
        render.set_pipeline(&self.receiver);
        render.set_bind_group(GROUP_GLOBALS, &receiver_shared, &[]);
        render.set_bind_group(GROUP_PASS, &receiver_own, &[]);
        render.draw(0..3, 0..1);
        render.set_pipeline(&self.toy);
        render.set_bind_group(GROUP_GLOBALS, &toy_shared, &[]);
        render.set_bind_group(GROUP_PASS, &toy_own, &[]);
        render.set_vertex_buffer(1, toy.physical.positions.slice(..));
        toy.draw_positions(&mut render, &toy.shown.positions, 0..1);
    }
}

const PICTURE_TARGETS: [Option<wgpu::ColorTargetState>; 1] = [Some(wgpu::ColorTargetState {
    format: PICTURE_FORMAT,
    blend: None,
    write_mask: wgpu::ColorWrites::ALL,
})];

fn picture_shape(depth: DepthStencilState) -> RenderShape<'static> {
    RenderShape {
        targets: &PICTURE_TARGETS,
        n_samples: N_SAMPLES,
        depth: Some(depth),
        culled: None,
        constants: &[],
    }
}

/// For what is drawn before all else and hides nothing.
fn behind_all() -> DepthStencilState {
    DepthStencilState {
        depth_write_enabled: Some(false),
        depth_compare: Some(CompareFunction::Always),
        ..nearest_surface()
    }
}
