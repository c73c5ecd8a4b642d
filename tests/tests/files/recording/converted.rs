//! A session that is converted to a recording and back stays the same.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use app_core::session::{Capture, Files, GroundTruth, Session};
use desk::convert::write;
use desk::files::{BUNDLED_SESSION, Folder};
use desk::import::write_transforms;
use desk::stored::Stored;
use harness::bundled_session;
use harness::session_format::example;
use harness::temporary::Temporary;
use serde_json::Value;

use crate::recording::small::small;

/// All files by their paths.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let opened = Folder::open(folder).unwrap();
    let paths = opened.paths().unwrap().into_iter();
    paths
        .map(|path| (path.clone(), opened.read(&path, u64::MAX - 1).unwrap()))
        .collect()
}

/// Index, and all other files.
fn parts(folder: &Path) -> (Value, BTreeMap<String, Vec<u8>>) {
    let mut files = files(folder);
    let index = files.remove("capture.json").unwrap();
    (serde_json::from_slice(&index).unwrap(), files)
}

/// Folder to recording to folder to recording: the folders, and both recordings.
fn round(session: &Path, folder: &Temporary) -> [Vec<u8>; 2] {
    let [first, back, second] = ["first.mcap", "back", "second.mcap"].map(|name| folder.0.join(name));
    write(&Stored::open(session).unwrap(), None, &first).unwrap();
    write(&Stored::open(&first).unwrap(), None, &back).unwrap();
    write(&Stored::open(&back).unwrap(), None, &second).unwrap();
    assert_eq!(parts(session), parts(&back));
    [first, second].map(|path| fs::read(path).unwrap())
}

#[test]
fn the_bundled_session_comes_back_byte_for_byte() {
    let folder = Temporary::new("recording");
    round(Path::new(BUNDLED_SESSION), &folder);
    // Both are read as the same, ground truth included.
    let given = bundled_session();
    let recorded = Capture::open(Stored::open(folder.0.join("first.mcap")).unwrap()).unwrap();
    assert_eq!(given.n_frames(), recorded.n_frames());
    for index in 0..given.n_frames() {
        let [given_frame, recorded_frame] = [&given, &recorded].map(|capture| capture.frame(index).unwrap());
        assert!(given_frame.image.rgba8 == recorded_frame.image.rgba8);
        assert_eq!(
            given_frame.camera.world_from_camera,
            recorded_frame.camera.world_from_camera
        );
        let [given_truth, recorded_truth] = [&given, &recorded].map(|capture| capture.truth(index).unwrap());
        assert!(given_truth.unwrap().image.rgba8 == recorded_truth.unwrap().image.rgba8);
    }
}

/// Every key, frames that share pictures, files in folders, files that no key names, numbers with more digits than a double.
#[test]
fn every_key_and_every_file_comes_back() {
    let folder = Temporary::new("recording");
    let session = folder.0.join("session");
    fs::create_dir_all(session.join("in/it")).unwrap();
    let mut index: Value = serde_json::from_str(example().unwrap()).unwrap();
    index["frames"][1]["image"] = index["frames"][0]["image"].clone();
    index["frames"][1]["made_up"] = serde_json::json!({ "nested": [1, null, "text"] });
    let text = index.to_string().replace(
        "0.0333",
        "3.33000000000000000000000000000000000000000000000000000001e-2",
    );
    fs::write(session.join("capture.json"), &text).unwrap();
    for path in [
        "toy.glb",
        "plate.png",
        "frame_0000.png",
        "truth_0000.png",
        "in/it/remark.txt",
    ] {
        fs::write(session.join(path), format!("bytes of {path}")).unwrap();
    }
    fs::write(session.join("notes.jsonl"), "{\"time_ns\":18446744073709551615,\"topic\":\"/events\",\"message\":{\"a\":1}}\n{\"time_ns\":5,\"topic\":\"/light\",\"message\":{}}\n").unwrap();
    fs::write(session.join("device.json"), "{\n  \"model\": \"desk\"\n}").unwrap();
    let [first, second] = round(&session, &folder);
    assert!(first == second, "a recording differs from one of its folder");
    let digits = fs::read_to_string(folder.0.join("back/capture.json")).unwrap();
    assert!(digits.contains("3.33000000000000000000000000000000000000000000000000000001e-2"));
}

#[test]
fn nothing_is_written_over_or_out_of_the_folder() {
    let folder = Temporary::new("recording");
    let session = Stored::open(BUNDLED_SESSION).unwrap();
    let out = folder.0.join("there");
    fs::write(&out, "").unwrap();
    assert!(write(&session, None, &out).is_err());
    assert!(fs::read(&out).unwrap().is_empty());
    // Nothing is written into a session, of which it would be a file.
    let own = folder.0.join("own");
    write(&session, None, &own).unwrap();
    let before = files(&own);
    let session = Stored::open(&own).unwrap();
    for name in ["own.mcap", "new/own.mcap", "new/folder"] {
        let inside = own.join(name);
        let error = write(&session, None, &inside).unwrap_err().to_string();
        assert!(
            error.ends_with("lies in the session itself: name a path outside of it"),
            "{error}"
        );
        assert!(write_transforms(&session, &inside).is_err(), "{name}");
    }
    assert!(files(&own) == before && !own.join("new").exists());
    // Folders on the way are made.
    write(&session, None, &folder.0.join("new/other/own.mcap")).unwrap();
    // A recording may contain any names.
    let bytes = small(1).bytes;
    let at = bytes.windows(7).position(|window| window == b"toy.glb").unwrap();
    let mut evil = bytes.clone();
    evil[at..at + 7].copy_from_slice(b"../glbb");
    let record = crate::recording::small::records(&bytes)
        .into_iter()
        .find(|(opcode, _)| *opcode == crate::recording::small::ATTACHMENT);
    let place = record.unwrap().1;
    let checksum = crc32fast::hash(&evil[place.start + 9..place.end - 4]);
    evil[place.end - 4..place.end].copy_from_slice(&checksum.to_le_bytes());
    let path = folder.0.join("evil.mcap");
    fs::write(&path, &evil).unwrap();
    let evil = Stored::open(&path).unwrap();
    assert!(evil.losses().is_empty());
    write(&evil, None, &folder.0.join("written")).unwrap();
    assert!(!folder.0.join("glbb").exists());
    let names: Vec<String> = files(&folder.0.join("written")).into_keys().collect();
    assert_eq!(
        names,
        ["capture.json", "device.json", "frame_000000.jpg", "notes.jsonl"]
    );
}
