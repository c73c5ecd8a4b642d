//! A camera's unchanged picture, before a scene exists or while none is estimated.

use glam::UVec2;

use crate::gpu::Gpu;
use crate::passes::pictures::ComposedFrame;
use crate::stage::camera_texture::CameraTexture;
use app_scene::camera_frame::CameraImage;

/// A camera's picture on the device.
pub(super) struct Preview {
    texture: CameraTexture,
    size_px: [u32; 2],
}

impl Preview {
    pub(super) fn new(size_px: [u32; 2]) -> Self {
        Self {
            texture: CameraTexture::new(UVec2::from(size_px)),
            size_px,
        }
    }

    pub(super) fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Uploads the picture, unless it is already on the device.
    pub(super) fn take(&mut self, gpu: &Gpu, image: &CameraImage) {
        self.texture.take(gpu, image);
    }

    pub(super) fn composed(&self, gpu: &Gpu) -> ComposedFrame<'_> {
        ComposedFrame {
            frame: self.texture.frame(gpu),
            region: None,
            size_px: self.size_px.into(),
        }
    }
}
