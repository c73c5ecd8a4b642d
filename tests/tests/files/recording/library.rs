//! The crate `mcap` reads our recordings, checksums and summary included, and our reader reads its
//! recordings.

use std::io::Cursor;

use app_core::recording::{Loss, Topic};
use app_core::session::Files;
use harness::endless::{compare, entry, picture};
use mcap::read::{Options, attachment, metadata};
use mcap::{Attachment, MessageStream, Summary, WriteOptions};

use crate::recording::small::{FILE, open, small};

#[test]
fn the_library_reads_ours() {
    let small = small(60);
    let summary = Summary::read(&small.bytes).unwrap().unwrap();
    let statistics = summary.stats.clone().unwrap();
    let messages = MessageStream::new_with_options(&small.bytes, Options::ValidateChunkCrcs.into()).unwrap();
    let messages = messages.collect::<Result<Vec<_>, _>>().unwrap();
    assert_eq!(statistics.message_count, messages.len() as u64);
    for topic in Topic::ALL {
        let n_messages = messages
            .iter()
            .filter(|message| message.channel.topic == topic.name())
            .count();
        let id = summary
            .channels
            .iter()
            .find(|(_, channel)| channel.topic == topic.name())
            .unwrap()
            .0;
        assert_eq!(statistics.channel_message_counts[id], n_messages as u64);
        let expected = match topic {
            Topic::Session => summary.chunk_indexes.len(),
            Topic::Image | Topic::Frame | Topic::Calibration | Topic::Transform | Topic::Light => 60,
            _ => 0,
        };
        assert_eq!(n_messages, expected, "{}", topic.name());
    }
    // The index leads to the same messages.
    for chunk in &summary.chunk_indexes {
        let indices = summary.read_message_indexes(&small.bytes, chunk).unwrap();
        assert!(indices.values().all(|entries| !entries.is_empty()));
        for entry in indices.values().flatten() {
            summary.seek_message(&small.bytes, chunk, entry).unwrap();
        }
    }
    let file = attachment(&small.bytes, &summary.attachment_indexes[0]).unwrap();
    assert_eq!((file.name.as_str(), &*file.data), (FILE, &b"a toy"[..]));
    let device = metadata(&small.bytes, &summary.metadata_indexes[0]).unwrap();
    assert_eq!(device.metadata["model"], "desk");
}

#[test]
fn we_read_the_librarys() {
    let small = small(60);
    let options = WriteOptions::new().chunk_size(Some(20_000));
    let mut writer = options.create(Cursor::new(Vec::new())).unwrap();
    let file = Attachment {
        log_time: 0,
        create_time: 0,
        name: FILE.to_owned(),
        media_type: String::new(),
        data: b"a toy"[..].into(),
    };
    writer.attach(&file).unwrap();
    for message in MessageStream::new(&small.bytes).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    let bytes = writer.into_inner().into_inner();
    let recording = open(&bytes).unwrap();
    assert!(recording.losses().is_empty(), "{:?}", recording.losses());
    assert_eq!(compare(&recording).unwrap(), (0..60).collect::<Vec<_>>());
    assert_eq!(recording.read(FILE, 1 << 20).unwrap(), b"a toy");
    assert_eq!(recording.notes().len(), 60);
    assert_eq!(recording.device()["model"], "desk");
}

/// Pictures are stored in a Foxglove message as a protocol buffer: field 2, after a tag and a
/// length.
#[test]
fn a_picture_is_a_field_of_its_message() {
    let small = small(2);
    let messages = MessageStream::new(&small.bytes).unwrap();
    let image = messages
        .map(Result::unwrap)
        .find(|message| message.channel.topic == "/camera/image")
        .unwrap();
    let schema = image.channel.schema.as_ref().unwrap();
    assert_eq!(
        (schema.name.as_str(), schema.encoding.as_str()),
        ("foxglove.CompressedImage", "protobuf")
    );
    let picture = picture(0);
    let n_bytes = picture.len();
    #[expect(clippy::cast_possible_truncation, reason = "seven bits are kept")]
    let head = [2 << 3 | 2, 0x80 | (n_bytes & 0x7f) as u8, (n_bytes >> 7) as u8];
    let field = [&head[..], &picture].concat();
    assert!(image.data.windows(field.len()).any(|window| window == field));
    assert!(entry(0)["image"].is_string());
    assert!(!matches!(
        open(&small.bytes).unwrap().losses(),
        [Loss::Cut { .. }, ..]
    ));
}
