//! `camera_planes`: the camera's planes of luma and chroma, or a part of them, as sRGB codes.

use glam::UVec2;
use wgpu::TextureFormat;

use crate::camera_frame::{PlanarImage, YcbcrEncoding, half_size_px};
use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::{Mat3Columns, shared_struct};
use crate::gpu::texture::{Texture, TextureView};
use crate::passes::parts::FULLSCREEN;

pub(crate) const SHADER: Shader =
    Shader::new(&[&FULLSCREEN, &part!("passes/camera_planes", structs: [Encoding])]);
const SLOTS: &[Slot] = &[Slot::per_use::<Encoding>(), Slot::Texture, Slot::Texture];
/// Format of what is written: codes of the frame.
const CODES: TextureFormat = TextureFormat::Rgba8Unorm;

shared_struct! {
    /// Map from the planes' codes to sRGB codes.
    pub(crate) struct Encoding {
        pub srgb_from_ycbcr: Mat3Columns,
        pub origin: [f32; 4],
        pub corner_px: [i32; 2],
        pub unused: [i32; 2],
    }
}

pub(crate) struct Pass {
    draw: Draw,
}

/// Textures that planes are written to.
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

    /// Decodes views of luma and chroma, which may be the platform's: no cache keeps them. As much as the target holds, from
    /// the corner at `corner_px` on.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        encoding: YcbcrEncoding,
        [luma, chroma]: [&TextureView; 2],
        (frame_codes, corner_px): (&TextureView, UVec2),
    ) {
        let map = encoding.srgb_from_ycbcr();
        let encoding = Encoding {
            srgb_from_ycbcr: map.columns(),
            origin: map.origin.extend(0.0).to_array(),
            corner_px: corner_px.as_ivec2().to_array(),
            unused: [0; 2],
        };
        let resources = [Resource::PerUse, luma.into(), chroma.into()];
        let own = recorder.bind_once_with(&self.draw, GROUP_PASS, &encoding, &resources);
        recorder.fullscreen(&self.draw, &[own], &[frame_codes]);
    }
}
