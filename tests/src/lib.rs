//! What tests alone use: goldens and their comparison, fuzzing's functions, a recording without end.

pub mod compare;
pub mod endless;
pub mod fuzz;
pub mod golden;
pub mod session_format;
pub mod temporary;

use app_core::Core;
use app_core::gpu::AdapterChoice;
use app_core::session::Capture;
use app_core::wgpu;
use desk::files::{BUNDLED_SESSION, Folder};

/// The session that comes with the project.
///
/// # Panics
/// Where it cannot be read.
#[must_use]
pub fn bundled_session() -> Capture {
    let folder = Folder::open(BUNDLED_SESSION).expect("the session comes with the project");
    Capture::open(folder).expect("it is whole")
}

/// A core without any scene, on the fastest adapter.
///
/// # Panics
/// Where there is no adapter, with what the core says.
#[must_use]
pub fn open_core() -> Core {
    let instance = wgpu::Instance::default();
    let core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest));
    core.unwrap_or_else(|error| panic!("{error}"))
}
