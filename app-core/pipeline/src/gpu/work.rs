//! The cost of passes, counted from the same attachments, bindings and draws with which they are
//! recorded.

use std::iter::Sum;
use std::ops::AddAssign;

use serde::Serialize;

use super::shape::Shape;

/// Work of a pass, over all of its runs. Only a recorder creates a non-empty one, from descriptors.
///
/// The bytes are a lower bound for a tiler: an attachment that is loaded or stored counts in full,
/// whatever is drawn to it. Each texel of a texture that is read counts once a pass, but per layer
/// at most as many texels as the pass has pixels, or as it declares to read; shadow maps count in
/// full. Buffers count in full, indices as far as they are drawn. Data that stays on the chip costs
/// nothing, and neither do a tiler's own writes for the triangles.
///
/// Thus a pass that reads outside the pixels that it draws, as `toy` does at the real toy's pixels,
/// counts as if it read the same number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub struct Work {
    n_draws: u32,
    triangles: u64,
    vertices: u64,
    bytes_read: u64,
    bytes_written: u64,
}

impl Work {
    /// Number of draws, and of dispatches of compute shaders.
    #[must_use]
    pub fn n_draws(&self) -> u32 {
        self.n_draws
    }

    /// Number of triangles, over all instances.
    #[must_use]
    pub fn triangles(&self) -> u64 {
        self.triangles
    }

    /// Number of vertices, over all instances: the upper bound of shaded ones, if triangles share
    /// none.
    #[must_use]
    pub fn vertices(&self) -> u64 {
        self.vertices
    }

    /// Bytes read from memory.
    #[must_use]
    pub fn bytes_read(&self) -> u64 {
        self.bytes_read
    }

    /// Bytes written to memory.
    #[must_use]
    pub fn bytes_written(&self) -> u64 {
        self.bytes_written
    }

    /// Bytes read and written.
    #[must_use]
    pub fn bytes_moved(&self) -> u64 {
        self.bytes_read + self.bytes_written
    }

    pub(super) fn draw(&mut self, n_vertices: u32, n_instances: u32) {
        self.n_draws += 1;
        self.triangles += u64::from(n_vertices / 3) * u64::from(n_instances);
        self.vertices += u64::from(n_vertices) * u64::from(n_instances);
    }

    pub(super) fn read(&mut self, n_bytes: u64) {
        self.bytes_read += n_bytes;
    }

    fn write(&mut self, n_bytes: u64) {
        self.bytes_written += n_bytes;
    }
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.n_draws += other.n_draws;
        self.triangles += other.triangles;
        self.vertices += other.vertices;
        self.bytes_read += other.bytes_read;
        self.bytes_written += other.bytes_written;
    }
}

impl Sum for Work {
    fn sum<I: Iterator<Item = Self>>(works: I) -> Self {
        works.fold(Self::default(), |mut sum, work| {
            sum += work;
            sum
        })
    }
}

/// Identifier of a texture or a buffer, unique on its device.
pub(crate) type Id = u64;

/// A resource of a group, for the count of bytes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Bound {
    /// A part of a buffer.
    Buffer { id: Id, n_bytes: u64, is_written: bool },
    /// A view of a texture, of which only the processed pixels are read, or all.
    View { id: Id, shape: Shape, is_whole: bool },
}

/// A pass that is being counted.
pub(super) struct Tally<'a> {
    work: &'a mut Work,
    /// Number of pixels that it reads in each layer.
    n_pixels: u64,
    /// Resources that are counted already.
    counted: Vec<Id>,
}

impl<'a> Tally<'a> {
    pub(super) fn new(work: &'a mut Work, n_pixels: u64) -> Self {
        Self {
            work,
            n_pixels,
            counted: Vec::new(),
        }
    }

    /// Counts an attachment that is loaded or stored.
    pub(super) fn attach(&mut self, shape: &Shape, is_loaded: bool, is_stored: bool) {
        let n_bytes = shape.n_texels() * shape.texel_bytes();
        self.work.read(if is_loaded { n_bytes } else { 0 });
        self.work.write(if is_stored { n_bytes } else { 0 });
    }

    /// Limits the pixels that it reads to this number.
    pub(super) fn narrow(&mut self, n_pixels: u64) {
        self.n_pixels = self.n_pixels.min(n_pixels);
    }

    /// Counts resources that its shaders can access from here on.
    pub(super) fn bind(&mut self, bound: &[Bound]) {
        for resource in bound {
            match *resource {
                Bound::Buffer {
                    id,
                    n_bytes,
                    is_written,
                } => {
                    if self.is_new(id) {
                        self.work.read(n_bytes);
                        self.work.write(if is_written { n_bytes } else { 0 });
                    }
                }
                Bound::View { id, shape, is_whole } => {
                    if self.is_new(id) {
                        let n_pixels = if is_whole { u64::MAX } else { self.n_pixels };
                        let most = n_pixels.saturating_mul(u64::from(shape.n_layers));
                        self.work.read(shape.n_texels().min(most) * shape.texel_bytes());
                    }
                }
            }
        }
    }

    /// Counts a stream of vertices.
    pub(super) fn stream(&mut self, id: Id, n_bytes: u64) {
        if self.is_new(id) {
            self.work.read(n_bytes);
        }
    }

    pub(super) fn draw(&mut self, n_vertices: u32, n_instances: u32) {
        self.work.draw(n_vertices, n_instances);
    }

    /// Counts an indexed draw, with 32-bit indices.
    pub(super) fn draw_indexed(&mut self, n_indices: u32, n_instances: u32) {
        self.work.draw(n_indices, n_instances);
        self.work.read(u64::from(n_indices) * size_of::<u32>() as u64);
    }

    pub(super) fn dispatch(&mut self) {
        self.work.n_draws += 1;
    }

    fn is_new(&mut self, id: Id) -> bool {
        let is_new = !self.counted.contains(&id);
        if is_new {
            self.counted.push(id);
        }
        is_new
    }
}
