//! The end of a finished recording, which viewers use to navigate without reading all of it. Our
//! reader does not need it.

use super::chunk::ChunkEntry;
use super::topics::Topic;
use super::wire::{
    ATTACHMENT_INDEX, Body, CHANNEL, CHUNK_INDEX, DATA_END, FOOTER, MAGIC, METADATA_INDEX, SCHEMA,
    STATISTICS, SUMMARY_OFFSET, head,
};
use crate::INDEX_FILE;

/// Bytes of the footer's body.
const FOOTER_BYTES: u64 = 20;

/// Position of an attached file.
pub(super) struct FileEntry {
    pub(super) at: u64,
    pub(super) n_bytes: u64,
    pub(super) n_data_bytes: u64,
    pub(super) time_ns: u64,
    pub(super) path: String,
    pub(super) media_type: &'static str,
}

/// Positions of all written records.
#[derive(Default)]
pub(super) struct Written {
    pub(super) chunks: Vec<ChunkEntry>,
    pub(super) files: Vec<FileEntry>,
    /// Offset, size and name of the metadata.
    pub(super) metadata: Vec<(u64, u64, &'static str)>,
}

impl Written {
    /// An upper bound of the size of [`Written::end`], one more chunk and file included.
    pub(super) fn max_end_bytes(&self) -> u64 {
        const FIXED: u64 = 64 << 10;
        const A_CHUNK: u64 = 256;
        let of_files = self.files.iter().map(|file| 128 + file.path.len() as u64);
        FIXED + A_CHUNK * self.chunks.len() as u64 + of_files.sum::<u64>()
    }

    /// All records from the end of the data to the end of a file that has `at` bytes so far.
    pub(super) fn end(&self, at: u64) -> Vec<u8> {
        // There is no checksum of all data: each chunk and file has its own.
        let mut bytes = Body::new().u32(0).record(DATA_END);
        let summary_at = at + bytes.len() as u64;
        let of_summary = bytes.len();
        let mut offsets = Vec::new();
        for (opcode, records) in self.groups() {
            let group_at = at + bytes.len() as u64;
            bytes.extend(&records);
            if !records.is_empty() {
                let offset = Body::new().raw(&[opcode]).u64(group_at);
                offsets.extend(offset.u64(records.len() as u64).record(SUMMARY_OFFSET));
            }
        }
        let offsets_at = at + bytes.len() as u64;
        bytes.extend(offsets);
        bytes.extend(head(FOOTER, FOOTER_BYTES));
        bytes.extend(Body::new().u64(summary_at).u64(offsets_at).as_bytes());
        let checksum = crc32fast::hash(bytes.get(of_summary..).unwrap_or_default());
        bytes.extend(checksum.to_le_bytes());
        bytes.extend(MAGIC);
        bytes
    }

    /// Records of the summary grouped by their opcodes; schemas and channels are handled
    /// separately.
    fn groups(&self) -> Vec<(u8, Vec<u8>)> {
        let announced = |of_kind: u8| -> Vec<u8> {
            let records = Topic::ALL.into_iter().map(Topic::records);
            let parts = records.flat_map(|records| {
                let mut rest = super::wire::Rest(&records);
                std::iter::from_fn(|| rest.record())
                    .filter(|(opcode, _)| *opcode == of_kind)
                    .map(|(opcode, body)| Body::new().raw(body).record(opcode))
                    .collect::<Vec<_>>()
            });
            parts.flatten().collect()
        };
        vec![
            (SCHEMA, announced(SCHEMA)),
            (CHANNEL, announced(CHANNEL)),
            (STATISTICS, self.statistics()),
            (CHUNK_INDEX, self.chunks.iter().flat_map(chunk_index).collect()),
            (
                ATTACHMENT_INDEX,
                self.files.iter().flat_map(attachment_index).collect(),
            ),
            (METADATA_INDEX, self.metadata_index()),
        ]
    }

    fn statistics(&self) -> Vec<u8> {
        let counts = Topic::ALL.map(|topic| {
            let of_topic = self.chunks.iter().map(|chunk| chunk.n_messages[topic as usize]);
            (topic, of_topic.sum::<u64>())
        });
        let first = self.chunks.iter().map(|chunk| chunk.times_ns.0).min();
        let last = self.chunks.iter().map(|chunk| chunk.times_ns.1).max();
        let n_topics = u16::try_from(Topic::ALL.len()).unwrap_or(u16::MAX);
        let body = Body::new().u64(counts.iter().map(|(_, count)| count).sum());
        let body = body
            .u16(n_topics)
            .u32(n_topics.into())
            .u32(count(self.files.len()));
        let body = body.u32(count(self.metadata.len())).u32(count(self.chunks.len()));
        let body = body.u64(first.unwrap_or(0)).u64(last.unwrap_or(0));
        let pairs = counts.iter().fold(Body::new(), |pairs, (topic, count)| {
            pairs.u16(topic.id()).u64(*count)
        });
        body.counted(pairs.as_bytes()).record(STATISTICS)
    }

    fn metadata_index(&self) -> Vec<u8> {
        let records = self.metadata.iter().flat_map(|(at, n_bytes, name)| {
            let body = Body::new().u64(*at).u64(*n_bytes).text(name);
            body.record(METADATA_INDEX)
        });
        records.collect()
    }
}

fn count(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

fn chunk_index(chunk: &ChunkEntry) -> Vec<u8> {
    let body = Body::new().u64(chunk.times_ns.0).u64(chunk.times_ns.1);
    let body = body.u64(chunk.at).u64(chunk.n_bytes);
    let offsets = chunk
        .indices
        .iter()
        .fold(Body::new(), |body, (channel, at)| body.u16(*channel).u64(*at));
    let body = body.counted(offsets.as_bytes()).u64(chunk.n_index_bytes);
    let body = body.text("").u64(chunk.n_record_bytes).u64(chunk.n_record_bytes);
    body.record(CHUNK_INDEX)
}

fn attachment_index(file: &FileEntry) -> Vec<u8> {
    let body = Body::new().u64(file.at).u64(file.n_bytes);
    let body = body.u64(file.time_ns).u64(file.time_ns).u64(file.n_data_bytes);
    body.text(&file.path)
        .text(file.media_type)
        .record(ATTACHMENT_INDEX)
}

/// The media type of an attached file.
pub(super) fn media_type(path: &str) -> &'static str {
    match path.rsplit_once('.') {
        Some((_, "png")) => "image/png",
        Some((_, "jpg" | "jpeg")) => "image/jpeg",
        Some((_, "glb")) => "model/gltf-binary",
        Some((_, "json")) => "application/json",
        _ if path == INDEX_FILE => "application/json",
        _ => "application/octet-stream",
    }
}
