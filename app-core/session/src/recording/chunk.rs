//! The chunk in progress. It holds all that a reader needs to understand it, so that no chunk
//! depends on another.

use super::topics::Topic;
use super::wire::{Body, CHUNK, MESSAGE, MESSAGE_INDEX, head};

/// Size of the largest readable chunk, in bytes. Pictures, at most half of it, are the largest part
/// of one.
pub(super) const MAX_CHUNK_BYTES: u64 = 256 << 20;
/// Bytes of a chunk's body before its records: times, size, checksum, no compression, size again.
pub(super) const CHUNK_HEAD_BYTES: u64 = 40;
/// Bytes of a message's body before its data: channel, sequence number, two times.
const MESSAGE_HEAD_BYTES: usize = 22;

/// An open chunk.
pub(super) struct OpenChunk {
    records: Vec<u8>,
    /// Time and offset of each message, by channel.
    index: [Vec<(u64, u64)>; Topic::ALL.len()],
    /// Time of its start.
    pub(super) begun_ns: u64,
    times_ns: (u64, u64),
}

/// A chunk as in the file, with its entry in the summary.
pub(super) struct ClosedChunk {
    pub(super) bytes: Vec<u8>,
    pub(super) entry: ChunkEntry,
}

/// Position of a chunk.
pub(super) struct ChunkEntry {
    pub(super) at: u64,
    pub(super) n_bytes: u64,
    pub(super) n_record_bytes: u64,
    pub(super) times_ns: (u64, u64),
    /// Channel and offset of each of the message indices after it.
    pub(super) indices: Vec<(u16, u64)>,
    pub(super) n_index_bytes: u64,
    pub(super) n_messages: [u64; Topic::ALL.len()],
}

impl OpenChunk {
    /// A chunk that begins with the channels.
    pub(super) fn new(time_ns: u64) -> Self {
        Self {
            records: Topic::ALL.into_iter().flat_map(Topic::records).collect(),
            index: Default::default(),
            begun_ns: time_ns,
            times_ns: (time_ns, time_ns),
        }
    }

    /// Size in the file, without the indices after it.
    pub(super) fn n_bytes(&self) -> u64 {
        CHUNK_HEAD_BYTES + self.records.len() as u64
    }

    pub(super) fn message(&mut self, topic: Topic, sequence: u32, time_ns: u64, data: &[u8]) {
        let at = self.records.len() as u64;
        if let Some(entries) = self.index.get_mut(topic as usize) {
            entries.push((time_ns, at));
        }
        self.times_ns = (self.times_ns.0.min(time_ns), self.times_ns.1.max(time_ns));
        let n_bytes = MESSAGE_HEAD_BYTES + data.len();
        self.records.extend(head(MESSAGE, n_bytes as u64));
        let body = Body::new().u16(topic.id()).u32(sequence);
        self.records.extend(body.u64(time_ns).u64(time_ns).as_bytes());
        self.records.extend_from_slice(data);
    }

    /// The chunk and the indices after it, for a file whose end is at `at`.
    pub(super) fn close(self, at: u64) -> ClosedChunk {
        let n_record_bytes = self.records.len() as u64;
        let body = Body::new().u64(self.times_ns.0).u64(self.times_ns.1);
        let body = body.u64(n_record_bytes).u32(crc32fast::hash(&self.records));
        let mut bytes = body.text("").u64(n_record_bytes).raw(&self.records).record(CHUNK);
        let n_bytes = bytes.len() as u64;
        let mut indices = Vec::new();
        for (topic, entries) in Topic::ALL.into_iter().zip(&self.index) {
            if entries.is_empty() {
                continue;
            }
            indices.push((topic.id(), at + bytes.len() as u64));
            let pairs = entries
                .iter()
                .fold(Body::new(), |body, (time_ns, at)| body.u64(*time_ns).u64(*at));
            let index = Body::new().u16(topic.id()).counted(pairs.as_bytes());
            bytes.extend(index.record(MESSAGE_INDEX));
        }
        let entry = ChunkEntry {
            at,
            n_bytes,
            n_record_bytes,
            times_ns: self.times_ns,
            indices,
            n_index_bytes: bytes.len() as u64 - n_bytes,
            n_messages: self.index.map(|entries| entries.len() as u64),
        };
        ClosedChunk { bytes, entry }
    }
}
