//! The frame of a session whose cost is counted.

use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::session::Session;
use desk::alignment::{Alignments, Asked};
use desk::replay::ReplayError;

/// The first frame that is retargeted: it shows the toy in another pose than the real toy's, or at
/// another place. If the session lists no lights, it has those that alignment finds in its picture.
///
/// # Errors
/// When a frame cannot be read or aligned.
pub fn first_moved(session: &dyn Session) -> Result<Option<FrameInput>, ReplayError> {
    let scene = session.scene();
    for index in 0..session.n_frames() {
        let frame = session.frame(index)?;
        let input = FrameInput::from(&frame);
        if input.shows_real_toy(scene) {
            continue;
        }
        if !scene.lights.is_empty() {
            return Ok(Some(input));
        }
        let aligned = Alignments::find(session, index..index + 1, Asked::default())?;
        let lights = aligned.input(index, &frame, Preset::default()).lights;
        return Ok(Some(input.with_lights(lights)));
    }
    Ok(None)
}
