//! Textures of our own: created from plans, filled from pictures.

use super::Gpu;
use super::encoder::Encoder;

/// A texture with its whole view.
#[derive(Debug)]
pub(crate) struct Texture {
    pub(crate) raw: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
}

/// What a texture is to be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextureShape {
    pub(crate) size_px: [u32; 2],
    pub(crate) format: wgpu::TextureFormat,
    pub(crate) n_samples: u32,
}

impl Texture {
    /// A texture that passes draw to and read from; a multisampled one is drawn to and resolved only.
    pub(crate) fn target(gpu: &Gpu, label: &str, shape: TextureShape) -> Self {
        let usage = if shape.n_samples > 1 {
            wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TRANSIENT_ATTACHMENT
        } else {
            wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST
        };
        let raw = create_raw(gpu, label, (shape, 1), usage);
        let view = raw.create_view(&wgpu::TextureViewDescriptor::default());
        Self { raw, view }
    }

    /// A target of one sample a texel.
    pub(crate) fn plain_target(
        gpu: &Gpu,
        label: &str,
        size_px: glam::UVec2,
        format: wgpu::TextureFormat,
    ) -> Self {
        let shape = TextureShape {
            size_px: size_px.to_array(),
            format,
            n_samples: 1,
        };
        Self::target(gpu, label, shape)
    }

    /// A picture to read from, sRGB-encoded.
    pub(crate) fn picture(gpu: &Gpu, label: &str, size_px: [u32; 2]) -> Self {
        Self::layers(gpu, label, size_px, 1, wgpu::TextureViewDimension::D2)
    }

    /// An array of pictures to read from, sRGB-encoded.
    pub(crate) fn pictures(gpu: &Gpu, label: &str, size_px: [u32; 2], n_pictures: u32) -> Self {
        Self::layers(
            gpu,
            label,
            size_px,
            n_pictures,
            wgpu::TextureViewDimension::D2Array,
        )
    }

    fn layers(
        gpu: &Gpu,
        label: &str,
        size_px: [u32; 2],
        n_layers: u32,
        dimension: wgpu::TextureViewDimension,
    ) -> Self {
        let shape = TextureShape {
            size_px,
            format: wgpu::TextureFormat::Rgba8UnormSrgb,
            n_samples: 1,
        };
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let raw = create_raw(gpu, label, (shape, n_layers), usage);
        let view = raw.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            ..Default::default()
        });
        Self { raw, view }
    }

    /// Encodes a copy of all of `from`, of the same size and format.
    pub(crate) fn encode_copy(&self, encoder: &mut Encoder, from: &Self) {
        encoder.raw.copy_texture_to_texture(
            from.raw.as_image_copy(),
            self.raw.as_image_copy(),
            self.raw.size(),
        );
    }

    fn bytes_per_texel(&self) -> Option<u32> {
        self.raw.format().block_copy_size(None)
    }

    /// The codes of an sRGB texture, not decoded.
    pub(crate) fn codes(&self) -> wgpu::TextureView {
        self.raw.create_view(&wgpu::TextureViewDescriptor {
            format: Some(wgpu::TextureFormat::Rgba8Unorm),
            ..Default::default()
        })
    }

    /// Fills the whole texture with rows of texels, nothing between them.
    pub(crate) fn write(&self, gpu: &Gpu, texels: &[u8]) {
        self.write_layer(gpu, 0, texels);
    }

    /// Fills one picture of an array.
    pub(crate) fn write_layer(&self, gpu: &Gpu, layer: u32, texels: &[u8]) {
        let mut destination = self.raw.as_image_copy();
        destination.origin.z = layer;
        gpu.queue.write_texture(
            destination,
            texels,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: self.bytes_per_texel().map(|bytes| bytes * self.raw.width()),
                rows_per_image: None,
            },
            wgpu::Extent3d {
                depth_or_array_layers: 1,
                ..self.raw.size()
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
    pub(crate) fn targets(gpu: &Gpu, label: &str, shape: TextureShape, n_layers: u32) -> Self {
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC;
        let raw = create_raw(gpu, label, (shape, n_layers), usage);
        let layer = |index| {
            raw.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2),
                base_array_layer: index,
                array_layer_count: Some(1),
                ..Default::default()
            })
        };
        Self {
            view: raw.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            }),
            layers: (0..n_layers).map(layer).collect(),
            raw,
        }
    }
}

fn create_raw(
    gpu: &Gpu,
    label: &str,
    (shape, n_layers): (TextureShape, u32),
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    // The codes of an sRGB texture are read and written as they are when a picture passes through untouched.
    let view_formats: &[_] = match (shape.format, shape.n_samples) {
        (wgpu::TextureFormat::Rgba8UnormSrgb, 1) => &[wgpu::TextureFormat::Rgba8Unorm],
        _ => &[],
    };
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d {
            width: shape.size_px[0],
            height: shape.size_px[1],
            depth_or_array_layers: n_layers,
        },
        mip_level_count: 1,
        sample_count: shape.n_samples,
        dimension: wgpu::TextureDimension::D2,
        format: shape.format,
        usage,
        view_formats,
    })
}
