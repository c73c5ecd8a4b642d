//! The readable part of a recording that is cut, or in which a byte is changed.

use app_core::recording::{Loss, RecordingError};
use app_core::session::Files;
use harness::endless::{compare, picture};
use measure::random::Random;

use crate::recording::small::{ATTACHMENT, CHUNK, FILE, Small, open, records, small};

/// Number of frames that must be readable from the first `n_bytes` bytes: those of chunks that end
/// before.
fn whole_frames(small: &Small, n_bytes: usize) -> u32 {
    let n_chunks = records(&small.bytes)
        .iter()
        .filter(|(opcode, place)| *opcode == CHUNK && place.end <= n_bytes)
        .count();
    let by_chunk = small
        .flushed
        .iter()
        .filter(|flushed| flushed.n_chunks as usize <= n_chunks);
    by_chunk.map(|flushed| flushed.n_frames).max().unwrap()
}

/// Reads the first `n_bytes` bytes, and returns whether they were all.
fn cut(small: &Small, n_bytes: usize) {
    let n_frames = whole_frames(small, n_bytes);
    match open(&small.bytes[..n_bytes]) {
        Ok(recording) => {
            let numbers = compare(&recording).unwrap();
            assert_eq!(
                numbers,
                (0..n_frames).collect::<Vec<_>>(),
                "{n_bytes} bytes are left"
            );
            let is_reported = recording
                .losses()
                .iter()
                .any(|loss| matches!(loss, Loss::Cut { .. } | Loss::Unfinished { .. }));
            assert_eq!(
                is_reported,
                n_bytes < small.bytes.len(),
                "{n_bytes} bytes are left"
            );
        }
        // The first chunk contains the session.
        Err(RecordingError::NoSession { .. } | RecordingError::NotMcap) => {
            assert_eq!(n_frames, 0, "{n_bytes} bytes are left");
        }
        Err(error) => panic!("{n_bytes} bytes are left: {error}"),
    }
}

#[test]
fn a_cut_recording_is_read_up_to_its_last_whole_chunk() {
    let small = small(80);
    let records = records(&small.bytes);
    assert!(records.iter().filter(|(opcode, _)| *opcode == CHUNK).count() >= 4);
    // At each boundary, and beside it.
    for (_, place) in &records {
        for n_bytes in [
            place.start.saturating_sub(1),
            place.start,
            place.start + 1,
            place.end - 1,
            place.end,
        ] {
            cut(&small, n_bytes);
        }
    }
    let mut random = Random::new(3);
    for _ in 0..300 {
        #[expect(clippy::cast_possible_truncation, reason = "a place in a small file")]
        let n_bytes = (random.uniform() * small.bytes.len() as f64) as usize;
        cut(&small, n_bytes);
    }
    cut(&small, small.bytes.len());
}

/// The meaning of a byte's position: the chunk or file to which it belongs, or neither.
fn flip(small: &Small, records: &[(u8, std::ops::Range<usize>)], at: usize) {
    let mut bytes = small.bytes.clone();
    bytes[at] ^= 1 << (at % 8);
    let recording = open(&bytes).unwrap_or_else(|error| panic!("byte {at}: {error}"));
    let numbers = compare(&recording).unwrap_or_else(|error| panic!("byte {at}: {error}"));
    let record = records.iter().find(|(_, place)| place.contains(&at));
    let lost = match record {
        Some((CHUNK, place)) => whole_frames(small, place.start)..whole_frames(small, place.end),
        _ => 0..0,
    };
    let is_kept = |frame: &u32| !lost.contains(frame);
    let all = small.flushed.last().unwrap().n_frames;
    let expected: Vec<u32> = (0..all).filter(is_kept).collect();
    // Times of a chunk are meant for viewers, and no checksum protects them: wrong ones do not lose
    // the chunk.
    let is_all = numbers.len() == all as usize;
    assert!(
        numbers == expected || is_all,
        "byte {at}: {numbers:?} are read of {expected:?}"
    );
    let file = recording.read(FILE, 1 << 20).ok();
    assert!(
        file.is_none() || file.as_deref() == Some(b"a toy"),
        "byte {at}: another file"
    );
    let is_whole = is_all && file.is_some();
    assert!(
        is_whole || !recording.losses().is_empty(),
        "byte {at}: a loss is not told"
    );
    if let Some((ATTACHMENT, _)) = record {
        assert!(file.is_none() && is_all, "byte {at}");
    }
}

#[test]
fn a_flipped_byte_loses_one_chunk_and_says_so() {
    let small = small(60);
    let records = records(&small.bytes);
    // All bytes around the beginnings of records, which hold lengths and kinds, and some of all
    // others.
    let near = |at: &usize| {
        records
            .iter()
            .any(|(_, place)| (place.start..place.start + 80).contains(at))
    };
    let n_flipped = (0..small.bytes.len())
        .filter(|at| near(at) || at % 131 == 0)
        .map(|at| flip(&small, &records, at))
        .count();
    assert!(n_flipped > 1500, "{n_flipped}");
}

#[test]
fn a_damaged_chunk_is_lost_with_its_number() {
    let small = small(80);
    let chunks: Vec<_> = records(&small.bytes)
        .into_iter()
        .filter(|(opcode, _)| *opcode == CHUNK)
        .collect();
    let place = &chunks[1].1;
    let mut bytes = small.bytes.clone();
    bytes[place.end - 10] ^= 1;
    let recording = open(&bytes).unwrap();
    let chunk = Loss::Chunks {
        first: 1,
        n_chunks: 1,
    };
    assert!(recording.losses().contains(&chunk), "{:?}", recording.losses());
    // Also without any trace of it.
    let gone = [&small.bytes[..place.start], &small.bytes[place.end..]].concat();
    assert_eq!(open(&gone).unwrap().losses(), [chunk]);
    assert!(open(&small.bytes).unwrap().losses().is_empty());
}

/// Control for the comparison: a picture of another frame is detected.
#[test]
fn another_picture_is_found() {
    let small = small(30);
    let at = |frame: u32| {
        let bytes = picture(frame);
        let found = small
            .bytes
            .windows(bytes.len())
            .position(|window| window == bytes);
        found.unwrap()
    };
    let mut bytes = small.bytes.clone();
    bytes[at(3) + 20] ^= 1;
    // Its checksum is corrected, as if it had been written that way.
    let (_, place) = records(&small.bytes)
        .into_iter()
        .find(|(opcode, _)| *opcode == CHUNK)
        .unwrap();
    let checksum = crc32fast::hash(&bytes[place.start + 49..place.end]);
    bytes[place.start + 33..place.start + 37].copy_from_slice(&checksum.to_le_bytes());
    let error = compare(&open(&bytes).unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "picture 3");
}
