//! The bundled session, read once for all tests: its scene, and its first frame.

use std::sync::LazyLock;

use app_core::frame::FrameInput;
use app_core::scene::Scene;
use app_core::session::Session;
use glam::{DMat4, DVec3};
use harness::bundled_session;

pub(crate) static SESSION: LazyLock<(Scene, FrameInput)> = LazyLock::new(|| {
    let session = bundled_session();
    let input = FrameInput::from(&session.frame(0).unwrap());
    (session.scene().clone(), input)
});

/// Centre of the box around its toy, in the world.
pub(crate) fn middle(world_from_object: &DMat4) -> DVec3 {
    desk::alignment::middle(&SESSION.0, world_from_object)
}
