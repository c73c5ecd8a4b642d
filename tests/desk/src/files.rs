//! The bundled session, and readers and writers of a session's index.

use std::io;

use anyhow::{Context, ensure};
use app_core::session::{Files, MAX_INDEX_BYTES, index_bytes};
use serde::Serialize;
use serde_json::Value;
use serde_json::ser::{Formatter, Serializer};

pub use app_core::session::{Folder, FolderError, INDEX_FILE as SESSION_FILE};

/// The bundled session.
pub const BUNDLED_SESSION: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../sessions/llama");

/// A session's index with all its keys, those that the format does not have included.
///
/// # Errors
/// When it cannot be read, or is no JSON.
pub fn index_of(files: &dyn Files) -> anyhow::Result<Value> {
    serde_json::from_slice(&index_bytes(files)?).context(SESSION_FILE)
}

/// The text of an index, with a line for each key and for each entry of its lists: nearly as short
/// as JSON can be, since an index may not be long.
///
/// # Errors
/// When it is larger than a reader takes.
pub fn index_text(index: &impl Serialize) -> anyhow::Result<Vec<u8>> {
    let mut text = Vec::new();
    let lines = Lines { depth: 0 };
    index.serialize(&mut Serializer::with_formatter(&mut text, lines))?;
    text.push(b'\n');
    check_index_size(&text)?;
    Ok(text)
}

/// Refuses an index that no reader would take.
///
/// # Errors
/// When it is too large.
pub fn check_index_size(index: &[u8]) -> anyhow::Result<()> {
    let n_bytes = index.len();
    ensure!(
        n_bytes as u64 <= MAX_INDEX_BYTES,
        "{SESSION_FILE}: would have {n_bytes} bytes, but {MAX_INDEX_BYTES} are the limit: take fewer frames"
    );
    Ok(())
}

/// Compact JSON with line breaks before keys of the outermost object, and before entries of lists
/// that these keys have.
struct Lines {
    depth: usize,
}

impl Lines {
    /// Writes what stands before a key or an entry that is so deep.
    fn before<W: ?Sized + io::Write>(&self, writer: &mut W, depth: usize, is_first: bool) -> io::Result<()> {
        writer.write_all(if is_first { b"" } else { b"," })?;
        writer.write_all(if self.depth == depth { b"\n" } else { b"" })
    }
}

impl Formatter for Lines {
    fn begin_array<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth += 1;
        writer.write_all(b"[")
    }

    fn end_array<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        writer.write_all(b"]")
    }

    fn begin_array_value<W: ?Sized + io::Write>(&mut self, writer: &mut W, is_first: bool) -> io::Result<()> {
        self.before(writer, 2, is_first)
    }

    fn begin_object<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth += 1;
        writer.write_all(b"{")
    }

    fn end_object<W: ?Sized + io::Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        writer.write_all(b"}")
    }

    fn begin_object_key<W: ?Sized + io::Write>(&mut self, writer: &mut W, is_first: bool) -> io::Result<()> {
        self.before(writer, 1, is_first)
    }
}
