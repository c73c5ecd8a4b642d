//! Camera planes that the platform lends as textures.

use app_scene::camera_frame::{LentPlanes, PlanarImage, PlaneError, YcbcrEncoding, half_size_px};
use thiserror::Error;
use wgpu::TextureFormat;

use super::handle::DeviceHandle;

/// Planes that are textures of the platform's already: passes read them where they lie.
///
/// The textures, or what their device calls once it is done with them, keep the platform's buffer.
pub struct LentTextures {
    /// The device of both textures.
    pub device: DeviceHandle,
    /// Luma, as `R8Unorm`.
    pub luma: wgpu::Texture,
    /// Cb and Cr, as `Rg8Unorm`, of half the size, rounded up.
    pub chroma: wgpu::Texture,
    /// Copies the same planes; none if the platform does not let them be read.
    pub read: Box<dyn Fn() -> Option<PlanarImage> + Send + Sync>,
}

/// Why textures are no picture.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LentError {
    /// No picture has that size.
    #[error(transparent)]
    Planes(#[from] PlaneError),
    /// A texture of another size or format than the component's.
    #[error("camera planes, {plane}: a texture of {} x {} px, {format:?}; {} x {} px, {needed:?} is needed",
        size_px[0], size_px[1], needed_px[0], needed_px[1])]
    Texture {
        /// Which component.
        plane: &'static str,
        /// Width and height.
        size_px: [u32; 2],
        /// As given.
        format: TextureFormat,
        /// Width and height that the component has.
        needed_px: [u32; 2],
        /// The format that it has.
        needed: TextureFormat,
    },
}

impl LentTextures {
    /// A picture that stays where the platform has it.
    ///
    /// # Errors
    /// When no picture has that size, or a texture is not one of its plane.
    pub fn into_image(self, size_px: [u32; 2], encoding: YcbcrEncoding) -> Result<PlanarImage, LentError> {
        let checked = self.check(size_px);
        // A size that no picture has is what is told first.
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

    /// Luma and chroma if they are textures of `device`; of another one, as after a loss, they mean nothing to it.
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
