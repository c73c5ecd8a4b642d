//! The inputs of shadow retargeting: toys, scenes, cameras, and the pictures that cameras deliver. No device, no file,
//! no clock.
#![forbid(unsafe_code)]

pub mod camera_frame;
pub mod card;
pub mod depth;
pub mod disjoint;
pub mod frame;
pub mod geometry;
pub mod gloss;
pub mod grain;
pub mod lens;
pub mod people;
pub mod picture;
pub mod place_mesh;
pub mod reflection;
pub mod scene;
pub mod shadow_style;
pub mod sharpness;
pub mod things;
pub mod toy;
pub mod words;

pub use glam;
