//! Buffers, and the commands that fill them.

use wgpu::BufferUsages;

use super::context::Gpu;
use super::meter::Meter;

pub(crate) use super::resource::Buffer;

impl Gpu {
    /// A writable buffer filled with `contents`.
    pub(crate) fn buffer(&self, label: &str, contents: &[u8], usage: BufferUsages) -> Buffer {
        let raw = self.opened.as_ref().map(|opened| {
            opened.device.filled_buffer(&wgpu::util::BufferInitDescriptor {
                label: Some(label),
                contents,
                usage: usage | BufferUsages::COPY_DST,
            })
        });
        self.meter.upload(contents.len());
        self.counted(raw, contents.len() as u64)
    }

    /// A uniform buffer of one struct.
    pub(crate) fn uniform<T: bytemuck::Pod>(&self, label: &str, value: &T) -> Buffer {
        self.buffer(label, bytemuck::bytes_of(value), BufferUsages::UNIFORM)
    }

    /// A buffer of zeros that shaders read and write.
    pub(crate) fn storage(&self, label: &str, n_bytes: u64, usage: BufferUsages) -> Buffer {
        let raw = self.opened.as_ref().map(|opened| {
            opened.device.buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: n_bytes,
                usage: usage | BufferUsages::STORAGE,
                mapped_at_creation: false,
            })
        });
        self.counted(raw, n_bytes)
    }

    /// Overwrites the beginning of a buffer, before the next submission.
    pub(crate) fn write<T: bytemuck::Pod>(&self, buffer: &Buffer, values: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        self.meter.upload(bytes.len());
        if let (Some(opened), Some(raw)) = (&self.opened, &buffer.raw) {
            opened.queue.write_buffer(raw, 0, bytes);
        }
    }

    fn counted(&self, raw: Option<wgpu::Buffer>, n_bytes: u64) -> Buffer {
        Buffer {
            raw,
            id: Meter::id(),
            n_bytes,
            _held: self.meter.hold(n_bytes),
        }
    }
}
