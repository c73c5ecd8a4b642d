//! Inputs of a single pass: buffers, and textures of any numbers.

use app_core::wgpu;
use bytemuck::Pod;
use glam::{DVec4, UVec2};
use reference::raster::Raster;
use wgpu::util::DeviceExt;

use crate::alone::{Bindings, RESULT_FORMAT};
use crate::device::Device;

const DEPTH: &str = "
@group(1) @binding(0) var depths: texture_2d<f32>;
@vertex
fn vs_fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
  return vec4f(vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0, 0.0, 1.0);
}
@fragment
fn fs_depth(@builtin(position) at: vec4f) -> @builtin(frag_depth) f32 {
  return textureLoad(depths, vec2u(at.xy), 0).r;
}
";

impl Device {
    pub(crate) fn uniform<T: Pod>(&self, value: &T) -> wgpu::Buffer {
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::bytes_of(value),
            usage: wgpu::BufferUsages::UNIFORM,
        })
    }

    /// A texture of 32 bits for loading texels, with one layer each.
    fn layers(&self, layers: &[&Raster<DVec4>]) -> wgpu::Texture {
        let texels: Vec<[f32; 4]> = layers
            .iter()
            .flat_map(|layer| layer.texels().iter().map(|texel| texel.as_vec4().to_array()))
            .collect();
        let n_layers = u32::try_from(layers.len()).unwrap();
        self.texture(
            layers[0].size(),
            n_layers,
            RESULT_FORMAT,
            bytemuck::cast_slice(&texels),
        )
    }

    /// The view of a texture array.
    pub(crate) fn array(&self, layers: &[&Raster<DVec4>]) -> wgpu::TextureView {
        self.layers(layers).create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        })
    }

    /// The view of a texture of one layer.
    pub(crate) fn map(&self, map: &Raster<DVec4>) -> wgpu::TextureView {
        self.layers(&[map])
            .create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Multiples of 1/256 in one channel of halves, for filtering: a driver may filter 8-bit
    /// formats in 8 bits.
    pub(crate) fn filterable(&self, numbers: &Raster<u8>) -> wgpu::TextureView {
        let halves: Vec<u16> = numbers.texels().iter().map(|number| half(*number)).collect();
        let bytes = bytemuck::cast_slice(&halves);
        let texture = self.texture(numbers.size(), 1, wgpu::TextureFormat::R16Float, bytes);
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Multiples of 1/256 in four channels of halves, for filtering.
    pub(crate) fn filterable_colors(&self, numbers: &Raster<[u8; 4]>) -> wgpu::TextureView {
        let numbers_of_all = numbers.texels().as_flattened().iter();
        let halves: Vec<u16> = numbers_of_all.map(|number| half(*number)).collect();
        let bytes = bytemuck::cast_slice(&halves);
        let texture = self.texture(numbers.size(), 1, wgpu::TextureFormat::Rgba16Float, bytes);
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    /// Whole numbers in two channels.
    pub(crate) fn labels(&self, labels: &Raster<[u8; 2]>) -> wgpu::TextureView {
        let bytes = labels.texels().as_flattened();
        let texture = self.texture(labels.size(), 1, wgpu::TextureFormat::Rg8Uint, bytes);
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    }

    fn texture(
        &self,
        size: UVec2,
        n_layers: u32,
        format: wgpu::TextureFormat,
        bytes: &[u8],
    ) -> wgpu::Texture {
        let descriptor = texture_of(size, n_layers, format, wgpu::TextureUsages::TEXTURE_BINDING);
        let order = wgpu::util::TextureDataOrder::LayerMajor;
        self.device
            .create_texture_with_data(&self.queue, &descriptor, order, bytes)
    }

    /// A depth map, which is drawn, since it cannot be uploaded.
    pub(crate) fn depth(&self, depths: &Raster<f64>) -> wgpu::TextureView {
        let format = wgpu::TextureFormat::Depth32Float;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = self
            .device
            .create_texture(&texture_of(depths.size(), 1, format, usage));
        let target = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let values = self.map(&depths.map(DVec4::splat));
        let own: Bindings<'_> = vec![(0, wgpu::BindingResource::TextureView(&values))];
        let state = wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        };
        let pipeline = self.pipeline((DEPTH, "fs_depth", &[]), &[], Some(state));
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &target,
            depth_ops: Some(wgpu::Operations::default()),
            stencil_ops: None,
        };
        self.draw_into(&pipeline, [&[], &own], &[], Some(depth));
        target
    }

    pub(crate) fn linear_sampler(&self) -> wgpu::Sampler {
        self.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        })
    }
}

/// A texture with one level and one sample per texel.
pub(crate) fn texture_of(
    size: UVec2,
    n_layers: u32,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureDescriptor<'static> {
    wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: size.x,
            height: size.y,
            depth_or_array_layers: n_layers,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    }
}

/// `number` / 256 as an IEEE 754 half: 5 bits of exponent with a bias of 15, and 10 bits of
/// mantissa after the leading 1.
fn half(number: u8) -> u16 {
    let Some(exponent) = number.checked_ilog2() else {
        return 0;
    };
    let fraction = (u16::from(number) << (10 - exponent)) & 0x3ff;
    let exponent = u16::try_from(exponent + 15 - 8).unwrap();
    (exponent << 10) | fraction
}
