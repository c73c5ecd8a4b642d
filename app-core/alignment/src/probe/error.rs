//! Errors of probes' pictures.

use thiserror::Error;

use super::ProbeView;
use app_scene::scene::{Image, InputError};

/// The reason why no light can be estimated from a picture of a probe.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ProbeError {
    /// An invalid value.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The number of bytes does not fit the picture's size.
    #[error("the picture of the probe does not have 4 bytes for each of {width_px} x {height_px} pixels")]
    Size {
        /// Columns.
        width_px: u32,
        /// Rows.
        height_px: u32,
    },
    /// The picture does not show the probe's front.
    #[error("the probe is outside the picture, or only its back is visible")]
    OutOfView,
    /// Too few pixels show the probe.
    #[error("the probe covers {n_pixels} pixels, too few for a direction: take the picture from nearer")]
    TooSmall {
        /// Number of pixels.
        n_pixels: usize,
    },
}

impl ProbeError {
    /// Whether the camera looked elsewhere, or was too far away, without any other error.
    #[must_use]
    pub fn is_out_of_view(&self) -> bool {
        matches!(self, Self::OutOfView | Self::TooSmall { .. })
    }
}

/// Validates a view.
pub(super) fn check(view: &ProbeView<'_>) -> Result<(), ProbeError> {
    view.shape.check("shape")?;
    view.picture.check("picture")?;
    let Image {
        width_px, height_px, ..
    } = *view.picture.image;
    if width_px == 0 || height_px == 0 || !view.picture.image.is_of_size([width_px, height_px]) {
        return Err(ProbeError::Size { width_px, height_px });
    }
    Ok(())
}
