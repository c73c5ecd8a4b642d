//! `screen`: the camera image with the work region laid over it, on a screen, turned and cropped.

use std::slice::from_ref;

use bytemuck::Zeroable;
use glam::{DAffine2, DVec2, UVec2};
use wgpu::{StoreOp, TextureFormat};

use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Recorder, cleared, n_pixels};
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::{Mat3Columns, shared_struct};
use crate::gpu::texture::TextureView;
use crate::passes::finished::{Finished, Frame, FramePlanes};
use crate::passes::parts::{FULLSCREEN, SRGB};

pub(crate) const SHADER: Shader =
    Shader::new(&[&SRGB, &FULLSCREEN, &part!("passes/screen", structs: [ScreenMap])]);
const SLOTS: &[Slot] = &[Slot::per_use::<ScreenMap>(), Slot::Filtered, Slot::Sampler];
/// Group of the camera image.
const GROUP_FRAME: usize = 2;
const FRAME_SLOTS: &[Slot] = &[Slot::Filtered];
const PLANES_SLOTS: &[Slot] = &[Slot::Filtered, Slot::Filtered];

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
        let draw = |entry, of_frame| {
            let groups = [&[][..], SLOTS, of_frame, &[]];
            gpu.draw(&DrawSpec::fullscreen(&SHADER, entry, groups, &[format]))
        };
        Self {
            of_picture: draw("fs_show", FRAME_SLOTS),
            of_planes: draw("fs_show_planes", PLANES_SLOTS),
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
        let sampler = (&recorder.gpu.samplers.linear).into();
        let (draw, groups) = match &finished.frame {
            Frame::Picture(frame) => {
                let draw = &self.of_picture;
                let own = [Resource::PerUse, region.unwrap_or(frame.light).into(), sampler];
                let own = recorder.bind_with(draw, GROUP_PASS, &map, &own);
                (
                    draw,
                    [own, recorder.bind(draw, GROUP_FRAME, &[frame.light.into()])],
                )
            }
            Frame::Planes(planes) => {
                let draw = &self.of_planes;
                let [luma, chroma] = planes.views;
                let own = [Resource::PerUse, region.unwrap_or(luma).into(), sampler];
                // They may be the platform's: no cache keeps them.
                let own = recorder.bind_once_with(draw, GROUP_PASS, &map.with_planes(planes), &own);
                let planes = recorder.bind_once(draw, GROUP_FRAME, &[luma.into(), chroma.into()]);
                (draw, [own, planes])
            }
        };
        let [own, of_frame] = &groups;
        let mut render = recorder.render(SHADER.name, &[Some(cleared(screen))], None, StoreOp::Discard);
        render.begin(draw, from_ref(own));
        render.look_at_part(finished.n_seen(), n_pixels(finished.size_px));
        render.set(of_frame);
        render.draw(0..3, 0..1);
    }
}
