//! CPU reference of `census.wgsl`: the sets of lights that occur in mask 3c.

use std::collections::BTreeSet;

use super::raster::Raster;
use super::sets::LightSet;

/// The sets, each once; the empty set is nothing to sample from.
#[must_use]
pub fn seen_sets(eligible: &Raster<LightSet>) -> Vec<LightSet> {
    let seen: BTreeSet<LightSet> = eligible.texels().iter().copied().collect();
    seen.into_iter()
        .filter(|set| *set != LightSet::default())
        .collect()
}
