//! The camera's picture on the device, in whichever form it came.

use glam::UVec2;
use wgpu::TextureFormat;

use crate::camera_frame::{CameraImage, PlanarImage};
use crate::gpu::context::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::texture::{Texture, TextureView};
use crate::passes::camera_planes::{self, Planes};
use crate::passes::finished::Picture;

pub(crate) struct CameraTexture {
    texture: Texture,
    /// View of its sRGB codes, not decoded.
    codes: TextureView,
    /// The picture that is there.
    image: Option<CameraImage>,
    /// Once a picture has come as planes.
    decoder: Option<camera_planes::Pass>,
    /// Once planes have come as bytes.
    planes: Option<Planes>,
}

impl CameraTexture {
    pub(crate) fn new(gpu: &Gpu, size_px: UVec2) -> Self {
        let texture = Texture::target(gpu, "frame", size_px, TextureFormat::Rgba8UnormSrgb);
        Self {
            codes: texture.codes(gpu),
            texture,
            image: None,
            decoder: None,
            planes: None,
        }
    }

    /// The picture, decoded where it is read.
    pub(crate) fn view(&self) -> &TextureView {
        &self.texture.view
    }

    /// Both views of the picture.
    pub(crate) fn picture(&self) -> Picture<'_> {
        Picture {
            light: &self.texture.view,
            codes: &self.codes,
        }
    }

    /// Uploads `image` unless it is the one that is there already.
    pub(crate) fn take(&mut self, recorder: &mut Recorder<'_>, image: &CameraImage) {
        if self.image.as_ref().is_some_and(|known| known.is(image)) {
            return;
        }
        match image {
            CameraImage::Rgba(image) => self.texture.write(recorder.gpu, &image.rgba8),
            CameraImage::Planes(image) => self.decode(recorder, image),
        }
        self.image = Some(image.clone());
    }

    fn decode(&mut self, recorder: &mut Recorder<'_>, image: &PlanarImage) {
        let gpu = recorder.gpu;
        let pass = self.decoder.get_or_insert_with(|| camera_planes::Pass::new(gpu));
        let opened = gpu.opened.as_ref();
        let lent = opened.and_then(|opened| image.textures_on(&opened.device.handle()));
        let mut encode = |planes| pass.encode(recorder, image.encoding(), planes, &self.codes);
        if let Some(textures) = lent {
            let [luma, chroma] = textures.map(|texture| TextureView::of_other(gpu, texture));
            encode([&luma, &chroma]);
        } else {
            let planes = self
                .planes
                .get_or_insert_with(|| Planes::new(gpu, image.size_px()));
            planes.write(gpu, image);
            encode(planes.views());
        }
    }

    /// Takes what is there for unknown.
    pub(crate) fn forget(&mut self) {
        self.image = None;
    }
}
