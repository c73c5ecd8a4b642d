//! Why the core cannot go on.

use thiserror::Error;

use crate::gpu::GpuError;
use crate::preset::SettingsError;
use app_scene::scene::InputError;
use app_scene::toy::ToyError;

/// Why the core cannot go on.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CoreError {
    /// There is no device, or it was lost.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The toy cannot be posed.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A frame came before there was a scene.
    #[error("a frame came before its scene")]
    NoScene,
    /// A picture is not of the scene's size.
    #[error(
        "the {what} has {actual_px:?} pixels in {n_bytes} bytes, the scene {expected_px:?} of four bytes each"
    )]
    SizeDiffers {
        /// Which picture.
        what: &'static str,
        /// The scene's size.
        expected_px: [u32; 2],
        /// The picture's size.
        actual_px: [u32; 2],
        /// What it comes in.
        n_bytes: usize,
    },
    /// A picture is larger than the device takes, or empty.
    #[error("pictures of {size_px:?} pixels cannot be handled: each side is 1 to {largest_px} pixels")]
    SizeOutOfRange {
        /// The scene's size.
        size_px: [u32; 2],
        /// Longest side that the device takes.
        largest_px: u32,
    },
    /// A scene or a frame with a value that cannot be.
    #[error(transparent)]
    Input(#[from] InputError),
}
