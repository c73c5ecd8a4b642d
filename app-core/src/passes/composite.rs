//! `composite`: plate times new shadow, real toy and real shadow gone, animated toy with its camera pixels.

use wgpu::{CompareFunction, DepthStencilState, StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, resolved};
use crate::gpu::pipeline::{GROUP_GLOBALS, GROUP_PASS, RenderShape, Stages, nearest_surface, view};
use crate::gpu::shaders::COMPOSITE;

use super::toy_mesh::{Stream, ToyMesh};

/// Format of the picture: the resolve averages linear light.
pub(crate) const PICTURE_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Multisampling of the toy's silhouette.
pub(crate) const N_SAMPLES: u32 = 4;

pub(crate) struct Composite {
    receiver: wgpu::RenderPipeline,
    toy: wgpu::RenderPipeline,
    linear: wgpu::Sampler,
}

pub(crate) struct CompositeInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) solution: &'a wgpu::Buffer,
    pub(crate) grids: &'a wgpu::Buffer,
    pub(crate) cells: &'a wgpu::Buffer,
    pub(crate) frame: &'a wgpu::TextureView,
    pub(crate) plate: &'a wgpu::TextureView,
    pub(crate) evidence: &'a wgpu::TextureView,
    pub(crate) physical_visibility: &'a wgpu::TextureView,
    pub(crate) physical_ambient: &'a wgpu::TextureView,
    pub(crate) visibility: &'a wgpu::TextureView,
    pub(crate) ambient: &'a wgpu::TextureView,
    pub(crate) appearance: &'a wgpu::TextureView,
    pub(crate) object_depth: &'a wgpu::TextureView,
    pub(crate) object_base: &'a wgpu::TextureView,
    pub(crate) object_normal: &'a wgpu::TextureView,
}

/// Textures of the region's size: two multisampled ones that stay on the chip, and the picture.
pub(crate) struct CompositeTargets<'a> {
    pub(crate) samples: &'a wgpu::TextureView,
    pub(crate) depth: &'a wgpu::TextureView,
    pub(crate) picture: &'a wgpu::TextureView,
}

impl Composite {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let module = gpu.module(&COMPOSITE);
        let streams = [
            Stream::new(2, VertexFormat::Float32x2),
            Stream::new(3, VertexFormat::Float32x4),
            Stream::new(0, VertexFormat::Float32x3),
            Stream::new(1, VertexFormat::Float32x3),
            Stream::new(4, VertexFormat::Float32x3),
            Stream::new(5, VertexFormat::Float32x3),
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
            receiver: gpu.render_pipeline(&COMPOSITE, &module, &receiver, &picture_shape(behind_all())),
            toy: gpu.render_pipeline(&COMPOSITE, &module, &toy, &picture_shape(nearest_surface())),
            linear: gpu.linear_sampler(),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        toy: &ToyMesh,
        inputs: &CompositeInputs<'_>,
        targets: &CompositeTargets<'_>,
    ) {
        let receiver_groups = [
            shared(gpu, &self.receiver, inputs),
            self.receiver_inputs(gpu, inputs),
        ];
        let toy_groups = [shared(gpu, &self.toy, inputs), self.toy_inputs(gpu, inputs)];
        let materials = toy.material_groups(gpu, &self.toy);
        let colors = [Some(resolved(targets.samples, targets.picture))];
        let mut render = encoder.render(COMPOSITE.name, &colors, Some(targets.depth), StoreOp::Discard);
        render.set_pipeline(&self.receiver);
        set_groups(&mut render, &receiver_groups);
        render.draw(0..3, 0..1);
        render.set_pipeline(&self.toy);
        set_groups(&mut render, &toy_groups);
        toy.draw_parts(&mut render, &[&toy.shown, &toy.physical], &materials);
    }

    fn receiver_inputs(&self, gpu: &Gpu, inputs: &CompositeInputs<'_>) -> wgpu::BindGroup {
        gpu.bind(
            &self.receiver.get_bind_group_layout(GROUP_PASS),
            &[
                (0, inputs.grids.as_entire_binding()),
                (1, inputs.cells.as_entire_binding()),
                (2, view(inputs.frame)),
                (3, view(inputs.plate)),
                (4, view(inputs.evidence)),
                (5, view(inputs.physical_visibility)),
                (6, view(inputs.physical_ambient)),
                (7, view(inputs.visibility)),
                (8, view(inputs.ambient)),
                (9, wgpu::BindingResource::Sampler(&self.linear)),
            ],
        )
    }

    fn toy_inputs(&self, gpu: &Gpu, inputs: &CompositeInputs<'_>) -> wgpu::BindGroup {
        gpu.bind(
            &self.toy.get_bind_group_layout(GROUP_PASS),
            &[
                (10, view(inputs.appearance)),
                (11, view(inputs.object_depth)),
                (12, view(inputs.object_base)),
                (13, view(inputs.object_normal)),
            ],
        )
    }
}

fn shared(gpu: &Gpu, pipeline: &wgpu::RenderPipeline, inputs: &CompositeInputs<'_>) -> wgpu::BindGroup {
    gpu.bind(
        &pipeline.get_bind_group_layout(GROUP_GLOBALS),
        &[
            (0, inputs.globals.as_entire_binding()),
            (1, inputs.solution.as_entire_binding()),
        ],
    )
}

fn set_groups(render: &mut wgpu::RenderPass<'_>, [shared, own]: &[wgpu::BindGroup; 2]) {
    render.set_bind_group(GROUP_GLOBALS, shared, &[]);
    render.set_bind_group(GROUP_PASS, own, &[]);
}

const PICTURE_TARGETS: [Option<wgpu::ColorTargetState>; 1] = [Some(wgpu::ColorTargetState {
    format: PICTURE_FORMAT,
    blend: None,
    write_mask: wgpu::ColorWrites::ALL,
})];

/// For pipelines that draw the region's picture.
pub(crate) fn picture_shape(depth: DepthStencilState) -> RenderShape<'static> {
    RenderShape {
        targets: &PICTURE_TARGETS,
        n_samples: N_SAMPLES,
        depth: Some(depth),
        constants: &[],
    }
}

/// For what is drawn before all else and hides nothing.
pub(crate) fn behind_all() -> DepthStencilState {
    DepthStencilState {
        depth_write_enabled: Some(false),
        depth_compare: Some(CompareFunction::Always),
        ..nearest_surface()
    }
}
