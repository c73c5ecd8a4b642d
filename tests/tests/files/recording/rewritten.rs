//! Recordings as other programs rewrite them: with compressed chunks, without chunks, or several
//! recordings in one file.

use app_core::recording::{Loss, Recording, RecordingError};
use app_core::session::{Files, INDEX_FILE, MAX_INDEX_BYTES};
use harness::endless::{compare, picture};
use ruzstd::encoding::{CompressionLevel, compress_to_vec};

use crate::recording::small::{ATTACHMENT, CHUNK, FILE, open, records, small};

const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const MESSAGE_INDEX: u8 = 7;
const DATA_END: u8 = 15;
const HEAD_BYTES: usize = 9;
const N_FRAMES: u32 = 60;

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

/// Records of an uncompressed chunk.
fn records_of(chunk: &[u8]) -> &[u8] {
    &chunk[HEAD_BYTES + 40..]
}

/// A chunk with these records, compressed; `n_bytes` is the stated size.
fn chunk(name: &str, records: &[u8], stored: &[u8], n_bytes: u64) -> Vec<u8> {
    let body = [
        &[0; 16][..],
        &n_bytes.to_le_bytes(),
        &crc32fast::hash(records).to_le_bytes(),
        &u32::try_from(name.len()).unwrap().to_le_bytes(),
        name.as_bytes(),
        &(stored.len() as u64).to_le_bytes(),
        stored,
    ];
    record(CHUNK, &body.concat())
}

fn zstd(records: &[u8]) -> Vec<u8> {
    compress_to_vec(records, CompressionLevel::Fastest)
}

fn lz4(records: &[u8]) -> Vec<u8> {
    let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
    std::io::Write::write_all(&mut encoder, records).unwrap();
    encoder.finish().unwrap()
}

/// A recording with each chunk made anew. Indices are dropped, since they are not needed.
fn with_chunks(bytes: &[u8], made: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let mut anew = bytes[..8].to_vec();
    for (opcode, place) in records(bytes) {
        match opcode {
            CHUNK => anew.extend(made(records_of(&bytes[place]))),
            MESSAGE_INDEX => {}
            _ => anew.extend_from_slice(&bytes[place]),
        }
    }
    anew.extend_from_slice(&bytes[..8]);
    anew
}

fn compressed(bytes: &[u8], name: &str, stored: fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    with_chunks(bytes, |records| {
        chunk(name, records, &stored(records), records.len() as u64)
    })
}

/// Every record of a chunk, in turn.
fn each(mut records: &[u8]) -> Vec<&[u8]> {
    let mut all = Vec::new();
    while let Some(head) = records.first_chunk::<HEAD_BYTES>() {
        let length = u64::from_le_bytes(head[1..].try_into().unwrap());
        let (one, rest) = records.split_at(HEAD_BYTES + usize::try_from(length).unwrap());
        all.push(one);
        records = rest;
    }
    all
}

/// All messages outside of chunks, each schema and channel once, with the checksum of all data.
fn unchunked(bytes: &[u8]) -> Vec<u8> {
    let mut known = Vec::new();
    let mut anew = bytes[..8].to_vec();
    for (opcode, place) in records(bytes) {
        match opcode {
            CHUNK => {
                for one in each(records_of(&bytes[place])) {
                    if one[0] == MESSAGE || !known.contains(&one) {
                        anew.extend_from_slice(one);
                        known.extend((one[0] != MESSAGE).then_some(one));
                    }
                }
            }
            MESSAGE_INDEX => {}
            DATA_END => {
                let checksum = crc32fast::hash(&anew);
                anew.extend(record(DATA_END, &checksum.to_le_bytes()));
            }
            _ => anew.extend_from_slice(&bytes[place]),
        }
    }
    anew.extend_from_slice(&bytes[..8]);
    anew
}

fn is_whole(recording: &Recording) {
    assert!(recording.losses().is_empty(), "{:?}", recording.losses());
    assert_eq!(compare(recording).unwrap(), (0..N_FRAMES).collect::<Vec<_>>());
    assert_eq!(recording.read(FILE, 1 << 20).unwrap(), b"a toy");
    assert_eq!(recording.device()["model"], "desk");
}

#[test]
fn compressed_chunks_and_messages_without_chunks_are_read() {
    let small = small(N_FRAMES);
    let zstd = compressed(&small.bytes, "zstd", zstd);
    let lz4 = compressed(&small.bytes, "lz4", lz4);
    for bytes in [&zstd, &lz4] {
        let has_picture = bytes.windows(200).any(|window| window == &picture(3)[..200]);
        assert!(
            !has_picture || bytes.len() < small.bytes.len(),
            "something is compressed"
        );
    }
    for bytes in [zstd, lz4, unchunked(&small.bytes)] {
        is_whole(&open(&bytes).unwrap());
    }
}

/// The same records, with each frame's entry padded by spaces to `n_bytes`.
fn padded(records: &[u8], n_bytes: usize) -> Vec<u8> {
    const KEY: &[u8] = b"\"entry\":{";
    let of_one = |one: &[u8]| {
        let entry = one.windows(KEY.len()).position(|window| window == KEY);
        let Some(at) = entry.filter(|_| one[0] == MESSAGE) else {
            return one.to_vec();
        };
        let (before, after) = one.split_at(at + KEY.len());
        // The entry's first bracket is before, the message's last one is after.
        let spaces = vec![b' '; n_bytes - after.len()];
        record(MESSAGE, &[&before[HEAD_BYTES..], &spaces, after].concat())
    };
    each(records).into_iter().flat_map(of_one).collect()
}

#[test]
fn frames_beyond_the_limit_of_an_index_are_left_out_and_the_rest_is_read() {
    // Sixteen entries are the limit to the byte, without what is between them.
    let entry_bytes = usize::try_from(MAX_INDEX_BYTES).unwrap() / 16;
    let bytes = with_chunks(&small(20).bytes, |records| {
        let records = padded(records, entry_bytes);
        chunk("", &records, &records, records.len() as u64)
    });
    let recording = open(&bytes).unwrap();
    assert_eq!(
        recording.losses(),
        [Loss::TooMany {
            n_messages: 5,
            max_bytes: MAX_INDEX_BYTES
        }]
    );
    assert_eq!(recording.n_frames(), 15);
    assert!(
        recording.read(INDEX_FILE, MAX_INDEX_BYTES).is_ok(),
        "a session is opened"
    );
}

#[test]
fn damage_of_compressed_chunks_is_told() {
    let small = small(N_FRAMES);
    for (name, stored) in [("zstd", zstd as fn(&[u8]) -> Vec<u8>), ("lz4", lz4)] {
        let mut bytes = compressed(&small.bytes, name, stored);
        let (_, second) = records(&bytes)
            .into_iter()
            .filter(|(opcode, _)| *opcode == CHUNK)
            .nth(1)
            .unwrap();
        let middle = (second.start + second.end) / 2;
        bytes[middle] ^= 0x55;
        let recording = open(&bytes).unwrap();
        assert!(
            recording
                .losses()
                .iter()
                .any(|loss| matches!(loss, Loss::Skipped { .. })),
            "{name}"
        );
        let numbers = compare(&recording).unwrap();
        assert!(
            (10..N_FRAMES as usize).contains(&numbers.len()),
            "{name}: {} frames",
            numbers.len()
        );
    }
    let mut bytes = unchunked(&small.bytes);
    // Within the last picture, where no length is changed.
    let first = picture(N_FRAMES - 1);
    let at = bytes
        .windows(64)
        .position(|window| window == &first[100..164])
        .unwrap();
    bytes[at] ^= 1;
    assert!(open(&bytes).unwrap().losses().contains(&Loss::Changed));
}

/// A stated length determines neither the allocated memory nor the decompressed size.
#[test]
fn lengths_of_compressed_chunks_are_not_believed() {
    let small = small(N_FRAMES);
    for off in [-1_i64, 1, 1 << 20, 1 << 40] {
        let bytes = with_chunks(&small.bytes, |records| {
            let stated = (records.len() as u64).saturating_add_signed(off);
            chunk("zstd", records, &zstd(records), stated)
        });
        assert!(
            matches!(open(&bytes), Err(RecordingError::NoSession { .. })),
            "{off} bytes more than there are"
        );
    }
    // Zeros: a thousand chunks with far more content than their compressed size.
    let zeros = vec![0; 32 << 20];
    let bomb = chunk("zstd", &zeros, &zstd(&zeros), zeros.len() as u64);
    assert!(bomb.len() < 64 << 10);
    let mut bytes = small.bytes[..8].to_vec();
    for _ in 0..400 {
        bytes.extend_from_slice(&bomb);
    }
    let start = std::time::Instant::now();
    assert!(open(&bytes).is_err());
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

/// With other sequence numbers.
fn renumbered(bytes: &[u8], number: impl Fn(u32) -> u32) -> Vec<u8> {
    with_chunks(bytes, |records| {
        let mut anew = Vec::new();
        for one in each(records) {
            let at = anew.len() + HEAD_BYTES + 2;
            anew.extend_from_slice(one);
            if one[0] == MESSAGE {
                let kept = u32::from_le_bytes(anew[at..at + 4].try_into().unwrap());
                anew[at..at + 4].copy_from_slice(&number(kept).to_le_bytes());
            }
        }
        chunk("lz4", &anew, &lz4(&anew), anew.len() as u64)
    })
}

#[test]
fn sequence_numbers_that_a_program_did_not_keep_are_counted() {
    let small = small(N_FRAMES);
    is_whole(&open(&renumbered(&small.bytes, |_| 0)).unwrap());
    is_whole(&open(&renumbered(&small.bytes, |kept| kept + 1)).unwrap());
}

/// Without sequence numbers, the pictures after a gap cannot be identified: none is assigned to a
/// wrong frame.
#[test]
fn without_sequence_numbers_pictures_behind_a_gap_are_left_out() {
    let small = small(N_FRAMES);
    let anew = renumbered(&small.bytes, |_| 0);
    let chunks: Vec<_> = records(&anew)
        .into_iter()
        .filter(|(opcode, _)| *opcode == CHUNK)
        .map(|(_, place)| place)
        .collect();
    assert!(chunks.len() > 2);
    let first = small
        .flushed
        .iter()
        .find(|flushed| flushed.n_chunks == 1)
        .unwrap();
    let mut damaged = anew.clone();
    damaged[chunks[1].end - 9] ^= 0x55;
    let removed = [&anew[..chunks[1].start], &anew[chunks[1].end..]].concat();
    for (what, bytes) in [("damaged", damaged), ("removed", removed)] {
        let recording = open(&bytes).unwrap();
        assert_eq!(
            compare(&recording).unwrap(),
            (0..first.n_frames).collect::<Vec<_>>(),
            "{what}"
        );
        let is_reported = recording
            .losses()
            .iter()
            .any(|loss| matches!(loss, Loss::Pictures { .. }));
        assert!(is_reported, "{what}: {:?}", recording.losses());
    }
}

#[test]
fn others_messages_are_left_out_and_two_sessions_refused() {
    let small = small(N_FRAMES);
    let text = |text: &str| [&u32::try_from(text.len()).unwrap().to_le_bytes(), text.as_bytes()].concat();
    let schema = [
        &77_u16.to_le_bytes()[..],
        &text("Pose"),
        &text("ros1msg"),
        &text("float64 x"),
    ]
    .concat();
    let channel = [
        &88_u16.to_le_bytes()[..],
        &77_u16.to_le_bytes(),
        &text("/odom"),
        &text("ros1"),
        &[0; 4],
    ]
    .concat();
    let message = [&88_u16.to_le_bytes()[..], &[0; 20], b"whatever"].concat();
    let merged = with_chunks(&small.bytes, |records| {
        let anew = [
            record(SCHEMA, &schema),
            record(CHANNEL, &channel),
            record(MESSAGE, &message),
            records.to_vec(),
        ]
        .concat();
        chunk("zstd", &anew, &zstd(&anew), anew.len() as u64)
    });
    is_whole(&open(&merged).unwrap());
    let end = |bytes: &[u8]| {
        records(bytes)
            .into_iter()
            .find(|(opcode, _)| *opcode == DATA_END)
            .unwrap()
            .1
    };
    let first = &small.bytes[..end(&small.bytes).start];
    let second: Vec<u8> = records(&small.bytes)
        .into_iter()
        .filter(|(opcode, _)| [CHUNK, ATTACHMENT].contains(opcode))
        .flat_map(|(_, place)| small.bytes[place].to_vec())
        .collect();
    let rest = &small.bytes[end(&small.bytes).start..];
    let twice = [first, &second, rest].concat();
    assert_eq!(open(&twice).err(), Some(RecordingError::TwoSessions));
}
