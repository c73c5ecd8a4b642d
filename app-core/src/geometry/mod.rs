//! Geometry in 64 bits: the camera, the receivers, the lights, and the extent of toy and shadows in the picture.

pub(crate) mod anchored;
pub(crate) mod bounds;
pub(crate) mod clip_reach;
pub(crate) mod color;
pub(crate) mod displacement;
pub(crate) mod extent;
pub(crate) mod facing;
pub(crate) mod inside;
pub(crate) mod light_points;
pub(crate) mod nearest_receivers;
pub(crate) mod outline;
pub(crate) mod reach;
pub(crate) mod rect;
pub(crate) mod scene_layout;
pub(crate) mod seen;
pub(crate) mod shadow_atlas;
pub(crate) mod silhouette;
pub(crate) mod tiles;
pub(crate) mod view;
pub(crate) mod whole_shadow;
