//! Camera planes that the platform shares as textures.

use app_scene::camera_frame::{LentPlanes, PlanarImage, PlaneError, YcbcrEncoding, half_size_px};
use thiserror::Error;
use wgpu::TextureFormat;

use super::handle::DeviceHandle;

/// Planes that already are textures of the platform; passes read them in place.
///
/// The platform's buffer lives as long as the textures, or until the callback that their device
/// runs when it has finished with them.
pub struct LentTextures {
    /// The device of both textures.
    pub device: DeviceHandle,
    /// Luma, as `R8Unorm`.
    pub luma: wgpu::Texture,
    /// Cb and Cr, as `Rg8Unorm`, of half the size, rounded up.
    pub chroma: wgpu::Texture,
    /// Copies the same planes; returns `None` if the platform does not permit reading.
    pub read: Box<dyn Fn() -> Option<PlanarImage> + Send + Sync>,
}

/// The reason why textures are not a valid picture.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LentError {
    /// No picture has that size.
    #[error(transparent)]
    Planes(#[from] PlaneError),
    /// A texture with another size or format than its component.
    #[error("camera planes, {plane}: a texture of {} x {} px, {format:?}; {} x {} px, {needed:?} is needed",
        size_px[0], size_px[1], needed_px[0], needed_px[1])]
    Texture {
        /// Name of the component.
        plane: &'static str,
        /// Width and height.
        size_px: [u32; 2],
        /// Format as given.
        format: TextureFormat,
        /// Required width and height.
        needed_px: [u32; 2],
        /// Required format.
        needed: TextureFormat,
    },
}

impl LentTextures {
    /// A picture that stays in the platform's memory.
    ///
    /// # Errors
    /// If no picture has that size, or if a texture does not match its plane.
    pub fn into_image(self, size_px: [u32; 2], encoding: YcbcrEncoding) -> Result<PlanarImage, LentError> {
        let checked = self.check(size_px);
        // An impossible size is reported first.
        let image = PlanarImage::lent(size_px, encoding, self)?;
        checked.map(|()| image)
    }

    fn check(&self, size_px: [u32; 2]) -> Result<(), LentError> {
        let planes = [
            ("luma", &self.luma, size_px, TextureFormat::R8Unorm),
            (
                "Cb and Cr",
                &self.chroma,
                half_size_px(size_px),
                TextureFormat::Rg8Unorm,
            ),
        ];
        for (plane, texture, needed_px, needed) in planes {
            let (size_px, format) = ([texture.width(), texture.height()], texture.format());
            if (size_px, format) != (needed_px, needed) {
                return Err(LentError::Texture {
                    plane,
                    size_px,
                    format,
                    needed_px,
                    needed,
                });
            }
        }
        Ok(())
    }

    /// Luma and chroma if they are textures of `device`; on another device, as after a loss, they
    /// are invalid.
    pub(crate) fn on<'a>(image: &'a PlanarImage, device: &DeviceHandle) -> Option<[&'a wgpu::Texture; 2]> {
        let lent: &Self = image.lent_as().filter(|lent: &&Self| lent.device.is(device))?;
        Some([&lent.luma, &lent.chroma])
    }
}

impl LentPlanes for LentTextures {
    fn read(&self) -> Option<PlanarImage> {
        (self.read)()
    }
}
