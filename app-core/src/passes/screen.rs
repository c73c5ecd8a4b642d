//! `screen`: the finished picture on a screen, turned and cropped.

use glam::DAffine2;
use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::TextureView;
use crate::passes::parts::{FULLSCREEN, SRGB};

pub(crate) const SHADER: Shader =
    Shader::new(&[&SRGB, &FULLSCREEN, &part!("passes/screen", structs: [ScreenMap])]);
const SLOTS: &[Slot] = &[Slot::per_use::<ScreenMap>(), Slot::Filtered, Slot::Sampler];

shared_struct! {
    /// Map from pixels of the screen to those of the picture, and the picture's size.
    pub(crate) struct ScreenMap {
        pub x_axis: [f32; 2],
        pub y_axis: [f32; 2],
        pub origin_px: [f32; 2],
        pub picture_px: [f32; 2],
    }
}

impl ScreenMap {
    pub(crate) fn new(image_from_screen: &DAffine2, picture_px: [u32; 2]) -> Self {
        let axes = image_from_screen.matrix2;
        let pair = |pair: glam::DVec2| pair.as_vec2().to_array();
        Self {
            x_axis: pair(axes.x_axis),
            y_axis: pair(axes.y_axis),
            origin_px: pair(image_from_screen.translation),
            picture_px: pair(glam::DVec2::from(picture_px.map(f64::from))),
        }
    }
}

pub(crate) struct Pass {
    draw: Draw,
}

impl Pass {
    /// For a screen of `format`, which takes sRGB codes as they are.
    pub(crate) fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        let groups = [&[][..], SLOTS, &[], &[]];
        Self {
            draw: gpu.draw(&DrawSpec::fullscreen(&SHADER, "fs_show", groups, &[format])),
        }
    }

    /// `picture` is decoded where it is read.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        (picture, map): (&TextureView, &ScreenMap),
        screen: &TextureView,
    ) {
        let resources = [
            Resource::PerUse,
            picture.into(),
            (&recorder.gpu.samplers.linear).into(),
        ];
        let own = recorder.bind_with(&self.draw, GROUP_PASS, map, &resources);
        recorder.fullscreen(&self.draw, &[own], &[screen]);
    }
}
