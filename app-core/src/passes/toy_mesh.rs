//! The toy on the device: what never changes, the physical pose, and the pose of the frame.

use std::iter;
use std::ops::Range;

use glam::UVec2;
use wgpu::{BufferUsages, VertexFormat};

use crate::geometry::bounds::Sphere;
use crate::gpu::bindings::{GROUP_DRAW, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Pipeline, Stream};
use crate::gpu::recorder::{Group, Recorder, Render};
use crate::gpu::shader::{Part, part};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::{Texture, picture_sampler};
use crate::passes::mips::mips;
use crate::toy::{PosedMesh, ShadowRanges, Toy, Wrap};

/// The WGSL of the group of a material.
pub(crate) const MATERIAL: Part = part!("common/material", structs: [Material]);
/// What the group holds.
pub(crate) const MATERIAL_GROUP: &[Slot] = &[Slot::uniform::<Material>(), Slot::Filtered, Slot::Sampler];
/// Streams of a draw with materials: uvs, vertex colours, then positions and normals of the pose at locations 0 and 1.
pub(crate) const LOOK_STREAMS: [Stream; 4] = [
    (2, VertexFormat::Float32x2),
    (3, VertexFormat::Float32x4),
    (0, VertexFormat::Float32x3),
    (1, VertexFormat::Float32x3),
];

shared_struct! {
    /// A material as the shaders have it.
    pub(crate) struct Material {
        pub base_color_linear: [f32; 4],
        pub index: u32,
        pub _pad_0: u32,
        pub _pad_1: [u32; 2],
    }
}

/// The texture of a material that has none.
const WHITE: [u8; 4] = [255; 4];

/// Positions and normals of a pose, in anchor space.
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
        gpu.write(&self.positions, &mesh.positions);
        gpu.write(&self.normals, &mesh.normals);
    }
}

/// A run of indices with one material.
struct Run {
    indices: Range<u32>,
    material: usize,
}

/// A material on the device.
struct MaterialBuffers {
    uniform: wgpu::Buffer,
    /// Index of its texture.
    texture: usize,
    sampler: wgpu::Sampler,
}

/// The toy's buffers.
pub(crate) struct ToyMesh {
    indices: wgpu::Buffer,
    shadow_indices: wgpu::Buffer,
    pub(crate) shadow_ranges: ShadowRanges,
    uvs: wgpu::Buffer,
    colors: wgpu::Buffer,
    runs: Vec<Run>,
    materials: Vec<MaterialBuffers>,
    /// Those of the toy, then the one of materials without any.
    textures: Vec<Texture>,
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
            runs: toy
                .parts()
                .iter()
                .map(|part| Run {
                    indices: part.indices.clone(),
                    material: part.material,
                })
                .collect(),
            materials: toy
                .materials()
                .iter()
                .enumerate()
                .map(|(index, material)| MaterialBuffers::new(gpu, toy, index, material))
                .collect(),
            textures: textures(gpu, toy),
            physical: PoseBuffers::new(gpu, physical),
            shown: PoseBuffers::new(gpu, physical),
        }
    }

    pub(crate) fn n_materials(&self) -> usize {
        self.materials.len()
    }

    /// Group [`GROUP_DRAW`] of a pipeline, one a material.
    pub(crate) fn bind_materials<T>(&self, recorder: &Recorder<'_>, pipeline: &Pipeline<T>) -> Vec<Group> {
        let bind = |material: &MaterialBuffers| {
            let resources = [
                (&material.uniform).into(),
                (&self.textures[material.texture].view).into(),
                (&material.sampler).into(),
            ];
            recorder.bind(pipeline, GROUP_DRAW, &resources)
        };
        self.materials.iter().map(bind).collect()
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
    pub(crate) fn draw_parts(&self, render: &mut Render<'_>, streams: &[&PoseBuffers], materials: &[Group]) {
        render.0.set_vertex_buffer(0, self.uvs.slice(..));
        render.0.set_vertex_buffer(1, self.colors.slice(..));
        for (slot, pose) in (2..).step_by(2).zip(streams) {
            render.0.set_vertex_buffer(slot, pose.positions.slice(..));
            render.0.set_vertex_buffer(slot + 1, pose.normals.slice(..));
        }
        render
            .0
            .set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for run in &self.runs {
            if let Some(material) = materials.get(run.material) {
                render.set(material);
                render.0.draw_indexed(run.indices.clone(), 0, 0..1);
            }
        }
    }
}

impl MaterialBuffers {
    fn new(gpu: &Gpu, toy: &Toy, index: usize, material: &crate::toy::Material) -> Self {
        let n_textures = toy.textures().len();
        let used = material.base_color_texture.map(|used| used.texture);
        let mode = |wrap: Wrap| match wrap {
            Wrap::Repeat => wgpu::AddressMode::Repeat,
            Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
            Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
        };
        let wrap = material
            .base_color_texture
            .as_ref()
            .map_or([Wrap::Repeat; 2], |used| [used.wrap_u, used.wrap_v]);
        let sampler = picture_sampler(gpu, "base colour", wrap.map(mode));
        let uniform = Material {
            base_color_linear: material.base_color_linear,
            index: u32::try_from(index).unwrap_or(u32::MAX),
            _pad_0: 0,
            _pad_1: [0; 2],
        };
        Self {
            uniform: gpu.uniform("material", &uniform),
            texture: used.filter(|used| *used < n_textures).unwrap_or(n_textures),
            sampler,
        }
    }
}

/// The toy's textures with their mips, then a white one.
fn textures(gpu: &Gpu, toy: &Toy) -> Vec<Texture> {
    let mipped = |size_px, rgba8: &[u8]| {
        let mips = mips(size_px, rgba8);
        let levels: Vec<&[u8]> = iter::once(rgba8).chain(mips.iter().map(Vec::as_slice)).collect();
        Texture::mipped(gpu, "base colour", size_px, &levels)
    };
    let own = toy
        .textures()
        .iter()
        .map(|image| mipped(UVec2::new(image.width_px, image.height_px), &image.rgba8_srgb));
    own.chain([mipped(UVec2::ONE, &WHITE)]).collect()
}
