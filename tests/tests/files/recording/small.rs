//! A small recording in memory, and its known properties.

use std::collections::BTreeMap;
use std::ops::Range;

use app_core::recording::{Flushed, Limits, Recording, RecordingError, Writer};
use harness::endless;

/// Bytes of a record before its body.
const HEAD_BYTES: usize = 9;
/// Opcodes of MCAP.
pub(crate) const CHUNK: u8 = 6;
pub(crate) const ATTACHMENT: u8 = 9;
/// The attached file.
pub(crate) const FILE: &str = "toy.glb";

pub(crate) struct Small {
    pub(crate) bytes: Vec<u8>,
    /// After each frame.
    pub(crate) flushed: Vec<Flushed>,
}

/// A finished recording of this number of frames, with a chunk for every 25.
pub(crate) fn small(n_frames: u32) -> Small {
    let session = endless::session().to_string();
    let device = BTreeMap::from([("model".to_owned(), "desk".to_owned())]);
    let mut writer = Writer::new(Vec::new(), &session, device, Limits::default()).unwrap();
    writer.file(0, FILE, b"a toy").unwrap();
    let mut flushed = vec![writer.flushed()];
    for frame in 0..n_frames {
        endless::add(&mut writer, frame).unwrap();
        flushed.push(writer.flushed());
    }
    let (bytes, last) = writer.finish().unwrap();
    flushed.push(last);
    Small { bytes, flushed }
}

pub(crate) fn open(bytes: &[u8]) -> Result<Recording, RecordingError> {
    Recording::open(bytes.to_vec())
}

/// Opcode and position of each record outside of chunks.
pub(crate) fn records(bytes: &[u8]) -> Vec<(u8, Range<usize>)> {
    let mut records = Vec::new();
    let mut at = 8;
    while bytes.len() - at > HEAD_BYTES {
        let length = u64::from_le_bytes(bytes[at + 1..at + HEAD_BYTES].try_into().unwrap());
        let end = at + HEAD_BYTES + usize::try_from(length).unwrap();
        records.push((bytes[at], at..end));
        at = end;
    }
    assert_eq!(&bytes[at..], b"\x89MCAP0\r\n");
    records
}
