//! The JSON messages that the reader parses. Texts are kept as written, digit for digit.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// First message of each chunk.
#[derive(Serialize, Deserialize)]
pub(super) struct SessionMessage {
    /// Number of the chunk, from 0.
    pub(super) chunk: u32,
    /// Number of files attached before it.
    pub(super) n_files: u32,
    pub(super) device: BTreeMap<String, String>,
    pub(super) session: Box<RawValue>,
}

/// A frame.
#[derive(Serialize, Deserialize)]
pub(super) struct FrameMessage<'a> {
    /// Number of its picture.
    pub(super) picture: u32,
    /// Number of its depths, if they are in the recording.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) depth: Option<u32>,
    /// The same of its mask of people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) people: Option<u32>,
    #[serde(borrow)]
    pub(super) entry: &'a RawValue,
}

/// The part of a frame's entry that the reader needs.
#[derive(Deserialize)]
pub(super) struct NamedPictures {
    pub(super) image: String,
    pub(super) depth: Option<String>,
    pub(super) people: Option<String>,
}
