//! Chunks that other programs compressed. Ours are not compressed, since they hold compressed
//! pictures.

use super::error::Damage;

/// The compression of a chunk's records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Compression {
    /// LZ4 frames.
    Lz4,
    /// A Zstandard frame.
    Zstd,
}

impl Compression {
    /// The compression by its name in a chunk, if the format has it.
    pub(super) fn named(name: &[u8]) -> Option<Self> {
        match name {
            b"lz4" => Some(Self::Lz4),
            b"zstd" => Some(Self::Zstd),
            _ => None,
        }
    }
}

/// Decompresses a chunk with `n_bytes` bytes of records. Memory grows with the data, and is never
/// allocated by a stated length.
#[cfg(feature = "compressed")]
pub(super) fn inflate(compression: Compression, stored: &[u8], n_bytes: u64) -> Result<Vec<u8>, Damage> {
    use std::io::Read;

    /// Encoders use no larger window, except at levels that recording tools do not use.
    const WINDOW_BYTES: u64 = 8 << 20;
    let mut records = Vec::new();
    let is_read = match compression {
        Compression::Lz4 => {
            let decoder = lz4_flex::frame::FrameDecoder::new(stored);
            decoder.take(n_bytes + 1).read_to_end(&mut records).is_ok()
        }
        Compression::Zstd => {
            let window_bytes = n_bytes.max(WINDOW_BYTES);
            let decoder = ruzstd::decoding::StreamingDecoder::new_with_max_window_size(stored, window_bytes);
            decoder.is_ok_and(|decoder| decoder.take(n_bytes + 1).read_to_end(&mut records).is_ok())
        }
    };
    if is_read && records.len() as u64 == n_bytes {
        Ok(records)
    } else {
        Err(Damage::Inflate)
    }
}

/// An app reads no recordings of other programs.
#[cfg(not(feature = "compressed"))]
pub(super) fn inflate(_: Compression, _: &[u8], _: u64) -> Result<Vec<u8>, Damage> {
    Err(Damage::Compressed)
}
