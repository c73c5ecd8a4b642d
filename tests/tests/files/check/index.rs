//! Indexes that programs read and write: with a byte order mark, and as long as readers take.

use std::fs;

use app_core::session::{Capture, MAX_INDEX_BYTES, Session};
use desk::alignment::Alignments;
use desk::check::aligned_session::{self, Assumed};
use desk::convert;
use desk::files::{BUNDLED_SESSION, Folder, SESSION_FILE, index_text};
use desk::import::write_transforms;
use desk::stored::Stored;
use film::animate::folder::sources;
use harness::temporary::Temporary;
use serde_json::{Value, json};
use view::feed::Feed;

use super::{changed, wrong};

#[test]
fn an_index_with_a_byte_order_mark_is_read_by_every_program() {
    let session = changed("mark", |index| index["misspelt"] = json!(1));
    let index = session.0.join(SESSION_FILE);
    let marked = [&b"\xef\xbb\xbf"[..], &fs::read(&index).unwrap()].concat();
    fs::write(&index, marked).unwrap();
    assert_eq!(
        wrong(&session.0),
        [format!("{SESSION_FILE} (misspelt): the key is not known")]
    );
    let stored = || Stored::open(&session.0).unwrap();
    let folder = Temporary::new("from-mark");
    let out = |name: &str| folder.0.join(name);
    convert::write(&stored(), None, &out("recording.mcap")).unwrap();
    convert::write(&stored(), None, &out("folder")).unwrap();
    aligned_session::write(&stored(), &out("aligned"), &Alignments::none(), Assumed::Omitted).unwrap();
    write_transforms(&stored(), &out("nerfstudio")).unwrap();
    for name in ["recording.mcap", "folder", "aligned"] {
        let capture = Capture::open(Stored::open(out(name)).unwrap()).unwrap();
        assert_eq!(capture.n_frames(), 5, "{name}");
    }
    assert!(!sources(&stored(), false).unwrap().is_empty());
    assert!(!Feed::of_stored(stored()).unwrap().toy_file().is_empty());
}

/// An index whose entries are as long as those of a phone.
fn long(n_frames: u32) -> Value {
    let text = fs::read_to_string(format!("{BUNDLED_SESSION}/{SESSION_FILE}")).unwrap();
    let mut index: Value = serde_json::from_str(&text).unwrap();
    let entry = index["frames"][0].clone();
    let frames = (0..n_frames).map(|number| {
        let mut entry = entry.clone();
        entry["time"] = json!(f64::from(number) / 64.0);
        entry
    });
    index["frames"] = frames.collect();
    index
}

/// Indented, each number of a matrix has a line of its own.
#[test]
fn a_session_whose_index_fits_can_be_opened_when_it_is_written_anew() {
    let index = long(36_000);
    assert!(format!("{index:#}").len() as u64 > MAX_INDEX_BYTES);
    let session = changed("long", |changed| *changed = index.clone());
    let folder = Temporary::new("from-long");
    let out = folder.0.join("aligned");
    let stored = Stored::open(&session.0).unwrap();
    aligned_session::write(&stored, &out, &Alignments::none(), Assumed::Omitted).unwrap();
    let capture = Capture::open(Folder::open(&out).unwrap()).unwrap();
    assert_eq!(capture.n_frames(), 36_000);
    // The form is that of JSON, with a line for each entry.
    let text = fs::read_to_string(out.join(SESSION_FILE)).unwrap();
    assert!(serde_json::from_str::<Value>(&text).unwrap() == index);
    assert!(text.lines().count() > 36_000 && text.lines().count() < 36_100);
}

#[test]
fn an_index_that_no_reader_takes_is_not_written() {
    let index = long(60_000);
    let error = index_text(&index).unwrap_err().to_string();
    assert!(
        error.starts_with(&format!("{SESSION_FILE}: would have ")),
        "{error}"
    );
    let folder = Temporary::new("too-long");
    let stored = Stored::open(BUNDLED_SESSION).unwrap();
    for name in ["folder", "recording.mcap"] {
        let out = folder.0.join(name);
        let error = convert::write(&stored, Some(index.to_string().into_bytes()), &out).unwrap_err();
        assert!(error.to_string().contains("take fewer frames"), "{error}");
        assert!(!out.exists());
    }
}
