//! Input that cannot be aligned.

use thiserror::Error;

use crate::probe::ProbeError;
use app_scene::frame::FrameInput;
use app_scene::scene::{InputError, Scene};
use app_scene::toy::ToyError;

/// The reason why a frame cannot be aligned.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AlignError {
    /// An invalid value.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The toy cannot be posed.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// A picture of the probe cannot be read.
    #[error(transparent)]
    Probe(#[from] ProbeError),
    /// The size of a picture differs from the scene's.
    #[error("the {what} is not {} x {} pixels with 4 bytes each, as the scene is", size_px[0], size_px[1])]
    Size {
        /// Name of the picture.
        what: &'static str,
        /// The scene's size.
        size_px: [u32; 2],
    },
}

/// Validates a scene and a frame of it.
pub(super) fn check(scene: &Scene, input: &FrameInput) -> Result<(), AlignError> {
    scene.check()?;
    input.check()?;
    let size_px = [scene.width_px, scene.height_px];
    let differs = |what| Err(AlignError::Size { what, size_px });
    if scene.plates.iter().any(|plate| !plate.image.is_of_size(size_px)) {
        return differs("plate");
    }
    if !input.image.is_of_size(size_px) {
        return differs("camera frame");
    }
    Ok(())
}
