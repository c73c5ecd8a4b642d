//! Textures of our own: drawn to by passes, or filled with pictures.

use glam::UVec2;
use wgpu::{TextureFormat, TextureUsages, TextureViewDimension};

use super::context::Gpu;

/// A texture with its whole view.
#[derive(Debug)]
pub(crate) struct Texture {
    pub(crate) raw: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
}

/// What a texture is to be.
#[derive(Clone, Copy, Debug)]
struct Shape {
    size_px: UVec2,
    n_layers: u32,
    n_levels: u32,
    format: TextureFormat,
    n_samples: u32,
    usage: TextureUsages,
}

impl Texture {
    /// A texture that passes draw to and read from.
    pub(crate) fn target(gpu: &Gpu, label: &str, size_px: UVec2, format: TextureFormat) -> Self {
        let usage = TextureUsages::RENDER_ATTACHMENT
            | TextureUsages::TEXTURE_BINDING
            | TextureUsages::COPY_SRC
            | TextureUsages::COPY_DST;
        Self::new(gpu, label, Shape::of(size_px, format, usage))
    }

    /// A texture of one sample or several that never leaves the chip: it is drawn to and resolved, or discarded.
    pub(crate) fn samples(
        gpu: &Gpu,
        label: &str,
        size_px: UVec2,
        (format, n_samples): (TextureFormat, u32),
    ) -> Self {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TRANSIENT_ATTACHMENT;
        let shape = Shape {
            n_samples,
            ..Shape::of(size_px, format, usage)
        };
        Self::new(gpu, label, shape)
    }

    /// A plane of a picture to read from, as it is stored.
    pub(crate) fn plane(gpu: &Gpu, label: &str, size_px: UVec2, format: TextureFormat) -> Self {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        Self::new(gpu, label, Shape::of(size_px, format, usage))
    }

    /// A picture with its mips, each half the size of the level before, rounded down.
    pub(crate) fn mipped<L: AsRef<[u8]>>(gpu: &Gpu, label: &str, size_px: UVec2, levels: &[L]) -> Self {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let texture = Self::new(
            gpu,
            label,
            Shape {
                n_levels: u32::try_from(levels.len()).unwrap_or(1),
                ..Shape::of(size_px, TextureFormat::Rgba8UnormSrgb, usage)
            },
        );
        for (level, texels) in (0..).zip(levels) {
            texture.write_part(gpu, (level, 0), texels.as_ref());
        }
        texture
    }

    /// An array of pictures to read from, sRGB-encoded.
    pub(crate) fn pictures(gpu: &Gpu, label: &str, size_px: UVec2, n_layers: u32) -> Self {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let shape = Shape {
            n_layers,
            ..Shape::of(size_px, TextureFormat::Rgba8UnormSrgb, usage)
        };
        let raw = shape.make(gpu, label);
        Self {
            view: view_of(gpu, &raw, (TextureViewDimension::D2Array, 0, n_layers)),
            raw,
        }
    }

    fn new(gpu: &Gpu, label: &str, shape: Shape) -> Self {
        let raw = shape.make(gpu, label);
        Self {
            view: view_of(gpu, &raw, (TextureViewDimension::D2, 0, 1)),
            raw,
        }
    }

    /// A view of the codes of an sRGB texture, not decoded.
    pub(crate) fn codes(&self, gpu: &Gpu) -> wgpu::TextureView {
        self.view_as(gpu, TextureFormat::Rgba8Unorm)
    }

    /// A view of a texture of sRGB codes that decodes them.
    pub(crate) fn decoded(&self, gpu: &Gpu) -> wgpu::TextureView {
        self.view_as(gpu, TextureFormat::Rgba8UnormSrgb)
    }

    fn view_as(&self, gpu: &Gpu, format: TextureFormat) -> wgpu::TextureView {
        let descriptor = wgpu::TextureViewDescriptor {
            format: Some(format),
            ..Default::default()
        };
        gpu.device.view(&self.raw, &descriptor)
    }

    /// Fills the whole texture with rows of texels, nothing between them.
    pub(crate) fn write(&self, gpu: &Gpu, texels: &[u8]) {
        self.write_layer(gpu, 0, texels);
    }

    /// Fills one picture of an array.
    pub(crate) fn write_layer(&self, gpu: &Gpu, layer: u32, texels: &[u8]) {
        self.write_part(gpu, (0, layer), texels);
    }

    fn write_part(&self, gpu: &Gpu, (level, layer): (u32, u32), texels: &[u8]) {
        let mut destination = self.raw.as_image_copy();
        destination.mip_level = level;
        destination.origin.z = layer;
        let size = self.raw.size().mip_level_size(level, self.raw.dimension());
        let texel_bytes = self.raw.format().block_copy_size(None);
        gpu.queue.write_texture(
            destination,
            texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: texel_bytes.map(|bytes| bytes * size.width),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                depth_or_array_layers: 1,
                ..size
            },
        );
    }
}

/// Targets of one shape, drawn to one by one and read together.
#[derive(Debug)]
pub(crate) struct TextureLayers {
    pub(crate) raw: wgpu::Texture,
    /// All of them, as an array.
    pub(crate) view: wgpu::TextureView,
    /// Each by itself.
    pub(crate) layers: Vec<wgpu::TextureView>,
}

impl TextureLayers {
    /// `n_layers` textures that passes draw to and read from.
    pub(crate) fn targets(
        gpu: &Gpu,
        label: &str,
        (size_px, n_layers): (UVec2, u32),
        format: TextureFormat,
    ) -> Self {
        let usage =
            TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
        let shape = Shape {
            n_layers,
            ..Shape::of(size_px, format, usage)
        };
        let raw = shape.make(gpu, label);
        Self {
            view: view_of(gpu, &raw, (TextureViewDimension::D2Array, 0, n_layers)),
            layers: (0..n_layers)
                .map(|layer| view_of(gpu, &raw, (TextureViewDimension::D2, layer, 1)))
                .collect(),
            raw,
        }
    }
}

impl Shape {
    fn of(size_px: UVec2, format: TextureFormat, usage: TextureUsages) -> Self {
        Self {
            size_px,
            n_layers: 1,
            n_levels: 1,
            format,
            n_samples: 1,
            usage,
        }
    }

    fn make(self, gpu: &Gpu, label: &str) -> wgpu::Texture {
        // The codes of an sRGB texture are read and written as they are when a picture passes through untouched.
        let view_formats: &[_] = match (self.format, self.n_samples) {
            (TextureFormat::Rgba8UnormSrgb, 1) => &[TextureFormat::Rgba8Unorm],
            (TextureFormat::Rgba8Unorm, 1) => &[TextureFormat::Rgba8UnormSrgb],
            _ => &[],
        };
        gpu.device.texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width: self.size_px.x,
                height: self.size_px.y,
                depth_or_array_layers: self.n_layers,
            },
            mip_level_count: self.n_levels,
            sample_count: self.n_samples,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: self.usage,
            view_formats,
        })
    }
}

/// The view of `n_layers` layers from `first` on.
fn view_of(
    gpu: &Gpu,
    texture: &wgpu::Texture,
    (dimension, first, n_layers): (TextureViewDimension, u32, u32),
) -> wgpu::TextureView {
    gpu.device.view(
        texture,
        &wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            base_array_layer: first,
            array_layer_count: Some(n_layers),
            ..Default::default()
        },
    )
}

/// The narrowest format of half floats that has so many channels, of up to four.
#[must_use]
pub(crate) fn half_float(n_channels: usize) -> TextureFormat {
    match n_channels {
        0 | 1 => TextureFormat::R16Float,
        2 => TextureFormat::Rg16Float,
        _ => TextureFormat::Rgba16Float,
    }
}

/// A sampler that filters a picture and its mips; `modes` are what it shows beyond its border.
pub(crate) fn picture_sampler(gpu: &Gpu, label: &str, modes: [wgpu::AddressMode; 2]) -> wgpu::Sampler {
    gpu.device.sampler(&wgpu::SamplerDescriptor {
        label: Some(label),
        address_mode_u: modes[0],
        address_mode_v: modes[1],
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}
