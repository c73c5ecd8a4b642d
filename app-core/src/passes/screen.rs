//! `screen`: the camera image with the work region laid over it, on a screen, turned and cropped.

use glam::{DAffine2, DVec2, UVec2};
use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::shared_struct;
use crate::gpu::texture::TextureView;
use crate::passes::finished::Finished;
use crate::passes::parts::{FULLSCREEN, SRGB};

pub(crate) const SHADER: Shader =
    Shader::new(&[&SRGB, &FULLSCREEN, &part!("passes/screen", structs: [ScreenMap])]);
const SLOTS: &[Slot] = &[
    Slot::per_use::<ScreenMap>(),
    Slot::Filtered,
    Slot::Filtered,
    Slot::Sampler,
];

shared_struct! {
    /// Map from pixels of the screen to those of the picture, the picture's size, and where and how much of the region's picture
    /// is shown.
    pub(crate) struct ScreenMap {
        pub x_axis: [f32; 2],
        pub y_axis: [f32; 2],
        pub origin_px: [f32; 2],
        pub picture_px: [f32; 2],
        pub region_origin_px: [f32; 2],
        pub region_px: [f32; 2],
        pub effect: f32,
        pub unused: f32,
    }
}

impl ScreenMap {
    fn new(image_from_screen: &DAffine2, finished: &Finished<'_>) -> Self {
        let axes = image_from_screen.matrix2;
        let pair = |pair: DVec2| pair.as_vec2().to_array();
        let (origin_px, region_px, effect) = finished.region.map_or_else(
            || (UVec2::ZERO, UVec2::ZERO, 0.0),
            |laid| (laid.rect.origin_px, laid.rect.size_px, laid.effect),
        );
        Self {
            x_axis: pair(axes.x_axis),
            y_axis: pair(axes.y_axis),
            origin_px: pair(image_from_screen.translation),
            picture_px: pair(finished.size_px.as_dvec2()),
            region_origin_px: pair(origin_px.as_dvec2()),
            region_px: pair(region_px.as_dvec2()),
            effect,
            unused: 0.0,
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

    /// With the map from pixels of the screen to those of the picture.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        (finished, image_from_screen): (&Finished<'_>, &DAffine2),
        screen: &TextureView,
    ) {
        let map = ScreenMap::new(image_from_screen, finished);
        let region = finished.region.map_or(finished.frame, |laid| laid.picture);
        let resources = [
            Resource::PerUse,
            finished.frame.light.into(),
            region.light.into(),
            (&recorder.gpu.samplers.linear).into(),
        ];
        let own = recorder.bind_with(&self.draw, GROUP_PASS, &map, &resources);
        recorder.fullscreen(&self.draw, &[own], &[screen]);
    }
}
