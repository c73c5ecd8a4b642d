//! What writer and reader agree on.

/// What a session's index is called.
pub(super) const INDEX_PATH: &str = "capture.json";
/// Texts of all frames, and of the rest of the index; bytes. No longer index is read from a folder.
pub(super) const MAX_INDEX_BYTES: u64 = 16 << 20;
/// The largest chunk that is read; bytes. Pictures, which have at most half of it, are larger than what else is in one.
pub(super) const MAX_CHUNK_BYTES: u64 = 256 << 20;
