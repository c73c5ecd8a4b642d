//! Pictures of probes that tell nothing.

use thiserror::Error;

use super::ProbeView;
use app_scene::scene::{Image, InputError};

/// Why no light can be read off a picture of a probe.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ProbeError {
    /// A value that cannot be.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The picture has more or fewer bytes than pixels of 4 bytes.
    #[error("the picture of the probe has not 4 bytes for each of {width_px} x {height_px} pixels")]
    Size {
        /// Columns.
        width_px: u32,
        /// Rows.
        height_px: u32,
    },
    /// Nothing of the probe's front is in the picture.
    #[error("the probe is out of the picture, or seen from behind")]
    OutOfView,
    /// Too few pixels show the probe.
    #[error("the probe is seen on {n_pixels} pixels, too few to tell a direction")]
    TooSmall {
        /// So many.
        n_pixels: usize,
    },
}

impl ProbeError {
    /// Whether the camera looked elsewhere, or from too far, rather than anything being wrong.
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
