//! Geometry and colour that the pipeline and alignment share.

pub mod bounds;
pub mod color;
pub mod disc;
pub mod edges;
pub mod nearest_receivers;
pub mod opaque;
pub mod used_lights;
