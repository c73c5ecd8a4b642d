//! Readback of buffers and textures: blocking, for replay and tests.

use super::buffer::Buffer;
use super::context::{Gpu, GpuError, Opened};

/// Value that fills the readback before the copy, so that a copy that never ran cannot look like
/// black.
const POISON: u8 = 0xa5;

impl Gpu {
    /// Waits for the device and returns the bytes of a buffer that can be copied from.
    pub(crate) fn read_buffer(&self, buffer: &Buffer) -> Result<Vec<u8>, GpuError> {
        let (opened, raw) = self
            .opened
            .as_ref()
            .zip(buffer.raw.as_ref())
            .ok_or_else(GpuError::no_device)?;
        opened.read_buffer(raw)
    }

    /// Waits for the device and returns the texels of a texture, row by row without padding, layer
    /// after layer.
    pub fn read_texture(&self, texture: Option<&wgpu::Texture>) -> Result<Vec<u8>, GpuError> {
        let (opened, raw) = self
            .opened
            .as_ref()
            .zip(texture)
            .ok_or_else(GpuError::no_device)?;
        opened.read_texture(raw)
    }
}

impl GpuError {
    /// The error of reading data that is only counted.
    pub(crate) fn no_device() -> Self {
        Self::ReadBack {
            reason: "there is no device: what would be drawn is only counted".to_owned(),
        }
    }
}

impl Opened {
    pub(super) fn read_buffer(&self, buffer: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        let staging = self.staging(buffer.size());
        let mut encoder = self.device.encoder();
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        self.map(&staging)
    }

    fn read_texture(&self, texture: &wgpu::Texture) -> Result<Vec<u8>, GpuError> {
        let texel_bytes = texture.format().block_copy_size(None).unwrap_or(4);
        let row_bytes = texture.width() * texel_bytes;
        let padded_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let n_rows = texture.height() * texture.depth_or_array_layers();
        let staging = self.staging(u64::from(padded_bytes) * u64::from(n_rows));
        let mut encoder = self.device.encoder();
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &staging,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_bytes),
                    rows_per_image: Some(texture.height()),
                },
            },
            texture.size(),
        );
        self.queue.submit([encoder.finish()]);
        let padded = self.map(&staging)?;
        let rows = padded.chunks_exact(padded_bytes as usize);
        Ok(rows.flat_map(|row| &row[..row_bytes as usize]).copied().collect())
    }

    fn staging(&self, size: u64) -> wgpu::Buffer {
        let staging = self.device.buffer(&wgpu::BufferDescriptor {
            label: Some("read-back"),
            size,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: true,
        });
        if let Ok(mut bytes) = staging.get_mapped_range_mut(..) {
            bytes.slice(..).fill(POISON);
        }
        staging.unmap();
        staging
    }

    fn map(&self, staging: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
        let failed = |reason: String| GpuError::ReadBack { reason };
        let (sender, receiver) = std::sync::mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver waits below; if it is gone, the result is not needed.
            let _ = sender.send(result);
        });
        self.device
            .raw
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|e| failed(e.to_string()))?;
        receiver
            .recv()
            .map_err(|e| failed(e.to_string()))?
            .map_err(|e| failed(e.to_string()))?;
        let bytes = staging
            .get_mapped_range(..)
            .map_err(|e| failed(e.to_string()))?
            .to_vec();
        staging.unmap();
        Ok(bytes)
    }
}
