//! Helpers for tests alone: goldens and their comparison, the fuzzing functions, an endless
//! recording, shaders as they are built in.

pub mod compare;
pub mod endless;
pub mod fuzz;
pub mod golden;
pub mod session_format;
pub mod shader_text;
pub mod temporary;

use app_core::Core;
use app_core::gpu::AdapterChoice;
use app_core::session::Capture;
use app_core::wgpu;
use desk::files::{BUNDLED_SESSION, Folder};

/// The bundled session.
///
/// # Panics
/// When it cannot be read.
#[must_use]
pub fn bundled_session() -> Capture {
    let folder = Folder::open(BUNDLED_SESSION).expect("the session comes with the project");
    Capture::open(folder).expect("it is whole")
}

/// A core without any scene, on the fastest adapter.
///
/// # Panics
/// When there is no adapter, with the core's error.
#[must_use]
pub fn open_core() -> Core {
    let instance = wgpu::Instance::default();
    let core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest));
    core.unwrap_or_else(|error| panic!("{error}"))
}
