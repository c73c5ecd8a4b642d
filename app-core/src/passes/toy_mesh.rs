//! The toy on the device: what never changes, the physical pose, and the pose of the frame.

use std::ops::Range;

use wgpu::{BufferUsages, VertexAttribute, VertexFormat, VertexStepMode};

use crate::gpu::Gpu;
use crate::gpu::layout::Material;
use crate::gpu::pipeline::{GROUP_DRAW, view};
use crate::gpu::texture::Texture;
use crate::light_tiles::Sphere;
use crate::toy::{PosedMesh, ShadowRanges, Toy, Wrap};

/// The texture of a material that has none.
const WHITE: [u8; 4] = [255; 4];

/// Positions and normals of a pose, in plane space.
pub(crate) struct PoseBuffers {
    pub(crate) positions: wgpu::Buffer,
    pub(crate) normals: wgpu::Buffer,
    /// Holds all positions.
    pub(crate) around: Sphere,
}

impl PoseBuffers {
    fn new(gpu: &Gpu, mesh: &PosedMesh) -> Self {
        Self {
            positions: gpu.buffer(
                "positions",
                bytemuck::cast_slice(&mesh.positions),
                BufferUsages::VERTEX,
            ),
            normals: gpu.buffer(
                "normals",
                bytemuck::cast_slice(&mesh.normals),
                BufferUsages::VERTEX,
            ),
            around: Sphere::around(&mesh.positions),
        }
    }

    /// Replaces the pose by another of the same toy.
    pub(crate) fn write(&mut self, gpu: &Gpu, mesh: &PosedMesh) {
        self.around = Sphere::around(&mesh.positions);
        gpu.queue
            .write_buffer(&self.positions, 0, bytemuck::cast_slice(&mesh.positions));
        gpu.queue
            .write_buffer(&self.normals, 0, bytemuck::cast_slice(&mesh.normals));
    }
}

/// A run of indices with one material.
struct Part {
    indices: Range<u32>,
    material: usize,
}

struct MaterialBinding {
    uniform: wgpu::Buffer,
    texture: Texture,
    sampler: wgpu::Sampler,
}

/// The toy's buffers.
pub(crate) struct ToyMesh {
    indices: wgpu::Buffer,
    shadow_indices: wgpu::Buffer,
    pub(crate) shadow_ranges: ShadowRanges,
    uvs: wgpu::Buffer,
    colors: wgpu::Buffer,
    parts: Vec<Part>,
    materials: Vec<MaterialBinding>,
    /// The pose the real toy was made in.
    pub(crate) physical: PoseBuffers,
    /// The pose to be shown.
    pub(crate) shown: PoseBuffers,
}

impl ToyMesh {
    pub(crate) fn new(gpu: &Gpu, toy: &Toy, physical: &PosedMesh) -> Self {
        Self {
            indices: gpu.buffer(
                "indices",
                bytemuck::cast_slice(toy.indices()),
                BufferUsages::INDEX,
            ),
            shadow_indices: gpu.buffer(
                "shadow indices",
                bytemuck::cast_slice(&toy.shadow_indices().indices),
                BufferUsages::INDEX,
            ),
            shadow_ranges: toy.shadow_indices().ranges.clone(),
            uvs: gpu.buffer("uvs", bytemuck::cast_slice(toy.uvs()), BufferUsages::VERTEX),
            colors: gpu.buffer(
                "colors",
                bytemuck::cast_slice(toy.colors_linear().unwrap_or(&vec![[1.0; 4]; toy.n_vertices()])),
                BufferUsages::VERTEX,
            ),
            parts: toy
                .parts()
                .iter()
                .map(|part| Part {
                    indices: part.indices.clone(),
                    material: part.material,
                })
                .collect(),
            materials: toy
                .materials()
                .iter()
                .enumerate()
                .map(|(index, material)| MaterialBinding::new(gpu, toy, index, material))
                .collect(),
            physical: PoseBuffers::new(gpu, physical),
            shown: PoseBuffers::new(gpu, physical),
        }
    }

    pub(crate) fn n_materials(&self) -> usize {
        self.materials.len()
    }

    /// Group 2 of `pipeline`, one a material.
    pub(crate) fn material_groups(&self, gpu: &Gpu, pipeline: &wgpu::RenderPipeline) -> Vec<wgpu::BindGroup> {
        let layout = pipeline.get_bind_group_layout(GROUP_DRAW);
        self.materials
            .iter()
            .map(|material| {
                gpu.bind(
                    &layout,
                    &[
                        (0, material.uniform.as_entire_binding()),
                        (1, view(&material.texture.view)),
                        (2, wgpu::BindingResource::Sampler(&material.sampler)),
                    ],
                )
            })
            .collect()
    }

    /// Draws the whole mesh as these instances, without materials; positions are in slot 0.
    pub(crate) fn draw_positions(
        &self,
        render: &mut wgpu::RenderPass<'_>,
        positions: &wgpu::Buffer,
        instances: Range<u32>,
    ) {
        self.bind_positions(render, positions);
        render.draw_indexed(self.shadow_ranges.all.clone(), 0, instances);
    }

    /// Binds what [`ToyMesh::shadow_ranges`] are ranges of; positions are in slot 0.
    pub(crate) fn bind_positions(&self, render: &mut wgpu::RenderPass<'_>, positions: &wgpu::Buffer) {
        render.set_vertex_buffer(0, positions.slice(..));
        render.set_index_buffer(self.shadow_indices.slice(..), wgpu::IndexFormat::Uint32);
    }

    /// Draws every part with its material; `streams` are the poses, from slot 2 on.
    pub(crate) fn draw_parts(
        &self,
        render: &mut wgpu::RenderPass<'_>,
        streams: &[&PoseBuffers],
        materials: &[wgpu::BindGroup],
    ) {
        render.set_vertex_buffer(0, self.uvs.slice(..));
        render.set_vertex_buffer(1, self.colors.slice(..));
        for (slot, pose) in (2..).step_by(2).zip(streams) {
            render.set_vertex_buffer(slot, pose.positions.slice(..));
            render.set_vertex_buffer(slot + 1, pose.normals.slice(..));
        }
        render.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for part in &self.parts {
            render.set_bind_group(GROUP_DRAW, materials.get(part.material), &[]);
            render.draw_indexed(part.indices.clone(), 0, 0..1);
        }
    }
}

impl MaterialBinding {
    fn new(gpu: &Gpu, toy: &Toy, index: usize, material: &crate::toy::Material) -> Self {
        let image = material
            .base_color_texture
            .as_ref()
            .and_then(|used| toy.textures().get(used.texture));
        let texture = Texture::picture(
            gpu,
            "base colour",
            image.map_or([1, 1], |image| [image.width_px, image.height_px]),
        );
        texture.write(gpu, image.map_or(&WHITE, |image| &image.rgba8_srgb));
        let mode = |wrap: Wrap| match wrap {
            Wrap::Repeat => wgpu::AddressMode::Repeat,
            Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
            Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
        };
        let wrap = material
            .base_color_texture
            .as_ref()
            .map_or([Wrap::Repeat; 2], |used| [used.wrap_u, used.wrap_v]);
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("base colour"),
            address_mode_u: mode(wrap[0]),
            address_mode_v: mode(wrap[1]),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let uniform = Material {
            base_color_linear: material.base_color_linear,
            index: u32::try_from(index).unwrap_or(u32::MAX),
            _pad_0: 0,
            _pad_1: [0; 2],
        };
        Self {
            uniform: gpu.uniform("material", &uniform),
            texture,
            sampler,
        }
    }
}

/// A vertex stream of one attribute.
pub(crate) struct Stream([VertexAttribute; 1]);

impl Stream {
    /// `format` at shader location `location`.
    pub(crate) fn new(location: u32, format: VertexFormat) -> Self {
        Self([VertexAttribute {
            format,
            offset: 0,
            shader_location: location,
        }])
    }

    /// The stream's layout.
    pub(crate) fn layout(&self) -> Option<wgpu::VertexBufferLayout<'_>> {
        Some(wgpu::VertexBufferLayout {
            array_stride: self.0[0].format.size(),
            step_mode: VertexStepMode::Vertex,
            attributes: &self.0,
        })
    }
}
