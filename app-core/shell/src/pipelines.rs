//! Compiled pipelines, kept from start to start: what a driver hands out is handed back to the same driver, whole.
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

/// What is kept under a key; none where that is of another driver or version, or not as it was written.
#[must_use]
pub fn read(folder: &Path, key: &str) -> Option<Vec<u8>> {
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
    kept::store(folder, FILE, &file)
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
    fn the_sum_is_that_of_its_authors() {
        // Test vector of FNV-1a, 64 bits, by Fowler, Noll and Vo.
        assert_eq!(sum(b"foobar"), "85944171f73967e8");
    }
}
