//! The device against the references. Each stage gets the device's own inputs, so that errors do
//! not add up. The synthetic scenes are small, have odd sizes, and their truth is known.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod alone;
mod appearance;
mod baseline;
mod behind;
mod casters;
mod compare_selftest;
mod composite;
mod conditioning;
mod contract;
mod cores;
mod coverage;
mod detail;
mod device;
mod errors;
mod estimate;
mod exposure;
mod fill;
mod fit;
mod frame;
mod gloss;
mod goldens;
mod grain;
mod grazing;
mod inject;
mod intensities;
mod lit;
mod many_plates;
mod moving;
mod numbers;
mod occlusion;
mod outliers;
mod overlap;
mod photo;
mod plate;
mod plates;
mod references;
mod reflection;
mod residual;
mod resources;
mod retarget;
mod rim;
mod run;
mod scrambled;
mod search;
mod self_shadow;
mod setups;
mod soften;
mod stand;
mod things;
mod tint;
mod toy;
mod validity;
mod withheld;
