//! Errors of the core.

use thiserror::Error;

use crate::gpu::GpuError;
use crate::preset::SettingsError;
use app_scene::scene::InputError;
use app_scene::toy::ToyError;

/// The reason why the core cannot continue.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CoreError {
    /// No device exists, or it was lost.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The toy cannot be posed.
    #[error(transparent)]
    Toy(#[from] ToyError),
    /// A setting is out of range.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// A frame arrived before a scene was set.
    #[error("a frame arrived before a scene was set: set the scene first")]
    NoScene,
    /// A picture does not have the scene's size.
    #[error(
        "the {what} has {actual_px:?} pixels in {n_bytes} bytes, the scene {expected_px:?} of four bytes each"
    )]
    SizeDiffers {
        /// Name of the picture.
        what: &'static str,
        /// The scene's size.
        expected_px: [u32; 2],
        /// The picture's size.
        actual_px: [u32; 2],
        /// Size of the picture's data.
        n_bytes: usize,
    },
    /// A picture is empty or larger than the device supports.
    #[error("pictures of {size_px:?} pixels cannot be handled: each side is 1 to {largest_px} pixels")]
    SizeOutOfRange {
        /// The scene's size.
        size_px: [u32; 2],
        /// Longest side that the device supports.
        largest_px: u32,
    },
    /// A scene or a frame contains an impossible value.
    #[error(transparent)]
    Input(#[from] InputError),
}

impl CoreError {
    /// Whether device or surface is lost, so that others have to be opened. After any other error
    /// they work on, and the same call would fail again on others.
    #[must_use]
    pub fn is_loss(&self) -> bool {
        matches!(self, Self::Gpu(error) if !matches!(error, GpuError::Refused { .. }))
    }
}
