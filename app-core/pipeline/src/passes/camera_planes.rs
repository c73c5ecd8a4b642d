//! `camera_planes`: conversion of the camera's planes of luma and chroma to sRGB codes.

use glam::UVec2;
use wgpu::TextureFormat;

use crate::gpu::{
    Draw, DrawSpec, GROUP_PASS, Gpu, Recorder, Resource, Shader, Slot, Texture, TextureView, shader,
};
use crate::passes::pictures::{Encoding, FramePlanes};
use app_scene::camera_frame::{PlanarImage, half_size_px};

pub(crate) const SHADER: Shader = shader!("passes/camera_planes");
const SLOTS: &[Slot] = &[Slot::per_use::<Encoding>(), Slot::Texture, Slot::Texture];
/// Format of the output: codes of the frame.
const CODES: TextureFormat = TextureFormat::Rgba8Unorm;

pub(crate) struct Pass {
    draw: Draw,
}

/// Target textures of the conversion.
pub(crate) struct Planes {
    luma: Texture,
    chroma: Texture,
}

impl Planes {
    pub(crate) fn new(gpu: &Gpu, size_px: [u32; 2]) -> Self {
        let half = UVec2::from(half_size_px(size_px));
        Self {
            luma: Texture::plane(gpu, "luma", size_px.into(), TextureFormat::R8Unorm),
            chroma: Texture::plane(gpu, "chroma", half, TextureFormat::Rg8Unorm),
        }
    }

    pub(crate) fn write(&self, gpu: &Gpu, image: &PlanarImage) {
        self.luma.write(gpu, image.luma());
        self.chroma.write(gpu, image.chroma());
    }

    pub(crate) fn views(&self) -> [&TextureView; 2] {
        [&self.luma.view, &self.chroma.view]
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let groups = [&[][..], SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_decode", groups, &[CODES])),
        }
    }

    /// Decodes a whole picture.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        planes: &FramePlanes<'_>,
        frame_codes: &TextureView,
    ) {
        let [luma, chroma] = planes.views;
        let resources = [Resource::PerUse, luma.into(), chroma.into()];
        let own = recorder.bind_with(&self.draw, GROUP_PASS, &planes.uniform(), &resources);
        recorder.fullscreen(&self.draw, &[own], &[frame_codes]);
    }
}
