//! `screen`: the camera image with the work region laid over it, on a screen, turned and cropped.

use bytemuck::Zeroable;
use glam::{DAffine2, DVec2, UVec2};
use wgpu::{StoreOp, TextureFormat};

use crate::geometry::rect::PixelRect;
use crate::gpu::bindings::{GROUP_DRAW, GROUP_PASS, Resource, Slot};
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec};
use crate::gpu::recorder::{Group, Recorder, cleared};
use crate::gpu::shader::{Shader, part};
use crate::gpu::shared::{Mat3Columns, shared_struct};
use crate::gpu::texture::TextureView;
use crate::passes::finished::{Finished, Laid};
use crate::passes::frame::Frame;
use crate::passes::in_parts::{fill, n_pixels_of};
use crate::passes::parts::{FULLSCREEN, SRGB};

pub(crate) const SHADER: Shader =
    Shader::new(&[&SRGB, &FULLSCREEN, &part!("passes/screen", structs: [ScreenMap])]);
const SLOTS: &[Slot] = &[Slot::per_use::<ScreenMap>(), Slot::Sampler];
/// Of a picture, and of luma and chroma.
const FRAME_SLOTS: [&[Slot]; 2] = [&[Slot::Filtered], &[Slot::Filtered, Slot::Filtered]];
/// Group of the region's picture.
const GROUP_REGION: usize = 3;
const REGION_SLOTS: &[Slot] = &[Slot::Filtered];

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
        let map = Self {
            x_axis: pair(axes.x_axis),
            y_axis: pair(axes.y_axis),
            origin_px: pair(image_from_screen.translation),
            picture_px: pair(finished.size_px.as_dvec2()),
            ..Self::zeroed()
        };
        map.with_region(finished.region).with_planes(&finished.frame)
    }

    fn with_region(self, region: Option<Laid<'_>>) -> Self {
        region.map_or(self, |laid| Self {
            region_origin_px: laid.rect.origin_px.as_vec2().to_array(),
            region_px: laid.rect.size_px.as_vec2().to_array(),
            effect: laid.effect,
            ..self
        })
    }

    fn with_planes(self, frame: &Frame<'_>) -> Self {
        let Frame::Planes(planes) = frame else {
            return self;
        };
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
    /// Of a picture, and of planes.
    frame: [Draw; 2],
    region: Draw,
    /// The region fading in the frame, of a picture and of planes.
    mixed: [Draw; 2],
}

/// A part of the screen that is drawn alike.
struct Part<'a> {
    rects: Vec<PixelRect>,
    draw: &'a Draw,
    groups: Vec<Group>,
}

impl Pass {
    /// For a screen of `format`, which takes sRGB codes as they are.
    pub(crate) fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        let draw = |entry, frame_slots, region_slots| {
            let groups = [&[], SLOTS, frame_slots, region_slots];
            gpu.draw(&DrawSpec::fullscreen(&SHADER, entry, groups, &[format]))
        };
        let [of_picture, of_planes] = FRAME_SLOTS;
        Self {
            frame: [
                draw("fs_picture", of_picture, &[]),
                draw("fs_planes", of_planes, &[]),
            ],
            region: draw("fs_region", &[], REGION_SLOTS),
            mixed: [
                draw("fs_region_over_picture", of_picture, REGION_SLOTS),
                draw("fs_region_over_planes", of_planes, REGION_SLOTS),
            ],
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
        let all = PixelRect {
            origin_px: UVec2::ZERO,
            size_px: screen.size_px(),
        };
        let region = finished.region.filter(|laid| laid.effect > 0.0);
        let inside =
            region.and_then(|laid| Some((laid, shown_rect(&laid.rect, image_from_screen)?.common(&all)?)));
        let mut parts = match inside {
            None => vec![self.of_frame(recorder, (&map, &finished.frame), vec![all])],
            Some((laid, inside)) => vec![
                self.of_frame(recorder, (&map, &finished.frame), all.beside(&inside).collect()),
                self.of_region(recorder, (&map, &finished.frame), (&laid, inside)),
            ],
        };
        // The largest first: what a part looks at is counted by its pixels.
        parts.sort_by_key(|part| std::cmp::Reverse(n_pixels_of(&part.rects)));
        let mut render = recorder.render(SHADER.name, &[Some(cleared(screen))], None, StoreOp::Discard);
        for part in &parts {
            render.narrow(n_pixels_of(&part.rects));
            render.begin(part.draw, &part.groups);
            fill(&mut render, &part.rects);
        }
    }

    fn of_frame(
        &self,
        recorder: &mut Recorder<'_>,
        (map, frame): (&ScreenMap, &Frame<'_>),
        rects: Vec<PixelRect>,
    ) -> Part<'_> {
        let draw = &self.frame[form(frame)];
        let groups = vec![bind_map(recorder, draw, map), bind_frame(recorder, draw, frame)];
        Part { rects, draw, groups }
    }

    fn of_region(
        &self,
        recorder: &mut Recorder<'_>,
        (map, frame): (&ScreenMap, &Frame<'_>),
        (laid, rect): (&Laid<'_>, PixelRect),
    ) -> Part<'_> {
        let is_mixed = laid.effect < 1.0;
        let draw = if is_mixed {
            &self.mixed[form(frame)]
        } else {
            &self.region
        };
        let region = recorder.bind(draw, GROUP_REGION, &[laid.picture.light.into()]);
        let mut groups = vec![bind_map(recorder, draw, map), region];
        if is_mixed {
            groups.push(bind_frame(recorder, draw, frame));
        }
        Part {
            rects: vec![rect],
            draw,
            groups,
        }
    }
}

fn form(frame: &Frame<'_>) -> usize {
    usize::from(matches!(frame, Frame::Planes(_)))
}

fn bind_map(recorder: &mut Recorder<'_>, draw: &Draw, map: &ScreenMap) -> Group {
    let sampler = &recorder.gpu.samplers.linear;
    recorder.bind_with(draw, GROUP_PASS, map, &[Resource::PerUse, sampler.into()])
}

fn bind_frame(recorder: &Recorder<'_>, draw: &Draw, frame: &Frame<'_>) -> Group {
    let views = frame.views().map(Resource::from);
    recorder.bind(draw, GROUP_DRAW, &views[..=form(frame)])
}

/// The pixels of a screen whose centres lie in a rectangle of the picture, if there are any; it may reach beyond the screen.
fn shown_rect(rect: &PixelRect, image_from_screen: &DAffine2) -> Option<PixelRect> {
    let screen_from_image = image_from_screen.inverse();
    let [one, other] = [rect.origin_px, rect.origin_px + rect.size_px]
        .map(|corner| screen_from_image.transform_point2(corner.as_dvec2()));
    // The first pixel with its centre at a border or beyond it.
    let [first, end] = [one.min(other), one.max(other)].map(|corner| (corner - 0.5).ceil().as_uvec2());
    let size_px = end.saturating_sub(first);
    (size_px.min_element() > 0).then_some(PixelRect {
        origin_px: first,
        size_px,
    })
}
