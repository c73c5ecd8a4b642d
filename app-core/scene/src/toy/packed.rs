//! Packs a glTF with external buffers and pictures into one binary glTF.

use std::borrow::Cow;
use std::ops::Range;

use serde_json::{Map, Value, json};

use super::base64::{self, Uri};
use super::check::check_limit;
use super::container::{Tree, binary_gltf, read_tree};
use super::error::{Flaw, ToyError, ToyProblem};
use super::limits::MAX_FILE_BYTES;
use super::mend::MESHOPT;

/// Binary glTF of a file and its external files; the unchanged bytes if it has none.
///
/// `read` is called for the bytes of an external file by its name relative to the file, with `/`
/// between its parts; its error is a text for people. Buffers must exist. Missing pictures are
/// skipped, with a warning once the toy is read.
///
/// # Errors
/// [`ToyError::Malformed`] if the bytes are no glTF, or a buffer cannot be read.
pub fn packed<'a>(
    file: &str,
    bytes: &'a [u8],
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Cow<'a, [u8]>, ToyError> {
    pack(bytes, read).map_err(|flaw| flaw.in_file(file))
}

fn pack<'a>(
    bytes: &'a [u8],
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Cow<'a, [u8]>, Flaw> {
    let Tree { mut json, bin } = read_tree(bytes)?;
    let is_outside = |entry: &Value| matches!(uri(entry), Some(Uri::Elsewhere(_)));
    let list = |name: &str| json.get(name).and_then(Value::as_array).into_iter().flatten();
    if !list("buffers").chain(list("images")).any(is_outside) {
        return Ok(Cow::Borrowed(bytes));
    }
    let mut packing = Packing {
        bin: Vec::new(),
        read,
    };
    let own = bin.unwrap_or_default();
    let places = packing.buffers(&mut json, &own)?;
    move_views(&mut json, &places)?;
    packing.images(&mut json)?;
    packing.glb(json).map(Cow::Owned)
}

fn uri(entry: &Value) -> Option<Uri<'_>> {
    entry.get("uri").and_then(Value::as_str).map(base64::read)
}

struct Packing<'r> {
    bin: Vec<u8>,
    read: &'r mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
}

/// The range of a buffer in the packed file's buffer; `Err` is the number of a buffer that stays
/// separate.
type Place = Result<Range<usize>, usize>;

impl Packing<'_> {
    fn append(&mut self, bytes: &[u8]) -> Result<Range<usize>, Flaw> {
        let start = self.bin.len();
        check_limit(
            "bytes",
            start.saturating_add(bytes.len()),
            MAX_FILE_BYTES,
            "buffers",
        )?;
        self.bin.extend_from_slice(bytes);
        let end = self.bin.len();
        self.bin.resize(self.bin.len().next_multiple_of(8), 0);
        Ok(start..end)
    }

    fn neighbour(&mut self, field: &str, uri: &str) -> Result<Vec<u8>, Flaw> {
        let flaw = |name: &str, reason: String| {
            let name = name.to_owned();
            ToyProblem::Neighbour { name, reason }.at(field)
        };
        let name =
            base64::percent_decoded(uri).ok_or_else(|| flaw(uri, "the name is not valid text".to_owned()))?;
        let name = name.strip_prefix("./").unwrap_or(&name);
        (self.read)(name).map_err(|reason| flaw(name, reason))
    }

    /// Joins all buffers with bytes into one.
    fn buffers(&mut self, json: &mut Value, own: &[u8]) -> Result<Vec<Place>, Flaw> {
        let buffers = json
            .get_mut("buffers")
            .and_then(Value::as_array_mut)
            .map(std::mem::take);
        let mut places = Vec::new();
        let mut kept = vec![Value::Null];
        for (i, buffer) in buffers.into_iter().flatten().enumerate() {
            let field = format!("buffers[{i}].uri");
            let bytes = match uri(&buffer) {
                None if i == 0 => Some(Cow::Borrowed(own)),
                None => None,
                Some(Uri::Data(bytes)) => Some(Cow::Owned(bytes)),
                Some(Uri::Broken) => return Err(ToyProblem::DataUri.at(field)),
                Some(Uri::Elsewhere(uri)) => Some(Cow::Owned(self.neighbour(&field, uri)?)),
            };
            match bytes {
                Some(bytes) => {
                    check_length(&buffer, bytes.len(), &format!("buffers[{i}]"))?;
                    places.push(Ok(self.append(&bytes)?));
                }
                None => {
                    places.push(Err(kept.len()));
                    kept.push(buffer);
                }
            }
        }
        json["buffers"] = kept.into();
        Ok(places)
    }

    fn images(&mut self, json: &mut Value) -> Result<(), Flaw> {
        let mut images = json.get_mut("images").map(Value::take).unwrap_or_default();
        for (i, image) in images.as_array_mut().into_iter().flatten().enumerate() {
            let Some(Uri::Elsewhere(uri)) = uri(image) else {
                continue;
            };
            // The toy's reader warns about it.
            let Ok(bytes) = self.neighbour(&format!("images[{i}].uri"), uri) else {
                continue;
            };
            let view =
                json!({ "buffer": 0, "byteOffset": self.append(&bytes)?.start, "byteLength": bytes.len() });
            let views = json.get_mut("bufferViews").and_then(Value::as_array_mut);
            let number = match views {
                Some(views) => {
                    views.push(view);
                    views.len() - 1
                }
                None => {
                    json["bufferViews"] = json!([view]);
                    0
                }
            };
            *image = json!({ "bufferView": number });
        }
        if !images.is_null() {
            json["images"] = images;
        }
        Ok(())
    }

    fn glb(self, mut json: Value) -> Result<Vec<u8>, Flaw> {
        json["buffers"][0] = json!({ "byteLength": self.bin.len() });
        let file = binary_gltf(json.to_string().as_bytes(), &self.bin);
        check_limit("bytes", file.len(), MAX_FILE_BYTES, "file")?;
        Ok(file)
    }
}

/// Refuses a buffer that is shorter than the file states.
fn check_length(buffer: &Value, available: usize, field: &str) -> Result<(), Flaw> {
    let stated = buffer.get("byteLength").and_then(Value::as_u64);
    check_end(stated.unwrap_or_default(), available, field)
}

fn check_end(end: u64, available: usize, field: &str) -> Result<(), Flaw> {
    match end <= available as u64 {
        true => Ok(()),
        false => Err(ToyProblem::OutOfRange { end, available }.at(field)),
    }
}

/// Makes views, and their compressed data, refer to the joined buffer.
fn move_views(json: &mut Value, places: &[Place]) -> Result<(), Flaw> {
    let views = json.get_mut("bufferViews").and_then(Value::as_array_mut);
    for (i, view) in views.into_iter().flatten().enumerate() {
        let Some(view) = view.as_object_mut() else {
            continue;
        };
        let field = format!("bufferViews[{i}]");
        let extensions = view.get_mut("extensions").and_then(Value::as_object_mut);
        for (name, compressed) in extensions
            .into_iter()
            .flatten()
            .filter(|(name, _)| MESHOPT.contains(&name.as_str()))
        {
            if let Some(compressed) = compressed.as_object_mut() {
                move_view(compressed, places, &format!("{field}.extensions.{name}"))?;
            }
        }
        move_view(view, places, &field)?;
    }
    Ok(())
}

/// A view beyond its own buffer is refused, since bytes of the next buffer follow.
fn move_view(view: &mut Map<String, Value>, places: &[Place], field: &str) -> Result<(), Flaw> {
    let number = |key: &str| view.get(key).and_then(Value::as_u64);
    let buffer = number("buffer").and_then(|buffer| usize::try_from(buffer).ok());
    let offset = number("byteOffset").unwrap_or_default();
    let end = offset.saturating_add(number("byteLength").unwrap_or_default());
    match buffer.and_then(|buffer| places.get(buffer)) {
        Some(Ok(place)) => {
            check_end(end, place.len(), field)?;
            view.insert("buffer".to_owned(), 0.into());
            view.insert(
                "byteOffset".to_owned(),
                offset.saturating_add(place.start as u64).into(),
            );
        }
        Some(Err(kept)) => drop(view.insert("buffer".to_owned(), (*kept).into())),
        // A reference to no buffer stays invalid.
        None => drop(view.insert("buffer".to_owned(), u32::MAX.into())),
    }
    Ok(())
}
