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

use gpu::shader::{Mirrors, Shader};

/// Host declarations of the parts that shaders import.
const SHARED: &[&Mirrors] = &[
    &baseline::uniform::BASELINE,
    &model::capture::appearance::SOURCE,
    &model::capture::fit::FIT_STEP,
    &model::capture::pool::POOL,
    &model::diagnostics::evidence::PIXEL,
    &model::frame::coverage::COVERED,
    &model::frame::coverage::BEHIND_OUTLINE,
    &passes::specular::GLOSS,
    &model::lighting::self_shadow::SELF_SHADOW_MAPS,
    &model::readback::PLATE_LIGHT,
    &model::state::grids::GRID,
    &model::state::solution::FIT,
    &model::state::tints::BETWEEN_TINTS,
    &model::state::tints::TINT_CELL,
    &model::state::tints::TINT_GRID,
    &passes::globals::BEHIND,
    &passes::globals::GLOBALS,
    &passes::pictures::PLANES,
    &passes::thing_marks::THING_MARKS,
];

/// Host declarations of a shader: those of the parts that it imports, and those of its own file.
#[must_use]
pub fn mirrors(shader: &'static Shader) -> Vec<&'static Mirrors> {
    let imports = shader.imports();
    let shared = SHARED.iter().copied();
    let imported = shared.filter(|mirrors| imports.contains(&mirrors.path));
    imported.chain([&shader.mirrors]).collect()
}

/// Every shader of the registry.
pub fn shaders() -> impl Iterator<Item = &'static Shader> {
    let rooms = [
        model::lighting::SHADERS,
        model::capture::SHADERS,
        model::frame::SHADERS,
        passes::SHADERS,
        baseline::SHADERS,
    ];
    rooms.into_iter().flatten().copied()
}
