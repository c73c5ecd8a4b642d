//! The toy's materials on the device: one buffer for all of them, and a bind group for each look.
//!
//! Many materials share a texture and a sampler; most have no texture of their own. Drivers spend
//! memory and time on each sampler, group and change of a binding. Therefore these are created once
//! for each texture and its addressing, and a draw selects its material by its instance.

use std::iter;

use glam::UVec2;
use wgpu::BufferUsages;

use crate::gpu::{
    Buffer, GROUP_DRAW, Gpu, Group, Pipeline, Recorder, Sampler, Slot, Texture, picture_sampler,
};
use crate::passes::mips::mips;
use app_scene::toy::{Material, Toy, Wrap};

/// Content of the group.
pub(crate) const MATERIAL_GROUP: &[Slot] = &[Slot::Read, Slot::Filtered, Slot::Sampler];

/// The texture of a material without one.
const WHITE: [u8; 4] = [255; 4];

/// The materials of a toy.
pub(crate) struct Materials {
    base_colors_linear: Buffer,
    /// Index of each material's look.
    look_of_material: Vec<usize>,
    looks: Vec<Look>,
    /// The toy's textures, then the one for materials without any.
    textures: Vec<Texture>,
}

/// A texture with the addressing that some materials use.
struct Look {
    /// Index of the texture.
    texture: usize,
    /// Addressing of u and v.
    wraps: [Wrap; 2],
    sampler: Sampler,
}

impl Materials {
    pub(crate) fn new(gpu: &Gpu, toy: &Toy) -> Self {
        let colors: Vec<[f32; 4]> = toy
            .materials()
            .iter()
            .map(|material| material.base_color_linear)
            .collect();
        let mut looks: Vec<Look> = Vec::new();
        let mut look_of = |material: &Material| {
            let (texture, wraps) = texture_of(toy, material);
            let known = looks
                .iter()
                .position(|look| (look.texture, look.wraps) == (texture, wraps));
            known.unwrap_or_else(|| {
                looks.push(Look {
                    texture,
                    wraps,
                    sampler: picture_sampler(gpu, "base colour", wraps.map(address_mode)),
                });
                looks.len() - 1
            })
        };
        Self {
            base_colors_linear: gpu.buffer(
                "base colours",
                bytemuck::cast_slice(&colors),
                BufferUsages::STORAGE,
            ),
            look_of_material: toy.materials().iter().map(&mut look_of).collect(),
            looks,
            textures: textures(gpu, toy),
        }
    }

    /// Number of materials.
    pub(crate) fn n(&self) -> usize {
        self.look_of_material.len()
    }

    /// The look of a material, as an index into the result of [`Materials::bind`].
    pub(crate) fn look(&self, material: usize) -> Option<usize> {
        self.look_of_material.get(material).copied()
    }

    /// Group [`GROUP_DRAW`] of a pipeline, one per look.
    pub(crate) fn bind<T>(&self, recorder: &Recorder<'_>, pipeline: &Pipeline<T>) -> Vec<Group> {
        let bind = |look: &Look| {
            let resources = [
                (&self.base_colors_linear).into(),
                (&self.textures[look.texture].view).into(),
                (&look.sampler).into(),
            ];
            recorder.bind(pipeline, GROUP_DRAW, &resources)
        };
        self.looks.iter().map(bind).collect()
    }
}

/// The texture of a material, and its addressing.
fn texture_of(toy: &Toy, material: &Material) -> (usize, [Wrap; 2]) {
    let n_textures = toy.textures().len();
    let used = material
        .base_color_texture
        .filter(|used| used.texture < n_textures);
    used.map_or((n_textures, [Wrap::Repeat; 2]), |used| {
        (used.texture, [used.wrap_u, used.wrap_v])
    })
}

fn address_mode(wrap: Wrap) -> wgpu::AddressMode {
    match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
        Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
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
