//! The session's index, as a reader assembles it from messages.

use std::collections::BTreeMap;

use serde_json::value::RawValue;

use crate::MAX_INDEX_BYTES;

/// Between the entries of two frames.
const BETWEEN: &str = ",\n";
/// Room for the key of the frames, and for the brackets around them; bytes.
const AROUND_BYTES: u64 = 32;

/// Size of an index that grows frame by frame. A writer and a reader count alike, so that whatever
/// a writer has accepted can be opened.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct IndexSize {
    n_entry_bytes: u64,
    is_full: bool,
}

impl IndexSize {
    /// Adds a frame's entry to the index of `session`, unless it would be larger than
    /// [`MAX_INDEX_BYTES`]: then neither this nor a later one is added. Returns whether it was.
    pub(super) fn add(&mut self, session: &str, entry: &str) -> bool {
        let n_entry_bytes = self.n_entry_bytes + (entry.len() + BETWEEN.len()) as u64;
        self.is_full |= session.len() as u64 + AROUND_BYTES + n_entry_bytes > MAX_INDEX_BYTES;
        if !self.is_full {
            self.n_entry_bytes = n_entry_bytes;
        }
        !self.is_full
    }
}

/// The index of `session` with these entries of frames, as they were written. `None` if `session`
/// is no object.
pub(super) fn assembled<'a>(session: &RawValue, entries: impl Iterator<Item = &'a str>) -> Option<Vec<u8>> {
    let mut keys: BTreeMap<String, &RawValue> = serde_json::from_str(session.get()).ok()?;
    let entries: Vec<&str> = entries.collect();
    let frames = RawValue::from_string(format!("[\n{}\n]", entries.join(BETWEEN))).ok()?;
    keys.insert("frames".to_owned(), &frames);
    serde_json::to_vec(&keys).ok()
}
