//! The layers of the pipeline and their permitted imports: cargo separates crates, but not the
//! folders of one.

use super::graph::Import;

/// From the layer that imports all others to those that import none. Each may import itself and the
/// layers after it.
///
/// Within the model, both paths read the state; the frame path may read the results of the capture
/// path, but not the reverse.
const ROOMS: &[&str] = &[
    "",
    "core",
    "stage",
    "model",
    "model::readback",
    "model::frame",
    "model::capture",
    "model::lighting",
    "model::region",
    "model::plan",
    "model::diagnostics",
    "model::state",
    "baseline",
    "plates",
    "passes",
    "ledger",
    "profile",
    "frame",
    "plan",
    "governor",
    "preset",
    "readback",
    "geometry",
    "gpu",
];
/// Layers that must not import each other, though one follows the other.
const APART: &[(&str, &str)] = &[("model", "baseline"), ("model", "plates"), ("baseline", "plates")];
/// Modules with an exception: the model reads its maps from its targets, in a file beside them.
const EXEMPT: &[(&str, &str)] = &[("model::readback", "model")];

/// Index of a module's layer; the most specific layer counts.
pub(crate) fn rank(module: &str) -> Option<usize> {
    let rooms = ROOMS.iter().enumerate().filter(|(_, room)| is_in(module, room));
    rooms.max_by_key(|(_, room)| room.len()).map(|(rank, _)| rank)
}

/// Problem of an import.
pub(crate) fn out_of_order(import: &Import) -> Option<String> {
    let Import { from, to, .. } = import;
    let is_backwards = rank(from)? > rank(to)?;
    let is_apart = APART
        .iter()
        .any(|(a, b)| (is_in(from, a) && is_in(to, b)) || (is_in(from, b) && is_in(to, a)));
    let is_exempt = EXEMPT.contains(&(from.as_str(), to.as_str())) || import.names_parent;
    ((is_backwards || is_apart) && !is_exempt).then(|| format!("{from} imports {to}"))
}

fn is_in(module: &str, room: &str) -> bool {
    module == room
        || (room.is_empty() && module.is_empty())
        || (!room.is_empty() && module.starts_with(&format!("{room}::")))
}
