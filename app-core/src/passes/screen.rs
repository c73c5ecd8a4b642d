//! `screen`: the camera image with the work region laid over it, on a screen, turned and cropped.

use bytemuck::Zeroable;
use glam::{DAffine2, DVec2, UVec2};
use wgpu::TextureFormat;

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::{Mat3Columns, shared_struct};
use crate::gpu::texture::TextureView;
use crate::passes::finished::Finished;
use crate::passes::frame::{Frame, FramePlanes};
use crate::passes::parts::{FULLSCREEN, SRGB};

pub(crate) const SHADER: Shader =
    Shader::new(&[&SRGB, &FULLSCREEN, &part!("passes/screen", structs: [ScreenMap])]);
const SLOTS: &[Slot] = &[
    Slot::per_use::<ScreenMap>(),
    Slot::Filtered,
    Slot::Sampler,
    Slot::Filtered,
];
const SLOTS_OF_PLANES: &[Slot] = &[
    Slot::per_use::<ScreenMap>(),
    Slot::Filtered,
    Slot::Sampler,
    Slot::Filtered,
    Slot::Filtered,
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
        pub chroma_px: [f32; 2],
        pub srgb_from_ycbcr: Mat3Columns,
        pub grey: [f32; 4],
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
            ..Self::zeroed()
        }
    }

    /// The same for planes.
    fn with_planes(self, planes: &FramePlanes<'_>) -> Self {
        let map = planes.encoding.srgb_from_ycbcr();
        Self {
            chroma_px: planes.views[1].size_px().as_vec2().to_array(),
            srgb_from_ycbcr: map.columns(),
            grey: map.origin.extend(0.0).to_array(),
            ..self
        }
    }
}

pub(crate) struct Pass {
    of_picture: Draw,
    of_planes: Draw,
}

impl Pass {
    /// For a screen of `format`, which takes sRGB codes as they are.
    pub(crate) fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        let draw = |entry, slots| {
            let groups = [&[][..], slots, &[], &[]];
            gpu.draw(&DrawSpec::fullscreen(&SHADER, entry, groups, &[format]))
        };
        Self {
            of_picture: draw("fs_show", SLOTS),
            of_planes: draw("fs_show_planes", SLOTS_OF_PLANES),
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
        let region = finished.region.map(|laid| laid.picture.light);
        let sampler = &recorder.gpu.samplers.linear;
        match &finished.frame {
            Frame::Picture(frame) => {
                let region = region.unwrap_or(frame.light);
                let resources = [
                    Resource::PerUse,
                    region.into(),
                    sampler.into(),
                    frame.light.into(),
                ];
                let own = recorder.bind_with(&self.of_picture, GROUP_PASS, &map, &resources);
                recorder.fullscreen(&self.of_picture, &[own], &[screen]);
            }
            Frame::Planes(planes) => {
                let [luma, chroma] = planes.views;
                let region = region.unwrap_or(luma);
                let map = map.with_planes(planes);
                let resources = [
                    Resource::PerUse,
                    region.into(),
                    sampler.into(),
                    luma.into(),
                    chroma.into(),
                ];
                let own = recorder.bind_with(&self.of_planes, GROUP_PASS, &map, &resources);
                recorder.fullscreen(&self.of_planes, &[own], &[screen]);
            }
        }
    }
}
