//! Plates, the pictures of the scene without the toy: their choice for a view, their textures, and their exposures.

pub(crate) mod choice;
pub mod exposure;
mod joint;
pub mod overlap;
mod shot;
mod sight;
pub(crate) mod store;
