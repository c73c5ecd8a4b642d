//! Toys' files in the folder that the person can access.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use app_core::app::{ShellEvent, ToyRefusal};
use app_core::toy::Toy;

/// File of the toy that is part of the app: that of the bundled session, made by this project.
pub const BUNDLED: &[u8] = include_bytes!("../../../tests/sessions/llama/toy.glb");
/// Its name in the list.
const BUNDLED_NAME: &str = "Llama";
/// Largest size of a file: the memory holds it twice while it is read.
const MAX_BYTES: u64 = 64 << 20;

/// The file of the toy that is shown, for recordings of it.
#[derive(Clone, Debug)]
pub struct ToyFile(Arc<Mutex<Arc<[u8]>>>);

impl Default for ToyFile {
    fn default() -> Self {
        Self::of(Arc::from(BUNDLED))
    }
}

impl ToyFile {
    /// The toy file with these bytes.
    #[must_use]
    pub fn of(file: Arc<[u8]>) -> Self {
        Self(Arc::new(Mutex::new(file)))
    }

    /// Its bytes.
    #[must_use]
    pub fn bytes(&self) -> Arc<[u8]> {
        Arc::clone(&self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Reads another toy. Its file replaces this one, unless it is refused.
    #[must_use]
    pub fn read(&self, folder: &Path, name: &str) -> ShellEvent {
        let read = bytes_of(folder, name).and_then(|bytes| {
            let toy = Toy::from_glb(name, &bytes).map_err(|error| ToyRefusal::of(name, &error))?;
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = bytes;
            Ok(Arc::new(toy))
        });
        ShellEvent::Toy(read)
    }
}

/// Names of the available toys: the bundled one, and the files of the folder in alphabetical order.
#[must_use]
pub fn list(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut toys: Vec<String> = names.filter(|name| is_toy(name)).collect();
    toys.sort();
    toys.insert(0, BUNDLED_NAME.to_owned());
    toys
}

fn is_toy(name: &str) -> bool {
    let extension = Path::new(name).extension();
    // The refusal of USDZ explains how to convert it.
    let known = ["glb", "usdz"];
    extension.is_some_and(|extension| known.iter().any(|known| extension.eq_ignore_ascii_case(known)))
}

/// The scan beside a toy's file, by which a platform recognises the toy: it has the same name and
/// the extension `.arobject`.
#[must_use]
pub fn scan_beside(folder: &Path, name: &str) -> Option<PathBuf> {
    let scan = folder.join(name).with_extension("arobject");
    (is_toy(name) && scan.is_file()).then_some(scan)
}

fn bytes_of(folder: &Path, name: &str) -> Result<Arc<[u8]>, ToyRefusal> {
    if name == BUNDLED_NAME {
        return Ok(Arc::from(BUNDLED));
    }
    let mut bytes = Vec::new();
    let opened = File::open(folder.join(name));
    opened
        .and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| ToyRefusal::unreadable(name, error))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(ToyRefusal::too_large(name, MAX_BYTES >> 20));
    }
    Ok(bytes.into())
}

#[cfg(test)]
mod tests {
    use app_core::app::RefusalKind;

    use super::*;

    /// The same toy in another file: its binary chunk is longer by a word. Source: glTF 2.0, section 4.4.
    fn with_blank(glb: &[u8]) -> Vec<u8> {
        let mut glb = [glb, &[0; 4]].concat();
        let word = |glb: &[u8], at: usize| {
            glb.get(at..at + 4)
                .and_then(|four| four.try_into().ok())
                .map(u32::from_le_bytes)
        };
        let json_bytes = word(&glb, 12).expect("a header") as usize;
        for at in [8, 20 + json_bytes] {
            let length = word(&glb, at).expect("a length") + 4;
            glb[at..at + 4].copy_from_slice(&length.to_le_bytes());
        }
        glb
    }

    /// The beginning of a USDZ file. Source: PKWARE, APPNOTE, section 4.3.7.
    fn usdz() -> Vec<u8> {
        let mut bytes = vec![0; 30];
        bytes[..4].copy_from_slice(b"PK\x03\x04");
        bytes[26] = 8;
        bytes.extend(b"toy.usdc");
        bytes
    }

    #[test]
    fn toys_of_the_folder_are_listed_read_and_kept_for_recordings() {
        let folder = std::env::temp_dir().join(format!("app-shell-toys-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        assert_eq!(list(&folder.join("none")), ["Llama"]);
        for (name, bytes) in [("b.glb", BUNDLED), ("a.GLB", b"no toy"), ("photo.png", b"")] {
            fs::write(folder.join(name), bytes).expect("a file");
        }
        assert_eq!(list(&folder), ["Llama", "a.GLB", "b.glb"]);
        assert_eq!(scan_beside(&folder, "b.glb"), None);
        fs::write(folder.join("b.arobject"), b"scan").expect("a file");
        assert_eq!(scan_beside(&folder, "b.glb"), Some(folder.join("b.arobject")));
        assert_eq!(scan_beside(&folder, BUNDLED_NAME), None);
        fs::write(folder.join("c.usdz"), usdz()).expect("a file");
        assert!(list(&folder).contains(&"c.usdz".to_owned()));
        let usdz = ToyFile::default().read(&folder, "c.usdz");
        assert!(
            matches!(&usdz, ShellEvent::Toy(Err(refusal)) if refusal.kind == RefusalKind::Foreign && refusal.reason.contains("USDZ")),
            "{usdz:?}"
        );
        let file = ToyFile::default();
        let refused = file.read(&folder, "a.GLB");
        assert!(
            matches!(&refused, ShellEvent::Toy(Err(refusal)) if refusal.reason.contains("a.GLB")),
            "{refused:?}"
        );
        let missing = file.read(&folder, "c.glb");
        assert!(
            matches!(&missing, ShellEvent::Toy(Err(refusal)) if refusal.kind == RefusalKind::Unreadable),
            "{missing:?}"
        );
        assert_eq!(file.bytes()[..], *BUNDLED, "it stays");
        let other = with_blank(BUNDLED);
        fs::write(folder.join("b.glb"), &other).expect("a file");
        assert!(matches!(file.read(&folder, "b.glb"), ShellEvent::Toy(Ok(_))));
        assert_eq!(file.bytes()[..], other[..]);
        assert!(matches!(file.read(&folder, "Llama"), ShellEvent::Toy(Ok(_))));
        assert_eq!(file.bytes()[..], *BUNDLED);
        fs::remove_dir_all(&folder).expect("a folder");
    }
}
