//! `object`: the physical toy as the camera sees it: base colour, normal, received light and depth.

use wgpu::{StoreOp, TextureFormat, VertexFormat};

use crate::gpu::Gpu;
use crate::gpu::encoder::{Encoder, cleared};
use crate::gpu::pipeline::{GROUP_GLOBALS, RenderShape, Stages, nearest_surface};
use crate::gpu::shaders::OBJECT;

use super::self_shadow::{GROUP_SELF_SHADOW, SelfShadowMaps};
use super::toy_mesh::{Stream, ToyMesh};

/// Format of the base colour, whose alpha is the toy's coverage.
pub(crate) const BASE_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Format of the normals.
pub(crate) const NORMAL_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

/// Format of what each light gives.
pub(crate) const RECEIVED_FORMAT: TextureFormat = TextureFormat::Rgba16Float;

pub(crate) struct Object {
    pipeline: wgpu::RenderPipeline,
}

pub(crate) struct ObjectInputs<'a> {
    pub(crate) globals: &'a wgpu::Buffer,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) self_shadow: &'a SelfShadowMaps,
}

/// Textures of the region's size.
pub(crate) struct ObjectOutputs<'a> {
    pub(crate) base: &'a wgpu::TextureView,
    pub(crate) normal: &'a wgpu::TextureView,
    pub(crate) received: &'a wgpu::TextureView,
    pub(crate) depth: &'a wgpu::TextureView,
}

impl Object {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let streams = [
            Stream::new(2, VertexFormat::Float32x2),
            Stream::new(3, VertexFormat::Float32x4),
            Stream::new(0, VertexFormat::Float32x3),
            Stream::new(1, VertexFormat::Float32x3),
        ];
        let buffers: Vec<_> = streams.iter().map(Stream::layout).collect();
        let stages = Stages {
            vertex: "vs_project",
            fragment: "fs_describe",
            buffers: &buffers,
        };
        let shape = RenderShape {
            targets: &[
                Some(BASE_FORMAT.into()),
                Some(NORMAL_FORMAT.into()),
                Some(RECEIVED_FORMAT.into()),
            ],
            n_samples: 1,
            depth: Some(nearest_surface()),
            culled: None,
            constants: &[],
        };
        Self {
            pipeline: gpu.render_pipeline(&OBJECT, &gpu.module(&OBJECT), &stages, &shape),
        }
    }

    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        inputs: &ObjectInputs<'_>,
        outputs: &ObjectOutputs<'_>,
    ) {
        let group = gpu.bind(
            &self.pipeline.get_bind_group_layout(GROUP_GLOBALS),
            &[(0, inputs.globals.as_entire_binding())],
        );
        let self_shadow = inputs.self_shadow.bind(gpu, &self.pipeline);
        let materials = inputs.toy.material_groups(gpu, &self.pipeline);
        let colors = [outputs.base, outputs.normal, outputs.received].map(|view| Some(cleared(view)));
        let mut render = encoder.render(OBJECT.name, &colors, Some(outputs.depth), StoreOp::Store);
        render.set_pipeline(&self.pipeline);
        render.set_bind_group(GROUP_GLOBALS, &group, &[]);
        render.set_bind_group(GROUP_SELF_SHADOW, &self_shadow, &[]);
        let toy = inputs.toy;
        toy.draw_parts(&mut render, &[&toy.physical], &materials);
    }
}
