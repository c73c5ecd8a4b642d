//! Buffer views compressed by meshopt: vertices, indices, and the filters over vertices.
//!
//! Source: the glTF extensions `EXT_meshopt_compression` and `KHR_meshopt_compression` (appendices
//! A and B). The decoders belong to this project; their tests read streams of the format's own
//! encoder.

mod filters;
mod indices;
mod vertices;

pub(super) use filters::Filter;

/// The compression of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Compressed {
    pub(super) mode: Mode,
    pub(super) filter: Filter,
    /// Number of elements.
    pub(super) count: usize,
    /// Bytes per element.
    pub(super) stride: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    Attributes,
    Triangles,
    Indices,
}

impl Mode {
    pub(super) fn of(name: &str) -> Option<Self> {
        Some(match name {
            "ATTRIBUTES" => Self::Attributes,
            "TRIANGLES" => Self::Triangles,
            "INDICES" => Self::Indices,
            _ => return None,
        })
    }
}

impl Compressed {
    /// Whether the format allows this combination.
    pub(super) fn is_allowed(&self) -> bool {
        let is_index = self.stride == 2 || self.stride == 4;
        let of_mode = match self.mode {
            Mode::Attributes => self.stride.is_multiple_of(4) && (4..=256).contains(&self.stride),
            Mode::Triangles => is_index && self.count.is_multiple_of(3),
            Mode::Indices => is_index,
        };
        let of_filter = match self.filter {
            Filter::None => true,
            Filter::Octahedral | Filter::Color => self.stride == 4 || self.stride == 8,
            Filter::Quaternion => self.stride == 8,
            Filter::Exponential => self.stride.is_multiple_of(4),
        };
        of_mode && of_filter && (self.filter == Filter::None || self.mode == Mode::Attributes)
    }

    /// Decompresses a stream; `None` if it is broken. The caller has checked [`Self::is_allowed`].
    pub(super) fn decode(&self, stream: &[u8]) -> Option<Vec<u8>> {
        match self.mode {
            Mode::Attributes => {
                let mut bytes = vertices::decode(stream, self.count, self.stride)?;
                filters::apply(self.filter, &mut bytes, self.stride);
                Some(bytes)
            }
            Mode::Triangles => Some(self.packed(&indices::triangles(stream, self.count)?)),
            Mode::Indices => Some(self.packed(&indices::sequence(stream, self.count)?)),
        }
    }

    /// Indices of two or four bytes each.
    fn packed(&self, indices: &[u32]) -> Vec<u8> {
        let kept = self.stride;
        indices
            .iter()
            .flat_map(|index| index.to_le_bytes().into_iter().take(kept))
            .collect()
    }
}
