//! Geometry in 64 bits: the camera, the receivers, the lights, and the extent of toy and shadows in the picture.

pub mod anchored;
pub mod clip_reach;
pub mod displacement;
pub mod extent;
pub mod outline;
pub mod reach;
pub mod rect;
pub mod scene_layout;
pub mod seen;
pub mod shadow_atlas;
pub mod silhouette;
pub mod tiles;
pub mod view;
