//! Plans, the work region, the points over a light and the presets: all decisions that need no
//! device.

mod anchored;
mod conditioning;
mod light_points;
mod outliers;
mod outline;
mod passes;
mod preset;
mod region;
mod rig;
mod shadow_atlas;
mod silhouette;
mod tiles;
mod transforms;
mod whole_shadow;
