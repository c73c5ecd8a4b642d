//! A folder of the file system returns its own files, and nothing else.

use std::fs;
use std::path::Path;

use app_core::session::{FileError, Files, PathError};
use app_core::toy::Toy;
use desk::files::{BUNDLED_SESSION, Folder, SESSION_FILE};
use desk::stored::Stored;
use harness::temporary::Temporary;
use measure::glb::chunks;
use serde_json::{Value, json};
use view::feed::Feed;

#[test]
fn a_folder_gives_its_own_files_and_no_others() {
    let folder = Temporary::new("session");
    let outside = &folder.0;
    let inside = outside.join("inside");
    fs::create_dir_all(inside.join("sub")).unwrap();
    fs::write(outside.join("secret"), "secret").unwrap();
    fs::write(inside.join("sub/own"), "own").unwrap();
    link(&outside.join("secret"), &inside.join("leaving"));
    link(&inside.join("sub/own"), &inside.join("staying"));
    let absolute = outside.join("secret");

    let folder = Folder::open(&inside).unwrap();
    let cases = [
        ("sub/own", 3, Ok(b"own".to_vec())),
        ("staying", 3, Ok(b"own".to_vec())),
        ("sub/own", 2, Err(FileError::TooLarge { max_bytes: 2 })),
        ("none", 3, Err(FileError::Missing)),
        ("sub", 3, Err(FileError::NotAFile)),
        ("leaving", 9, Err(FileError::Outside)),
        ("sub/../../secret", 9, Err(PathError::Climbs.into())),
        (absolute.to_str().unwrap(), 9, Err(PathError::Absolute.into())),
        ("", 9, Err(PathError::Empty.into())),
    ];
    for (path, max_bytes, expected) in cases {
        assert_eq!(folder.read(path, max_bytes), expected, "{path}");
    }
    let error = Folder::open(inside.join("none")).unwrap_err();
    assert!(error.to_string().contains("none"), "{error}");
}

/// A camera of a session hands its toy on as one file, whatever the toy's file refers to.
#[test]
fn a_feeds_toy_needs_no_other_file() {
    let session = Temporary::new("gltf");
    for entry in fs::read_dir(BUNDLED_SESSION).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, session.0.join(path.file_name().unwrap())).unwrap();
    }
    let glb = fs::read(session.0.join("toy.glb")).unwrap();
    let (mut tree, bin) = chunks(&glb);
    tree["buffers"][0]["uri"] = json!("toy.bin");
    fs::create_dir(session.0.join("toy")).unwrap();
    fs::write(session.0.join("toy/toy.bin"), bin).unwrap();
    fs::write(session.0.join("toy/toy.gltf"), tree.to_string()).unwrap();
    let index = session.0.join(SESSION_FILE);
    let mut value: Value = serde_json::from_slice(&fs::read(&index).unwrap()).unwrap();
    value["toy"]["file"] = json!("toy/toy.gltf");
    fs::write(&index, value.to_string()).unwrap();
    let feed = Feed::of_stored(Stored::open(&session.0).unwrap()).unwrap();
    let toy = Toy::from_glb("toy.glb", &feed.toy_file()).unwrap();
    assert_eq!(toy.indices(), feed.scene().toy.indices());
}

#[cfg(unix)]
fn link(to: &Path, from: &Path) {
    std::os::unix::fs::symlink(to, from).unwrap();
}

#[cfg(windows)]
fn link(to: &Path, from: &Path) {
    std::os::windows::fs::symlink_file(to, from).unwrap();
}
