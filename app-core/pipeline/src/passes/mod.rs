//! Passes that several paths run, and code shared by passes. A pass has one name for shader,
//! module, label and time stamp.
//!
//! A pass is immutable after `new`; `encode` gets all of its inputs and outputs and makes no
//! decisions.

pub(crate) mod camera_planes;
pub(crate) mod counting;
pub mod globals;
pub(crate) mod list;
pub(crate) mod materials;
mod mips;
pub(crate) mod pictures;
pub mod plate;
pub(crate) mod present;
pub(crate) mod screen;
pub mod specular;
pub(crate) mod thing_marks;
pub(crate) mod toy_mesh;

use crate::gpu::Shader;
use crate::passes::list::WarmUp;

/// The shaders of the passes that several paths run.
pub(crate) const SHADERS: &[&Shader] = &[
    &camera_planes::SHADER,
    &plate::SHADER,
    &present::SHADER,
    &screen::SHADER,
];
/// Compiles the passes that both methods run.
pub(crate) const WARM_UPS: &[WarmUp] = &[
    ("camera_planes", |gpu| drop(camera_planes::Pass::new(gpu))),
    ("plate", |gpu| drop(plate::Pass::new(gpu))),
    ("present", |gpu| drop(present::Pass::new(gpu))),
];
