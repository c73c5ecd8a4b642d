//! Textures of the core: targets of passes, or pictures.

use glam::UVec2;
use wgpu::{TextureFormat, TextureUsages, TextureViewDimension};

use super::context::Gpu;
use super::meter::{CountedBytes, Meter};
use super::samplers::Sampler;
use super::shape::Shape;

pub(crate) use super::resource::TextureView;

/// A texture with a view of all of it; if work is only counted, it is no more than its shape.
#[derive(Debug)]
pub(crate) struct Texture {
    raw: Option<wgpu::Texture>,
    pub(crate) view: TextureView,
    _held: CountedBytes,
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

    /// A texture with one or more samples that never leaves the chip: it is drawn to and resolved,
    /// or discarded.
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

    /// A plane of a picture for reading, in its stored form.
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
            texture.write_part(gpu, level, 0, texels.as_ref());
        }
        texture
    }

    /// An array of pictures for reading, sRGB-encoded.
    pub(crate) fn pictures(gpu: &Gpu, label: &str, size_px: UVec2, n_layers: u32) -> Self {
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let shape = Shape {
            n_layers,
            ..Shape::of(size_px, TextureFormat::Rgba8UnormSrgb, usage)
        };
        Self::of(gpu, label, (TextureViewDimension::D2Array, shape))
    }

    fn new(gpu: &Gpu, label: &str, shape: Shape) -> Self {
        Self::of(gpu, label, (TextureViewDimension::D2, shape))
    }

    fn of(gpu: &Gpu, label: &str, (dimension, shape): (TextureViewDimension, Shape)) -> Self {
        let raw = make(gpu, label, &shape);
        Self {
            view: view_of(gpu, raw.as_ref(), (dimension, 0, shape.n_layers), &shape),
            raw,
            _held: gpu.meter.hold(shape.held_bytes()),
        }
    }

    /// The texture on its device; `None` if work is only counted.
    pub(crate) fn raw(&self) -> Option<&wgpu::Texture> {
        self.raw.as_ref()
    }

    pub(crate) fn format(&self) -> TextureFormat {
        self.view.shape.format
    }

    pub(crate) fn size_px(&self) -> UVec2 {
        self.view.shape.size_px
    }

    /// A view of the codes of an sRGB texture, without decoding.
    pub(crate) fn codes(&self, gpu: &Gpu) -> TextureView {
        let format = TextureFormat::Rgba8Unorm;
        let descriptor = wgpu::TextureViewDescriptor {
            format: Some(format),
            ..Default::default()
        };
        TextureView {
            raw: gpu.view(self.raw.as_ref(), &descriptor),
            id: self.view.id,
            shape: Shape {
                format,
                ..self.view.shape
            },
            is_own: true,
        }
    }

    /// Fills the whole texture with rows of texels without padding.
    pub(crate) fn write(&self, gpu: &Gpu, texels: &[u8]) {
        self.write_layer(gpu, 0, texels);
    }

    /// Fills one picture of an array.
    pub(crate) fn write_layer(&self, gpu: &Gpu, layer: u32, texels: &[u8]) {
        self.write_part(gpu, 0, layer, texels);
    }

    fn write_part(&self, gpu: &Gpu, level: u32, layer: u32, texels: &[u8]) {
        gpu.meter.upload(texels.len());
        let (Some(opened), Some(raw)) = (&gpu.opened, &self.raw) else {
            return;
        };
        let mut destination = raw.as_image_copy();
        destination.mip_level = level;
        destination.origin.z = layer;
        let size = raw.size().mip_level_size(level, raw.dimension());
        let texel_bytes = raw.format().block_copy_size(None);
        opened.queue.write_texture(
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

/// Targets of one shape that are drawn to separately and read together.
#[derive(Debug)]
pub(crate) struct TextureLayers {
    raw: Option<wgpu::Texture>,
    /// View of all layers as an array.
    pub(crate) view: TextureView,
    /// View of each layer.
    pub(crate) layers: Vec<TextureView>,
    _held: CountedBytes,
}

impl TextureLayers {
    /// `n_layers` textures that passes draw to and read from, and a single one for zero layers,
    /// since a binding needs one.
    pub(crate) fn targets(
        gpu: &Gpu,
        label: &str,
        (size_px, n_layers): (UVec2, u32),
        format: TextureFormat,
    ) -> Self {
        let n_layers = n_layers.max(1);
        let usage =
            TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
        let shape = Shape {
            n_layers,
            ..Shape::of(size_px, format, usage)
        };
        let raw = make(gpu, label, &shape);
        let view = |layers| view_of(gpu, raw.as_ref(), layers, &shape);
        Self {
            view: view((TextureViewDimension::D2Array, 0, n_layers)),
            layers: (0..n_layers)
                .map(|layer| view((TextureViewDimension::D2, layer, 1)))
                .collect(),
            _held: gpu.meter.hold(shape.held_bytes()),
            raw,
        }
    }

    /// The texture on its device; `None` if work is only counted.
    pub(crate) fn raw(&self) -> Option<&wgpu::Texture> {
        self.raw.as_ref()
    }
}

/// Creates a texture; `None` without a device.
fn make(gpu: &Gpu, label: &str, shape: &Shape) -> Option<wgpu::Texture> {
    // The codes of an sRGB texture are read and written unchanged when a picture passes through.
    let view_formats: &[_] = match (shape.format, shape.n_samples) {
        (TextureFormat::Rgba8UnormSrgb, 1) => &[TextureFormat::Rgba8Unorm],
        (TextureFormat::Rgba8Unorm, 1) => &[TextureFormat::Rgba8UnormSrgb],
        _ => &[],
    };
    let opened = gpu.opened.as_ref()?;
    Some(opened.device.texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width: shape.size_px.x,
            height: shape.size_px.y,
            depth_or_array_layers: shape.n_layers,
        },
        mip_level_count: shape.n_levels,
        sample_count: shape.n_samples,
        dimension: wgpu::TextureDimension::D2,
        format: shape.format,
        usage: shape.usage,
        view_formats,
    }))
}

impl TextureView {
    pub(crate) fn size_px(&self) -> UVec2 {
        self.shape.size_px
    }

    /// A view of a whole texture that the core does not own.
    pub(crate) fn of_other(gpu: &Gpu, texture: &wgpu::Texture) -> Self {
        let size_px = UVec2::new(texture.width(), texture.height());
        Self {
            raw: gpu.view(Some(texture), &wgpu::TextureViewDescriptor::default()),
            id: Meter::id(),
            shape: Shape::of(size_px, texture.format(), texture.usage()),
            is_own: false,
        }
    }
}

impl Gpu {
    fn view(
        &self,
        texture: Option<&wgpu::Texture>,
        descriptor: &wgpu::TextureViewDescriptor<'_>,
    ) -> Option<wgpu::TextureView> {
        let opened = self.opened.as_ref()?;
        Some(opened.device.view(texture?, descriptor))
    }
}

/// The view of `n_layers` layers from `first` on.
fn view_of(
    gpu: &Gpu,
    texture: Option<&wgpu::Texture>,
    (dimension, first, n_layers): (TextureViewDimension, u32, u32),
    shape: &Shape,
) -> TextureView {
    let descriptor = wgpu::TextureViewDescriptor {
        dimension: Some(dimension),
        base_array_layer: first,
        array_layer_count: Some(n_layers),
        ..Default::default()
    };
    TextureView {
        raw: gpu.view(texture, &descriptor),
        id: Meter::id(),
        shape: Shape { n_layers, ..*shape },
        is_own: true,
    }
}

/// The narrowest half-float format with this number of channels, up to four.
#[must_use]
pub(crate) const fn half_float(n_channels: usize) -> TextureFormat {
    match n_channels {
        0 | 1 => TextureFormat::R16Float,
        2 => TextureFormat::Rg16Float,
        _ => TextureFormat::Rgba16Float,
    }
}

/// The narrowest format of 8-bit fractions with this number of channels, up to four.
#[must_use]
pub(crate) const fn fractions(n_channels: usize) -> TextureFormat {
    match n_channels {
        0 | 1 => TextureFormat::R8Unorm,
        2 => TextureFormat::Rg8Unorm,
        _ => TextureFormat::Rgba8Unorm,
    }
}

/// A sampler that filters a picture and its mips; `modes` give the values beyond its border.
pub(crate) fn picture_sampler(gpu: &Gpu, label: &str, modes: [wgpu::AddressMode; 2]) -> Sampler {
    Sampler(gpu.opened.as_ref().map(|opened| {
        opened.device.sampler(&wgpu::SamplerDescriptor {
            label: Some(label),
            address_mode_u: modes[0],
            address_mode_v: modes[1],
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        })
    }))
}
