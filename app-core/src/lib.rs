//! Shadow retargeting: a static toy in a camera picture moves, with its own real shadow.

pub mod core;
pub mod frame;
pub mod gpu;
pub mod light_points;
pub mod maps;
pub mod plan;
pub mod preset;
pub mod region;
pub mod scene;
pub mod session;
pub mod toy;

mod capture;
mod passes;
mod pipeline;
mod stage;
mod window;

pub use wgpu;
