//! Buffers, and the commands that fill them.

use wgpu::BufferUsages;

use super::context::Gpu;

impl Gpu {
    /// A buffer filled with `contents`, which can be written to.
    pub(crate) fn buffer(&self, label: &str, contents: &[u8], usage: BufferUsages) -> wgpu::Buffer {
        self.device.filled_buffer(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage: usage | BufferUsages::COPY_DST,
        })
    }

    /// A uniform buffer of one struct.
    pub(crate) fn uniform<T: bytemuck::Pod>(&self, label: &str, value: &T) -> wgpu::Buffer {
        self.buffer(label, bytemuck::bytes_of(value), BufferUsages::UNIFORM)
    }

    /// A buffer of zeros that shaders read and write.
    pub(crate) fn storage(&self, label: &str, n_bytes: u64, usage: BufferUsages) -> wgpu::Buffer {
        self.device.buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: n_bytes,
            usage: usage | BufferUsages::STORAGE,
            mapped_at_creation: false,
        })
    }

    /// Overwrites the beginning of a buffer, before the next submission.
    pub(crate) fn write<T: bytemuck::Pod>(&self, buffer: &wgpu::Buffer, values: &[T]) {
        self.queue.write_buffer(buffer, 0, bytemuck::cast_slice(values));
    }
}
