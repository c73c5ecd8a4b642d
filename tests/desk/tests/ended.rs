//! Replays that end early: a foreseeable error is reported before the first frame, and any other
//! error leaves the earlier frames.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process;

use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::session::Capture;
use app_core::wgpu;
use desk::files::{BUNDLED_SESSION, Folder, SESSION_FILE};
use desk::page::PAGE_FILE;
use desk::progress::Quiet;
use desk::replay::{Options, REPORT_FILE, ReplayError, replay};
use serde_json::{Value, json};

/// A session that removes itself.
struct Session(PathBuf);

impl Drop for Session {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The bundled session whose third frame has another picture.
fn session(name: &str, picture: Option<&[u8]>) -> Session {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("ended-{name}-{}", process::id()));
    fs::create_dir_all(&folder).unwrap();
    for entry in fs::read_dir(BUNDLED_SESSION).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
    }
    let index = folder.join(SESSION_FILE);
    let mut value: Value = serde_json::from_slice(&fs::read(&index).unwrap()).unwrap();
    value["frames"][2]["image"] = json!("third.png");
    fs::write(&index, value.to_string()).unwrap();
    if let Some(picture) = picture {
        fs::write(folder.join("third.png"), picture).unwrap();
    }
    Session(folder)
}

fn replayed(session: &Session) -> ReplayError {
    let capture = Capture::open(Folder::open(&session.0).unwrap()).unwrap();
    let instance = wgpu::Instance::default();
    let mut core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest)).unwrap();
    let options = Options {
        out: Some(session.0.join("out")),
        is_aligned: false,
        ..Options::default()
    };
    let replayed = replay(&capture, Some(&capture), &mut core, &options, &mut Quiet);
    replayed.err().unwrap()
}

#[test]
fn what_can_be_known_is_refused_before_the_first_frame() {
    let whole = fs::read(Path::new(BUNDLED_SESSION).join("frame_0000.png")).unwrap();
    // A picture of another size: the header alone is changed, and its checksum.
    let mut wide = whole.clone();
    wide[16..20].copy_from_slice(&641_u32.to_be_bytes());
    let checksum = crc32fast::hash(&wide[12..29]).to_be_bytes();
    wide[29..33].copy_from_slice(&checksum);
    for (name, picture, expected) in [
        (
            "missing",
            None,
            "third.png (frames[2].image): the file does not exist",
        ),
        (
            "text",
            Some(&b"not a picture"[..]),
            "third.png (frames[2].image): neither PNG nor JPEG",
        ),
        (
            "wide",
            Some(&wide[..]),
            "third.png (frames[2].image): the picture is 641 x 360 px",
        ),
    ] {
        let session = session(name, picture);
        let error = replayed(&session).to_string();
        assert!(error.starts_with(expected), "{error}");
        assert!(!session.0.join("out").exists(), "{name}: something was begun");
    }
}

/// Runs a program, and returns its error.
fn refused(program: &str, args: &[&Path]) -> String {
    let output = process::Command::new(program).args(args).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// The session would end the long work with an error of its own.
#[test]
fn an_output_that_exists_is_refused_before_long_work() {
    let session = session("existing", None);
    let out = session.0.with_extension("out");
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("mine.txt"), "mine").unwrap();
    let [dir, lens, found] = ["--out", "--lens", "found"].map(Path::new);
    let error = refused(env!("CARGO_BIN_EXE_align"), &[&session.0, dir, &out]);
    assert!(error.contains("exists already"), "{error}");
    let inside = session.0.join("inside");
    let error = refused(env!("CARGO_BIN_EXE_align"), &[&session.0, dir, &inside]);
    assert!(error.contains("lies in the session itself"), "{error}");
    let error = refused(
        env!("CARGO_BIN_EXE_replay"),
        &[&session.0, lens, found, dir, &out],
    );
    assert!(
        error.contains("mine.txt was not written by an earlier run"),
        "{error}"
    );
    fs::remove_dir_all(&out).unwrap();
}

#[test]
fn what_was_made_before_a_frame_fails_has_report_and_page() {
    let whole = fs::read(Path::new(BUNDLED_SESSION).join("frame_0000.png")).unwrap();
    // The header is intact, the pixels are cut off.
    let session = session("cut", Some(&whole[..whole.len() / 2]));
    let error = replayed(&session);
    assert!(matches!(error, ReplayError::Ended { n_frames: 2, .. }), "{error}");
    let out = session.0.join("out");
    let report: Value = serde_json::from_slice(&fs::read(out.join(REPORT_FILE)).unwrap()).unwrap();
    assert_eq!(report["frames"].as_array().unwrap().len(), 2);
    for told in [&report["ended"], &report["warnings"][0]] {
        let told = told.as_str().unwrap();
        assert!(
            told.contains("third.png (frames[2].image): damaged picture"),
            "{told}"
        );
    }
    assert!(report["mean"]["n_scored"] == 2 && out.join("frame_0001.png").exists());
    assert!(
        fs::read_to_string(out.join(PAGE_FILE))
            .unwrap()
            .contains("third.png")
    );
}
