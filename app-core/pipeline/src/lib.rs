//! The GPU pipeline of shadow retargeting: a scene and a camera frame in, a picture and a report out.
#![forbid(unsafe_code)]

pub mod baseline;
pub mod core;
pub mod frame;
pub mod geometry;
pub mod governor;
pub mod gpu;
pub mod ledger;
pub mod model;
pub mod passes;
pub mod plan;
pub mod plates;
pub mod preset;
pub mod profile;
pub mod readback;
mod stage;

pub use crate::core::{Core, CoreError};
pub use wgpu;

/// Every shader of the registry.
pub fn shaders() -> impl Iterator<Item = &'static gpu::shader::Shader> {
    let rooms = [
        model::lighting::SHADERS,
        model::capture::SHADERS,
        model::frame::SHADERS,
        passes::SHADERS,
        baseline::SHADERS,
    ];
    rooms.into_iter().flatten().copied()
}
