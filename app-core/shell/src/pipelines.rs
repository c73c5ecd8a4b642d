//! Compiled pipelines, kept from start to start: what a driver hands out is handed back to the same driver, whole.
//!
//! What is handed back may end the app. So a start takes the file away with it and leaves a note; what it has compiled takes the place of
//! both. A start that finds such a note does without.
//!
//! A file has a line of its own for the key, of version, device and driver, one for a sum of the bytes, then the bytes.

use std::fs;
use std::io;
use std::path::Path;

use crate::kept;

/// Its name.
const FILE: &str = "pipelines.bin";
/// A file is not larger: nobody waits for more to be read.
const MAX_BYTES: u64 = 64 << 20;

/// The name of the note: a start has begun with the driver's cache, and has not come to the end of compiling.
const NOTE: &str = "pipelines.begun";

/// How a start compiles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Start {
    /// With a cache of the driver's, and what an earlier start has left in it.
    Cached(Option<Vec<u8>>),
    /// Without any, since the start before did not come to the end of it.
    Uncached,
}

/// Begins a start: nothing is kept any more, until [`store`] keeps what it has compiled.
#[must_use]
pub fn begin(folder: &Path, key: &str) -> Start {
    let (file, note) = (folder.join(FILE), folder.join(NOTE));
    let data = read(folder, key);
    let removed = fs::remove_file(file);
    let is_left = matches!(&removed, Err(error) if error.kind() != io::ErrorKind::NotFound);
    if note.exists() {
        // The start after this one tries again.
        let _ = fs::remove_file(note);
        return Start::Uncached;
    }
    match kept::store(folder, NOTE, b"") {
        Ok(()) if !is_left => Start::Cached(data),
        // What cannot be noted could end each start.
        _ => Start::Uncached,
    }
}

/// What is kept under a key; none if that is of another driver or version, or not as it was written.
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

/// Keeps bytes under a key, in place of all that was kept before.
///
/// # Errors
/// When the file cannot be written.
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

/// FNV-1a over 64 bits: against bytes that were lost, not against anybody.
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
        // It dies.
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
