//! Uniforms that are written for each use: one buffer that every submission fills from its start.
//!
//! One buffer is enough because the queue writes before it runs later submissions.

use std::num::NonZeroU64;

use super::device::Device;

/// Bytes of one submission's uniforms: the largest, a baseline with four lights on four receivers,
/// needs 40 KiB.
const CAPACITY: usize = 128 << 10;
/// Alignment of offsets, valid on every device.
const ALIGNMENT: usize = 256;

/// The buffer of a device.
#[derive(Debug)]
pub(crate) struct Uniforms {
    buffer: wgpu::Buffer,
}

impl Uniforms {
    pub(crate) fn new(device: &Device) -> Self {
        Self {
            buffer: device.buffer(&wgpu::BufferDescriptor {
                label: Some("uniforms"),
                size: CAPACITY as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        }
    }

    /// Binding of a uniform of `n_bytes`; the offset comes with each use.
    pub(crate) fn binding(&self, n_bytes: usize) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Buffer(wgpu::BufferBinding {
            buffer: &self.buffer,
            offset: 0,
            size: NonZeroU64::new(n_bytes as u64),
        })
    }
}

/// The uniforms of one submission, while it is recorded.
#[derive(Debug, Default)]
pub(crate) struct Written {
    bytes: Vec<u8>,
}

impl Written {
    /// Adds a uniform; returns its offset.
    pub(crate) fn add<T: bytemuck::Pod>(&mut self, value: &T) -> u32 {
        let offset = self.bytes.len().next_multiple_of(ALIGNMENT);
        self.bytes.resize(offset, 0);
        self.bytes.extend_from_slice(bytemuck::bytes_of(value));
        // The device refuses a submission that does not fit, and names the write.
        u32::try_from(offset).unwrap_or(u32::MAX)
    }

    pub(crate) fn n_bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Writes the uniforms to the device's buffer.
    pub(crate) fn write(&self, queue: &wgpu::Queue, uniforms: &Uniforms) {
        if !self.bytes.is_empty() {
            queue.write_buffer(&uniforms.buffer, 0, &self.bytes);
        }
    }
}
