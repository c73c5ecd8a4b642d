//! A writer observes its limits, a queue never waits, and a reader does not allocate memory on the
//! word of a file.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use std::{sync::mpsc, thread};

use app_core::recording::{
    Flushed, Item, Limits, Picture, Recording, RecordingError, Source, Stop, Topic, WriteError, Writer, queue,
};
use app_core::session::{FileError, Files, INDEX_FILE, MAX_INDEX_BYTES};
use harness::endless::{add, compare, entry, picture, session, time_ns};

use crate::recording::small::{open, small};

fn writer<W: Write>(sink: W, limits: Limits) -> Writer<W> {
    Writer::new(sink, &session().to_string(), BTreeMap::new(), limits).unwrap()
}

/// Adds frames until the writer stops, and finishes it.
fn filled(limits: Limits, free_bytes: Option<u64>) -> (Stop, Vec<u8>, Flushed) {
    let mut writer = writer(Vec::new(), limits);
    writer.tick(0, free_bytes).unwrap();
    let error = (0..10_000)
        .find_map(|frame| add(&mut writer, frame).err())
        .unwrap();
    let WriteError::Stopped(stop) = error.downcast().unwrap() else {
        panic!("not stopped");
    };
    assert_eq!(writer.stopped(), Some(&stop));
    // It stays stopped.
    assert!(writer.tick(0, None).is_err());
    let (bytes, flushed) = writer.finish().unwrap();
    (stop, bytes, flushed)
}

#[test]
fn a_recording_stops_within_its_limits_and_is_whole() {
    const ROOM: u64 = 2 << 20;
    let sized = Limits {
        max_bytes: ROOM,
        ..Limits::default()
    };
    let spaced = Limits {
        min_free_bytes: ROOM,
        ..Limits::default()
    };
    for (stop, bytes, flushed) in [filled(sized, None), filled(spaced, Some(2 * ROOM))] {
        assert!(matches!(
            stop,
            Stop::Size { max_bytes: ROOM } | Stop::Space { min_free_bytes: ROOM }
        ));
        assert!(
            bytes.len() as u64 <= ROOM && bytes.len() as u64 > ROOM / 2,
            "{stop}"
        );
        let recording = open(&bytes).unwrap();
        assert!(recording.losses().is_empty());
        assert_eq!(compare(&recording).unwrap().len(), flushed.n_frames as usize);
        assert!(flushed.n_frames > 50);
    }
}

#[test]
fn a_writer_stops_before_the_index_is_larger_than_a_reader_accepts() {
    let mut writer = writer(Vec::new(), Limits::default());
    let written = (0..20).find_map(|number| {
        let spaces = " ".repeat(1 << 20);
        let entry = entry(number).to_string().replacen('{', &format!("{{{spaces}"), 1);
        let time_ns = time_ns(number);
        let stopped = writer.frame(time_ns, Picture::New(&picture(number)), &entry);
        stopped.err().map(|error| (number, error))
    });
    let stop = Stop::Index {
        max_bytes: MAX_INDEX_BYTES,
    };
    assert_eq!(written, Some((15, WriteError::Stopped(stop))));
    let (bytes, flushed) = writer.finish().unwrap();
    let recording = open(&bytes).unwrap();
    assert_eq!((flushed.n_frames, recording.n_frames()), (15, 15));
    assert!(recording.losses().is_empty());
    assert!(recording.read(INDEX_FILE, MAX_INDEX_BYTES).is_ok());
}

/// A device that is suddenly full, in the middle of a record.
struct Full {
    bytes: Arc<std::sync::Mutex<Vec<u8>>>,
}

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut all = self.bytes.lock().unwrap();
        let n_bytes = bytes.len().min(300_000 - all.len());
        if n_bytes == 0 {
            return Err(io::ErrorKind::StorageFull.into());
        }
        all.extend(&bytes[..n_bytes]);
        Ok(n_bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_sink_that_refuses_ends_the_recording_and_leaves_what_was_flushed() {
    let bytes = Arc::default();
    let mut writer = writer(
        Full {
            bytes: Arc::clone(&bytes),
        },
        Limits::default(),
    );
    let error = (0..10_000)
        .find_map(|frame| add(&mut writer, frame).err())
        .unwrap();
    assert!(matches!(
        error.downcast().unwrap(),
        WriteError::Stopped(Stop::Full)
    ));
    let n_frames = writer.flushed().n_frames;
    assert!(writer.finish().is_err());
    let left = bytes.lock().unwrap().clone();
    let recording = open(&left).unwrap();
    assert_eq!(compare(&recording).unwrap().len(), n_frames as usize);
    assert!(n_frames > 0 && !recording.losses().is_empty());
}

#[test]
fn a_second_is_flushed_and_a_clock_that_goes_back_as_well() {
    let mut writer = writer(Vec::new(), Limits::default());
    let mut frame = |number: u32, time_ns: u64| {
        writer
            .frame(
                time_ns,
                Picture::New(&picture(number)),
                &entry(number).to_string(),
            )
            .unwrap();
        writer.flushed().n_frames
    };
    const SECOND: u64 = 1_000_000_000;
    let first = 5 * SECOND;
    assert_eq!(frame(0, first), 0);
    assert_eq!(frame(1, first + SECOND - 1), 0);
    // Content that has waited a second is flushed before the next frame begins another chunk.
    assert_eq!(frame(2, first + SECOND), 2);
    assert_eq!(frame(3, 0), 3);
    writer.tick(SECOND, None).unwrap();
    assert_eq!(writer.flushed().n_frames, 4);
}

#[test]
fn what_is_no_entry_or_names_no_picture_is_refused_and_writes_nothing() {
    let mut writer = writer(Vec::new(), Limits::default());
    for wrong in ["", "[]", "{", "nan"] {
        assert!(matches!(
            writer.frame(0, Picture::New(b""), wrong),
            Err(WriteError::Json { .. })
        ));
    }
    let again = writer.frame(0, Picture::Again(0), "{}");
    assert_eq!(again, Err(WriteError::NoSuchPicture { sequence: 0 }));
    assert!(writer.note(0, Topic::Session, "{}").is_err());
    assert!(writer.set_session("[]").is_err());
    assert_eq!(writer.flush().unwrap().n_chunks, 0);
}

/// A sink that waits for permission to continue.
struct Slow(mpsc::Receiver<()>);

impl Write for Slow {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let _ = self.0.recv();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_frame_never_waits_for_a_writer_that_does_and_drops_are_told() {
    let (go_on, wait) = mpsc::channel();
    let (sender, mut receiver) = queue(8, 100_000);
    let (done, is_done) = mpsc::channel();
    thread::spawn(move || {
        let mut writer = writer(Slow(wait), Limits::default());
        while let Some(written) = receiver.write_next(&mut writer) {
            written.unwrap();
        }
        done.send(writer.flush().unwrap()).unwrap();
    });
    let offer = |number: u32| {
        let item = Item::Frame {
            picture: picture(number),
            entry: entry(number).to_string(),
        };
        sender.offer(time_ns(number), item).is_ok()
    };
    // The sink stands still: this would never end if a frame waited.
    let n_taken = (0..40).filter(|number| offer(*number)).count();
    assert!((1..=9).contains(&n_taken), "{n_taken}");
    assert_eq!(sender.n_dropped(), 40 - n_taken as u64);
    // More than the bytes that may wait, whatever the number of items.
    let huge = Item::File {
        path: "huge".to_owned(),
        bytes: vec![0; 200_000],
    };
    assert!(sender.offer(0, huge).is_err());
    drop(go_on);
    drop(sender);
    let flushed = is_done.recv_timeout(Duration::from_secs(60)).unwrap();
    assert_eq!(flushed.n_frames as usize, n_taken);
}

#[test]
fn drops_stand_in_the_recording() {
    let (sender, mut receiver) = queue(1, u64::MAX);
    let tick = || Item::Tick { free_bytes: None };
    assert!(sender.offer(0, tick()).is_ok());
    assert!(sender.offer(1, tick()).is_err() && sender.offer(2, tick()).is_err());
    drop(sender);
    let mut writer = writer(Vec::new(), Limits::default());
    while let Some(written) = receiver.write_next(&mut writer) {
        written.unwrap();
    }
    let recording = open(&writer.finish().unwrap().0).unwrap();
    let notes = recording.notes();
    assert_eq!(notes.len(), 1);
    assert_eq!(notes[0].topic, Topic::Events);
    assert_eq!(notes[0].message, r#"{"event":"dropped","n_items":2}"#);
}

/// A file that claims to be large, and is zero after its first bytes. It records the largest read.
struct Vast {
    first: Vec<u8>,
    n_bytes: u64,
    most: Arc<AtomicU64>,
}

impl Source for Vast {
    fn n_bytes(&self) -> u64 {
        self.n_bytes
    }

    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<()> {
        self.most.fetch_max(into.len() as u64, Ordering::Relaxed);
        into.fill(0);
        let at = usize::try_from(at).unwrap().min(self.first.len());
        let n_bytes = into.len().min(self.first.len() - at);
        into[..n_bytes].copy_from_slice(&self.first[at..at + n_bytes]);
        Ok(())
    }
}

#[test]
fn no_memory_is_taken_by_a_stated_length() {
    const MIB: u64 = 1 << 20;
    // A chunk and an attached file of 300 MiB, one of them in the file's own bytes.
    let n_records = 300 * MIB;
    let chunk = [
        &[6][..],
        &(n_records + 40).to_le_bytes(),
        &[0; 16],
        &n_records.to_le_bytes(),
        &[1, 2, 3, 4, 0, 0, 0, 0],
        &n_records.to_le_bytes(),
    ];
    let file = [
        &[9][..],
        &(n_records + 36).to_le_bytes(),
        &[0; 16],
        &[0; 8],
        &n_records.to_le_bytes(),
    ];
    for record in [chunk.concat(), file.concat()] {
        let most = Arc::default();
        let vast = Vast {
            first: [&b"\x89MCAP0\r\n"[..], &record].concat(),
            n_bytes: 301 * MIB,
            most: Arc::clone(&most),
        };
        assert!(matches!(
            Recording::open(vast),
            Err(RecordingError::NoSession { .. })
        ));
        assert!(
            most.load(Ordering::Relaxed) <= MIB,
            "{} bytes",
            most.load(Ordering::Relaxed)
        );
    }
    // A picture is limited to the caller's size.
    let recording = open(&small(1).bytes).unwrap();
    let path = entry(0)["image"].as_str().unwrap().to_owned();
    let refused = recording.read(&path, 100);
    assert_eq!(refused, Err(FileError::TooLarge { max_bytes: 100 }));
    assert!(matches!(
        recording.read("../toy.glb", MIB),
        Err(FileError::Path(_))
    ));
}
