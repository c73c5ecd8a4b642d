//! The messages that are JSON and that the reader looks into. Texts are kept as they were written, number for number.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// First message of each chunk.
#[derive(Serialize, Deserialize)]
pub(super) struct SessionMessage {
    /// Which chunk it is, from 0.
    pub(super) chunk: u32,
    /// Files that were attached before it.
    pub(super) n_files: u32,
    pub(super) device: BTreeMap<String, String>,
    pub(super) session: Box<RawValue>,
}

/// A frame.
#[derive(Serialize, Deserialize)]
pub(super) struct FrameMessage<'a> {
    /// Number of its picture.
    pub(super) picture: u32,
    #[serde(borrow)]
    pub(super) entry: &'a RawValue,
}

/// What the reader needs of a frame's entry.
#[derive(Deserialize)]
pub(super) struct NamedPicture {
    pub(super) image: String,
}
