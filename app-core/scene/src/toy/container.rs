//! From bytes to glTF: the JSON tree and the binary chunk beside it.
//!
//! The tree is taken without the crate's own validation, which panics on a `POSITION` beyond the last accessor and
//! refuses application-specific attributes.
//! Each reference is therefore looked up with [`get`], and each enumeration opened with [`allowed`].

use gltf::json::validation::Checked;
use gltf::json::{self, Index, Root, root::Get};

use super::check::check_limit;
use super::error::{Flaw, ToyProblem, ToyWarning};
use super::limits::{MAX_FILE_BYTES, MAX_JSON_BYTES};

/// A glTF file taken apart, its references not yet checked.
pub(super) struct Container<'a> {
    pub(super) root: Root,
    pub(super) bin: std::borrow::Cow<'a, [u8]>,
}

const HEADER_BYTES: u32 = 12;

pub(super) fn open(bytes: &[u8]) -> Result<Container<'_>, Flaw> {
    check_limit("bytes", bytes.len(), MAX_FILE_BYTES, "file")?;
    check_header_length(bytes)?;
    let not_gltf = |error| ToyProblem::Container(Box::new(error));
    let glb = gltf::Glb::from_slice(bytes).map_err(|error| not_gltf(error).at("file"))?;
    check_limit("bytes", glb.json.len(), MAX_JSON_BYTES, "JSON chunk")?;
    let root: Root = json::deserialize::from_slice(&glb.json)
        .map_err(|error| not_gltf(gltf::Error::Deserialize(error)).at("JSON chunk"))?;
    Ok(Container {
        root,
        bin: glb.bin.unwrap_or_default(),
    })
}

/// The container reader subtracts the header from the length it reads, which must not go below zero.
fn check_header_length(bytes: &[u8]) -> Result<(), Flaw> {
    match bytes.get(8..).and_then(<[u8]>::first_chunk) {
        Some(&length) if u32::from_le_bytes(length) < HEADER_BYTES => Err(ToyProblem::HeaderLength {
            found: u32::from_le_bytes(length),
        }
        .at("file")),
        _ => Ok(()),
    }
}

/// Follows a reference of the JSON tree. `what` names the kind of thing in the error.
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

/// Opens an enumeration of the JSON tree.
pub(super) fn allowed<T>(value: Checked<T>, field: &str) -> Result<T, Flaw> {
    match value {
        Checked::Valid(value) => Ok(value),
        Checked::Invalid => Err(ToyProblem::NotAllowed.at(field)),
    }
}

/// Refuses extensions that move or encode vertices in ways not read here; warns of those that are not supported.
pub(super) fn check_extensions(root: &Root, warnings: &mut Vec<ToyWarning>) -> Result<(), Flaw> {
    // Supported, or without effect on a toy's shape and base colour.
    const HARMLESS: [&str; 4] = [
        "KHR_mesh_quantization",
        "KHR_lights_punctual",
        "KHR_materials_unlit",
        "KHR_materials_specular",
    ];
    let is_look = |name: &str| name.starts_with("KHR_materials_") || name == "KHR_texture_transform";
    for (i, name) in root.extensions_required.iter().enumerate() {
        if !HARMLESS.contains(&name.as_str()) && !is_look(name) {
            let problem = ToyProblem::Extension { name: name.clone() };
            return Err(problem.at(format!("extensionsRequired[{i}]")));
        }
    }
    let unfollowed = root
        .extensions_used
        .iter()
        .filter(|name| !HARMLESS.contains(&name.as_str()));
    warnings.extend(unfollowed.map(|name| ToyWarning::ExtensionIgnored { name: name.clone() }));
    Ok(())
}
