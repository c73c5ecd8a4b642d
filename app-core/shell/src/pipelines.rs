//! Compiled pipelines, stored between starts: the driver's exported data are returned unchanged to
//! the same driver.
//!
//! Returning them may end the app. So a start removes the file and leaves a note; the newly
//! compiled pipelines replace both. A start that finds such a note does without the data.
//!
//! A file has a line for the key of version, device and driver, one for a checksum of the bytes,
//! then the bytes.

use std::fs;
use std::io;
use std::path::Path;

use crate::kept;

/// Name of the file.
const FILE: &str = "pipelines.bin";
/// Maximum size of the file: reading more would take too long.
const MAX_BYTES: u64 = 64 << 20;

/// The name of the note: a start has begun with the driver's cache, and has not finished compiling.
const NOTE: &str = "pipelines.begun";

/// The way in which a start compiles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Start {
    /// With a cache of the driver, and an earlier start's data in it.
    Cached(Option<Vec<u8>>),
    /// Without a cache, since the previous start did not finish.
    Uncached,
}

/// Begins a start: the stored data are removed, until [`store`] stores the newly compiled ones.
#[must_use]
pub fn begin(folder: &Path, key: &str) -> Start {
    let (file, note) = (folder.join(FILE), folder.join(NOTE));
    let data = read(folder, key);
    let removed = fs::remove_file(file);
    let is_left = matches!(&removed, Err(error) if error.kind() != io::ErrorKind::NotFound);
    if note.exists() {
        // The next start tries again.
        let _ = fs::remove_file(note);
        return Start::Uncached;
    }
    match kept::store(folder, NOTE, b"") {
        Ok(()) if !is_left => Start::Cached(data),
        // Without a note, a fault could end every start.
        _ => Start::Uncached,
    }
}

/// Data stored under a key; `None` if they belong to another driver or version, or are damaged.
fn read(folder: &Path, key: &str) -> Option<Vec<u8>> {
    let path = folder.join(FILE);
    if fs::metadata(&path).ok()?.len() > MAX_BYTES {
        return None;
    }
    let file = fs::read(path).ok()?;
    let mut parts = file.splitn(3, |byte| *byte == b'\n');
    let (kept_key, kept_sum, data) = (parts.next()?, parts.next()?, parts.next()?);
    let is_whole = kept_key == one_line(key).as_bytes() && kept_sum == sum(data).as_bytes();
    is_whole.then(|| data.to_vec())
}

/// Stores bytes under a key, and replaces everything stored before.
///
/// # Errors
/// If the file cannot be written.
pub fn store(folder: &Path, key: &str, data: &[u8]) -> io::Result<()> {
    let file = [one_line(key).as_bytes(), b"\n", sum(data).as_bytes(), b"\n", data].concat();
    kept::store(folder, FILE, &file)?;
    match fs::remove_file(folder.join(NOTE)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

fn one_line(key: &str) -> String {
    key.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// FNV-1a over 64 bits: protection against lost bytes, not against an attack.
fn sum(data: &[u8]) -> String {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    format!("{:016x}", data.iter().fold(0xcbf2_9ce4_8422_2325, step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pipelines_are_kept_for_the_same_driver_and_only_whole() {
        let folder = std::env::temp_dir().join(format!("app-shell-pipelines-{}", std::process::id()));
        let data = [1, b'\n', 2, 0, 255];
        assert_eq!(read(&folder, "one"), None);
        store(&folder, "one\ndriver", &data).expect("a file");
        assert_eq!(read(&folder, "one driver").as_deref(), Some(&data[..]));
        assert_eq!(read(&folder, "another driver"), None);
        let path = folder.join(FILE);
        let whole = fs::read(&path).expect("a file");
        for n in 0..whole.len() {
            fs::write(&path, &whole[..n]).expect("a file");
            assert_eq!(read(&folder, "one driver"), None, "{n} bytes of it");
        }
        let mut torn = whole;
        *torn.last_mut().expect("a byte") ^= 1;
        fs::write(&path, torn).expect("a file");
        assert_eq!(read(&folder, "one driver"), None);
        fs::remove_dir_all(&folder).expect("a folder");
    }

    #[test]
    fn a_start_that_dies_while_it_compiles_leaves_nothing_to_the_next() {
        let folder = std::env::temp_dir().join(format!("app-shell-begun-{}", std::process::id()));
        let kept = || Start::Cached(Some(vec![7]));
        assert_eq!(begin(&folder, "one"), Start::Cached(None), "the first start");
        store(&folder, "one", &[7]).expect("a file");
        assert_eq!(begin(&folder, "one"), kept());
        // The app crashes.
        assert_eq!(begin(&folder, "one"), Start::Uncached);
        assert_eq!(begin(&folder, "one"), Start::Cached(None), "and then anew");
        store(&folder, "one", &[7]).expect("a file");
        assert_eq!(begin(&folder, "one"), kept());
        store(&folder, "one", &[7]).expect("a file");
        assert_eq!(begin(&folder, "two"), Start::Cached(None), "another driver");
        fs::remove_dir_all(&folder).expect("a folder");
    }

    #[test]
    fn the_sum_is_that_of_its_authors() {
        // Test vector of FNV-1a, 64 bits, by Fowler, Noll and Vo.
        assert_eq!(sum(b"foobar"), "85944171f73967e8");
    }
}
