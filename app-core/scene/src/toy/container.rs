//! From bytes to glTF: the normalised JSON tree, and the binary data beside it.
//!
//! The tree is used without the crate's own validation, which panics on a `POSITION` beyond the
//! last accessor and refuses application-specific attributes. Each reference is therefore resolved
//! by [`get`], and each enumeration by [`allowed`].

use std::borrow::Cow;
use std::collections::HashMap;

use gltf::json::validation::Checked;
use gltf::json::{Index, Root, root::Get};
use serde_json::Value;

use super::base64::{self, Uri};
use super::check::check_limit;
use super::error::{Flaw, ToyProblem};
use super::extensions::check_extensions;
use super::foreign;
use super::limits::{MAX_DECODED_VALUES, MAX_FILE_BYTES, MAX_JSON_BYTES};
use super::mend::{self, CompressedView, Extras};
use super::warning::ToyWarning;

/// A parsed glTF file, its references not yet checked.
pub(super) struct Container<'a> {
    pub(super) root: Root,
    /// The bytes of each buffer; `None` for those outside the file.
    pub(super) buffers: Vec<Option<Cow<'a, [u8]>>>,
    /// Decompressed buffer views.
    pub(super) decompressed: HashMap<usize, Vec<u8>>,
    pub(super) extras: Extras,
}

/// A file's JSON tree as written, and its binary chunk.
pub(super) struct Tree<'a> {
    pub(super) json: Value,
    pub(super) bin: Option<Cow<'a, [u8]>>,
}

const HEADER_BYTES: u32 = 12;
const JSON_CHUNK: &str = "JSON chunk";
const JSON_WITHOUT_DATA: &str = "JSON text without its data URIs";

/// Binary glTF: a header and two chunks, each padded to four bytes. The lengths of a file of more
/// than 4 GiB are wrong.
///
/// Source: glTF 2.0 specification, section 4.4.
#[must_use]
pub fn binary_gltf(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let filled = |chunk: &[u8]| chunk.len().next_multiple_of(4);
    let word = |value: usize| u32::try_from(value).unwrap_or(u32::MAX).to_le_bytes();
    let mut file = [*b"glTF", word(2), word(28 + filled(json) + filled(bin))].concat();
    for (kind, chunk, filler) in [(b"JSON", json, b' '), (b"BIN\0", bin, 0)] {
        file.extend(word(filled(chunk)));
        file.extend(kind);
        file.extend(chunk);
        file.resize(file.len().next_multiple_of(4), filler);
    }
    file
}

/// Reads binary glTF, or glTF as JSON alone.
pub(super) fn read_tree(bytes: &[u8]) -> Result<Tree<'_>, Flaw> {
    check_limit("bytes", bytes.len(), MAX_FILE_BYTES, "file")?;
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let (text, bin) = if text.trim_ascii_start().starts_with(b"{") {
        (Cow::Borrowed(text), None)
    } else {
        chunks(bytes)?
    };
    check_limit(
        "bytes",
        n_bytes_beside_data(&text),
        MAX_JSON_BYTES,
        JSON_WITHOUT_DATA,
    )?;
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
    // Some exporters pad with zeros instead of blanks.
    let n_bytes = text
        .iter()
        .rposition(|byte| *byte != 0 && !byte.is_ascii_whitespace())
        .map_or(0, |last| last + 1);
    let json: Value = serde_json::from_slice(&text[..n_bytes])
        .map_err(|error| ToyProblem::Json(error.to_string()).at(JSON_CHUNK))?;
    let version = json.pointer("/asset/version");
    let is_first = match version.and_then(Value::as_str) {
        Some(version) => version.starts_with("1."),
        // Version 1.0 had names instead of numbers.
        None => json.get("meshes").is_some_and(Value::is_object),
    };
    match is_first {
        true => Err(foreign::first_version()),
        false => Ok(Tree { json, bin }),
    }
}

/// Number of bytes of a JSON text without its data URIs, which become bytes and no values.
///
/// A `data:` after a quotation mark is within a string, which ends at the next mark at the latest.
fn n_bytes_beside_data(text: &[u8]) -> usize {
    let mut n_bytes = 0;
    let mut is_data = false;
    for part in text.split_inclusive(|byte| *byte == b'"') {
        is_data = !is_data && part.starts_with(b"data:");
        n_bytes += if is_data { 0 } else { part.len() };
    }
    n_bytes
}

type Chunks<'a> = (Cow<'a, [u8]>, Option<Cow<'a, [u8]>>);

fn chunks(bytes: &[u8]) -> Result<Chunks<'_>, Flaw> {
    if !bytes.starts_with(b"glTF") {
        if let Some(refusal) = foreign::refusal(bytes) {
            return Err(refusal);
        }
    } else if bytes.get(4..8) == Some(&[1, 0, 0, 0]) {
        return Err(foreign::first_version());
    }
    check_header_length(bytes)?;
    let not_gltf = |error| ToyProblem::Container(Box::new(error)).at("file");
    let glb = gltf::Glb::from_slice(bytes).map_err(not_gltf)?;
    Ok((glb.json, glb.bin))
}

/// Opens a file. `warnings` receives repairs and unsupported features.
pub(super) fn open<'a>(bytes: &'a [u8], warnings: &mut Vec<ToyWarning>) -> Result<Container<'a>, Flaw> {
    let Tree { mut json, bin } = read_tree(bytes)?;
    check_extensions(&json, warnings)?;
    let extras = mend::mend(&mut json, warnings)?;
    let root: Root = serde_path_to_error::deserialize(json).map_err(|error| {
        let problem = ToyProblem::Json(error.inner().to_string());
        problem.at(format!("{JSON_CHUNK}: {}", error.path()))
    })?;
    let buffers = buffers(&root, bin)?;
    let decompressed = decompressed(&extras.compressed, &buffers)?;
    Ok(Container {
        root,
        buffers,
        decompressed,
        extras,
    })
}

fn buffers<'a>(root: &Root, bin: Option<Cow<'a, [u8]>>) -> Result<Vec<Option<Cow<'a, [u8]>>>, Flaw> {
    let mut bin = Some(bin.unwrap_or_default());
    let buffers = root.buffers.iter().enumerate().map(|(i, buffer)| {
        let bytes = match buffer.uri.as_deref().map(base64::read) {
            None if i == 0 => bin.take(),
            Some(Uri::Data(bytes)) => Some(Cow::Owned(bytes)),
            Some(Uri::Broken) => return Err(ToyProblem::DataUri.at(format!("buffers[{i}].uri"))),
            None | Some(Uri::Elsewhere(_)) => None,
        };
        Ok(bytes)
    });
    buffers.collect()
}

/// Decodes the compressed views.
fn decompressed(
    views: &[CompressedView],
    buffers: &[Option<Cow<'_, [u8]>>],
) -> Result<HashMap<usize, Vec<u8>>, Flaw> {
    let mut n_bytes = 0_usize;
    let mut all = HashMap::new();
    for view in views {
        let field = format!("bufferViews[{}].extensions.{}", view.index, view.extension);
        let how = view.how;
        n_bytes = n_bytes.saturating_add(how.count.saturating_mul(how.stride));
        check_limit(
            "decoded numbers",
            n_bytes / size_of::<f32>(),
            MAX_DECODED_VALUES,
            &field,
        )?;
        let buffer = buffers.get(view.buffer).ok_or_else(|| {
            let (index, n) = (view.buffer, buffers.len());
            ToyProblem::NoSuch {
                what: "buffer",
                index,
                n,
            }
            .at(&field)
        })?;
        let buffer = buffer
            .as_deref()
            .ok_or_else(|| ToyProblem::External.at(format!("buffers[{}]", view.buffer)))?;
        let end = view.offset.saturating_add(view.length);
        let stream = buffer.get(view.offset..end).ok_or_else(|| {
            let (end, available) = (end as u64, buffer.len());
            ToyProblem::OutOfRange { end, available }.at(&field)
        })?;
        let bytes = how
            .decode(stream)
            .ok_or_else(|| ToyProblem::Compressed.at(&field))?;
        all.insert(view.index, bytes);
    }
    Ok(all)
}

/// The container reader subtracts the header from the stated length, which must not become
/// negative.
fn check_header_length(bytes: &[u8]) -> Result<(), Flaw> {
    match bytes.get(8..).and_then(<[u8]>::first_chunk) {
        Some(&length) if u32::from_le_bytes(length) < HEADER_BYTES => Err(ToyProblem::HeaderLength {
            found: u32::from_le_bytes(length),
        }
        .at("file")),
        _ => Ok(()),
    }
}

/// Resolves a reference of the JSON tree. `what` names the kind of target in the error.
pub(super) fn get<'r, T>(
    root: &'r Root,
    field: &str,
    index: Index<T>,
    what: &'static str,
) -> Result<&'r T, Flaw>
where
    Root: Get<T> + AsRef<[T]>,
{
    let all: &[T] = root.as_ref();
    all.get(index.value()).ok_or_else(|| {
        ToyProblem::NoSuch {
            what,
            index: index.value(),
            n: all.len(),
        }
        .at(field)
    })
}

/// Resolves an enumeration of the JSON tree.
pub(super) fn allowed<T>(value: Checked<T>, field: &str) -> Result<T, Flaw> {
    match value {
        Checked::Valid(value) => Ok(value),
        Checked::Invalid => Err(ToyProblem::NotAllowed.at(field)),
    }
}
