//! The rooms of the pipeline, and which may import which: cargo keeps crates apart, not the folders of one.

use super::graph::Import;

/// From the one that imports all others to those that import none. Each may import those after it, and itself.
///
/// Within the model, both paths read the state; the frame path may read what was captured, never the other way round.
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
/// Rooms that never meet, though one stands after the other.
const APART: &[(&str, &str)] = &[("model", "baseline"), ("model", "plates"), ("baseline", "plates")];
/// Modules with a right of their own: the model reads its maps from its targets, in a file beside them.
const EXEMPT: &[(&str, &str)] = &[("model::readback", "model")];

/// Place of a module's room among all, the most special one that it is in.
pub(crate) fn rank(module: &str) -> Option<usize> {
    let rooms = ROOMS.iter().enumerate().filter(|(_, room)| is_in(module, room));
    rooms.max_by_key(|(_, room)| room.len()).map(|(rank, _)| rank)
}

/// What is wrong with an import.
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
