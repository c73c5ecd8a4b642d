//! A folder of the file system returns its own files, and nothing else.

use std::fs;
use std::path::Path;

use app_core::session::{FileError, Files, PathError};
use desk::files::Folder;
use harness::temporary::Temporary;

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

#[cfg(unix)]
fn link(to: &Path, from: &Path) {
    std::os::unix::fs::symlink(to, from).unwrap();
}

#[cfg(windows)]
fn link(to: &Path, from: &Path) {
    std::os::windows::fs::symlink_file(to, from).unwrap();
}
