//! Reads accessors: every offset, stride and count is checked before a byte is read.

use std::cell::Cell;
use std::ops::RangeInclusive;

use glam::{Vec2, Vec3};
use gltf::json::accessor::{Accessor, Type, sparse::Sparse};
use gltf::json::{Index, Root, buffer};

use super::check::{check_finite, check_limit, check_range};
use super::component::{float_decoder, integer_decoder};
use super::container::{Container, allowed, get};
use super::error::{Flaw, ToyProblem};
use super::limits::{MAX_DECODED_VALUES, NUMBER, UV};
use super::uv_transform::UvTransform;

/// The JSON tree with its binary data, and the number of decoded values.
pub(super) struct Source<'a> {
    pub(super) root: &'a Root,
    container: &'a Container<'a>,
    n_decoded: Cell<usize>,
}

/// Layout of an accessor's numbers.
struct Layout {
    count: usize,
    /// Numbers of one element.
    width: usize,
    /// Bytes of one number.
    size: usize,
}

impl Layout {
    fn element_bytes(&self) -> usize {
        self.width * self.size
    }
}

impl<'a> Source<'a> {
    pub(super) fn new(container: &'a Container<'_>) -> Self {
        Self {
            root: &container.root,
            container,
            n_decoded: Cell::new(0),
        }
    }

    /// The extension of a texture that exists only in an unsupported format.
    pub(super) fn unread_texture(&self, texture: usize) -> Option<&'static str> {
        self.container.extras.unread_textures.get(&texture).copied()
    }

    /// A material's transform of texture coordinates.
    pub(super) fn uv_transform(&self, material: Option<usize>) -> Option<&UvTransform> {
        self.container.extras.uv_transforms.get(&material?)
    }

    /// Adds `n_values` to the decoded values of this file, which are limited.
    pub(super) fn charge(&self, field: &str, n_values: usize) -> Result<(), Flaw> {
        let found = self.n_decoded.get().saturating_add(n_values);
        self.n_decoded
            .set(check_limit("decoded numbers", found, MAX_DECODED_VALUES, field)?);
        Ok(())
    }

    /// Reads finite numbers of a range, element after element; normalised integers become
    /// fractions.
    pub(super) fn floats_within(
        &self,
        field: &str,
        index: Index<Accessor>,
        shape: Type,
        range: &RangeInclusive<f32>,
    ) -> Result<Vec<f32>, Flaw> {
        let values = self.floats(field, index, shape)?;
        let field = named(field, index);
        check_range(&field, &values, shape.multiplicity(), range)?;
        Ok(values)
    }

    /// Reads finite numbers of any size.
    pub(super) fn floats(&self, field: &str, index: Index<Accessor>, shape: Type) -> Result<Vec<f32>, Flaw> {
        let field = named(field, index);
        let accessor = get(self.root, &field, index, "accessor")?;
        let component = allowed(accessor.component_type, &field)?.0;
        let decode = float_decoder(component, accessor.normalized).ok_or_else(|| {
            wrong_type(
                &field,
                "float or integer up to 16 bits",
                &format!("{component:?}"),
            )
        })?;
        let values = self.decode(&field, accessor, shape, decode)?;
        check_finite(&field, &values, shape.multiplicity())?;
        Ok(values)
    }

    /// Reads unsigned integers, element after element.
    pub(super) fn integers(
        &self,
        field: &str,
        index: Index<Accessor>,
        shape: Type,
    ) -> Result<Vec<u32>, Flaw> {
        let field = named(field, index);
        let accessor = get(self.root, &field, index, "accessor")?;
        let component = allowed(accessor.component_type, &field)?.0;
        let decode = integer_decoder(component)
            .ok_or_else(|| wrong_type(&field, "an unsigned integer", &format!("{component:?}")))?;
        self.decode(&field, accessor, shape, decode)
    }

    /// Texture coordinates.
    pub(super) fn uvs(&self, field: &str, index: Index<Accessor>) -> Result<Vec<Vec2>, Flaw> {
        Ok(grouped(&self.floats_within(field, index, Type::Vec2, &UV)?))
    }

    /// Points, offsets or normals.
    pub(super) fn vec3s(&self, field: &str, index: Index<Accessor>) -> Result<Vec<Vec3>, Flaw> {
        Ok(grouped(&self.floats_within(field, index, Type::Vec3, &NUMBER)?))
    }

    /// The bytes of a buffer view, and its stride if it has one.
    pub(super) fn view(
        &self,
        field: &str,
        index: Index<buffer::View>,
    ) -> Result<(&'a [u8], Option<usize>), Flaw> {
        let view = get(self.root, field, index, "buffer view")?;
        let field = format!("bufferViews[{}]", index.value());
        let stride = view.byte_stride.map(|stride| stride.0);
        if let Some(bytes) = self.container.decompressed.get(&index.value()) {
            return Ok((bytes, stride));
        }
        get(self.root, &field, view.buffer, "buffer")?;
        let buffer = view.buffer.value();
        let bytes = self.container.buffers.get(buffer).and_then(Option::as_deref);
        let bytes = range(
            &field,
            bytes.ok_or_else(|| ToyProblem::External.at(format!("buffers[{buffer}]")))?,
            view.byte_offset.unwrap_or_default().0,
            view.byte_length.0,
        )?;
        Ok((bytes, stride))
    }

    fn decode<T: Copy + Default>(
        &self,
        field: &str,
        accessor: &Accessor,
        shape: Type,
        decode: fn(&[u8]) -> T,
    ) -> Result<Vec<T>, Flaw> {
        let found = allowed(accessor.type_, field)?;
        if found != shape {
            return Err(wrong_type(field, &format!("{shape:?}"), &format!("{found:?}")));
        }
        let size = allowed(accessor.component_type, field)?.0.size();
        let layout = Layout {
            count: count(accessor.count.0),
            width: shape.multiplicity(),
            size,
        };
        let n_values = layout.count.saturating_mul(layout.width);
        self.charge(field, n_values)?;
        let Some(view) = accessor.buffer_view else {
            let mut values = vec![T::default(); n_values];
            self.apply_sparse(field, accessor, &layout, decode, &mut values)?;
            return Ok(values);
        };
        let (bytes, stride) = self.view(field, view)?;
        let stride = stride.unwrap_or(layout.element_bytes());
        let bytes = strided(
            field,
            bytes,
            accessor.byte_offset.unwrap_or_default().0,
            stride,
            &layout,
        )?;
        let mut values = vec![T::default(); n_values];
        for (element, bytes) in values.chunks_exact_mut(layout.width).zip(bytes.chunks(stride)) {
            fill(element, bytes, size, decode);
        }
        self.apply_sparse(field, accessor, &layout, decode, &mut values)?;
        Ok(values)
    }

    fn apply_sparse<T>(
        &self,
        field: &str,
        accessor: &Accessor,
        layout: &Layout,
        decode: fn(&[u8]) -> T,
        values: &mut [T],
    ) -> Result<(), Flaw> {
        let Some(sparse) = &accessor.sparse else {
            return Ok(());
        };
        let field = format!("{field}.sparse");
        let n = count(sparse.count.0);
        check_limit("sparse elements", n, layout.count, &field)?;
        let replaced = self.sparse_indices(&field, sparse, n, layout.count)?;
        let (bytes, _) = self.view(&field, sparse.values.buffer_view)?;
        let packed = Layout { count: n, ..*layout };
        let bytes = strided(
            &field,
            bytes,
            sparse.values.byte_offset.0,
            layout.element_bytes(),
            &packed,
        )?;
        for (element, bytes) in replaced.into_iter().zip(bytes.chunks(layout.element_bytes())) {
            let first = element * layout.width;
            fill(
                &mut values[first..first + layout.width],
                bytes,
                layout.size,
                decode,
            );
        }
        Ok(())
    }

    /// The `n` elements that a sparse accessor replaces: in increasing order, each below `count`.
    fn sparse_indices(
        &self,
        field: &str,
        sparse: &Sparse,
        n: usize,
        count: usize,
    ) -> Result<Vec<usize>, Flaw> {
        let component = allowed(sparse.indices.component_type, field)?.0;
        let decode = integer_decoder(component).ok_or_else(|| ToyProblem::NotAllowed.at(field))?;
        let layout = Layout {
            count: n,
            width: 1,
            size: component.size(),
        };
        let (bytes, _) = self.view(field, sparse.indices.buffer_view)?;
        let bytes = strided(field, bytes, sparse.indices.byte_offset.0, layout.size, &layout)?;
        let mut indices: Vec<usize> = Vec::with_capacity(n);
        for bytes in bytes.chunks_exact(layout.size) {
            let index = decode(bytes) as usize;
            if index >= count || indices.last().is_some_and(|&last| index <= last) {
                return Err(ToyProblem::SparseIndex { index, count }.at(field));
            }
            indices.push(index);
        }
        Ok(indices)
    }
}

fn named(field: &str, index: Index<Accessor>) -> String {
    format!("{field} (accessor {})", index.value())
}

pub(super) fn grouped<const N: usize, T: From<[f32; N]>>(values: &[f32]) -> Vec<T> {
    values.as_chunks().0.iter().copied().map(T::from).collect()
}

/// A count as written; one above the address space is refused by the limit right after.
fn count(written: u64) -> usize {
    usize::try_from(written).unwrap_or(usize::MAX)
}

fn wrong_type(field: &str, expected: &str, found: &str) -> Flaw {
    ToyProblem::WrongType {
        expected: expected.to_owned(),
        found: found.to_owned(),
    }
    .at(field)
}

fn range<'b>(field: &str, bytes: &'b [u8], offset: u64, length: u64) -> Result<&'b [u8], Flaw> {
    let end = offset.saturating_add(length);
    let inside = || bytes.get(usize::try_from(offset).ok()?..usize::try_from(end).ok()?);
    inside().ok_or_else(|| {
        ToyProblem::OutOfRange {
            end,
            available: bytes.len(),
        }
        .at(field)
    })
}

/// The bytes from the first element to the end of the last.
fn strided<'b>(
    field: &str,
    bytes: &'b [u8],
    offset: u64,
    stride: usize,
    layout: &Layout,
) -> Result<&'b [u8], Flaw> {
    let element = layout.element_bytes();
    if stride < element {
        return Err(ToyProblem::Stride { stride, element }.at(field));
    }
    let Some(n_steps) = (layout.count as u64).checked_sub(1) else {
        return Ok(&[]);
    };
    let length = n_steps
        .saturating_mul(stride as u64)
        .saturating_add(element as u64);
    range(field, bytes, offset, length)
}

fn fill<T>(element: &mut [T], bytes: &[u8], size: usize, decode: fn(&[u8]) -> T) {
    for (value, bytes) in element.iter_mut().zip(bytes.chunks_exact(size)) {
        *value = decode(bytes);
    }
}
