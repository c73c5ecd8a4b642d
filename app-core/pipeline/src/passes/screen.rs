//! `screen`: the camera image with the work region over it, on a screen, rotated and cropped.

use bytemuck::Zeroable;
use glam::{DAffine2, DVec2, UVec2};
use wgpu::{StoreOp, TextureFormat};

use crate::geometry::rect::PixelRect;
use crate::gpu::{
    Draw, DrawSpec, GROUP_DRAW, GROUP_PASS, Gpu, Group, Recorder, Resource, Shader, Slot, TextureView,
    cleared, shader, shared_struct,
};
use crate::passes::pictures::{ComposedFrame, Encoding, Frame, RegionOverlay, fill_parts, n_pixels_of};

pub(crate) const SHADER: Shader = shader!("passes/screen", structs: [ScreenMap]);
const SLOTS: &[Slot] = &[Slot::per_use::<ScreenMap>(), Slot::Sampler];
/// Slots for a picture, and for luma and chroma.
const FRAME_SLOTS: [&[Slot]; 2] = [&[Slot::Filtered], &[Slot::Filtered, Slot::Filtered]];
/// Group of the region's picture.
const GROUP_REGION: usize = 3;
const REGION_SLOTS: &[Slot] = &[Slot::Filtered];

shared_struct! {
    /// Map from pixels of the screen to those of the picture, the picture's size, and position and
    /// opacity of the region's picture.
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
        pub encoding: Encoding,
    }
}

impl ScreenMap {
    fn new(image_from_screen: &DAffine2, composed: &ComposedFrame<'_>) -> Self {
        let axes = image_from_screen.matrix2;
        let pair = |pair: DVec2| pair.as_vec2().to_array();
        let map = Self {
            x_axis: pair(axes.x_axis),
            y_axis: pair(axes.y_axis),
            origin_px: pair(image_from_screen.translation),
            picture_px: pair(composed.size_px.as_dvec2()),
            chroma_px: composed.frame.views()[1].size_px().as_vec2().to_array(),
            encoding: composed.frame.uniform(),
            ..Self::zeroed()
        };
        map.with_region(composed.region)
    }

    fn with_region(self, region: Option<RegionOverlay<'_>>) -> Self {
        region.map_or(self, |overlay| Self {
            region_origin_px: overlay.rect.origin_px.as_vec2().to_array(),
            region_px: overlay.rect.size_px.as_vec2().to_array(),
            effect: overlay.effect,
            ..self
        })
    }
}

pub(crate) struct Pass {
    /// Draws for a picture and for planes.
    frame: [Draw; 2],
    region: Draw,
    /// Draws that blend the region into the frame, for a picture and for planes.
    mixed: [Draw; 2],
}

impl Pass {
    /// The pass for a screen of `format`, which stores sRGB codes unchanged.
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

    /// Draws the picture by the map from pixels of the screen to those of the picture.
    pub(crate) fn encode(
        &self,
        recorder: &mut Recorder<'_>,
        composed: &ComposedFrame<'_>,
        image_from_screen: &DAffine2,
        screen: &TextureView,
    ) {
        let map = ScreenMap::new(image_from_screen, composed);
        let all = PixelRect {
            origin_px: UVec2::ZERO,
            size_px: screen.size_px(),
        };
        let region = composed.region.filter(|overlay| overlay.effect > 0.0);
        let inside = region.and_then(|overlay| {
            Some((
                overlay,
                shown_rect(&overlay.rect, image_from_screen)?.common(&all)?,
            ))
        });
        let beside = inside.map_or_else(|| vec![all], |(_, inside)| all.beside(&inside).collect());
        let frame = &composed.frame;
        let of_frame = by_form(&self.frame, frame);
        let sampler = &recorder.gpu.samplers.linear;
        let to_picture = recorder.bind_with(of_frame, GROUP_PASS, &map, &[Resource::PerUse, sampler.into()]);
        let seen = bind_frame(recorder, of_frame, frame);
        let over = inside.map(|(overlay, inside)| (self.of_region(recorder, frame, &overlay), inside));
        let mut render = recorder.render(SHADER.name, &[Some(cleared(screen))], None, StoreOp::Discard);
        render.set(&to_picture);
        if let Some(((draw, groups), inside)) = over {
            render.begin(draw, &groups);
            fill_parts(&mut render, &[inside]);
        }
        render.narrow(n_pixels_of(&beside));
        render.begin(of_frame, &[seen]);
        fill_parts(&mut render, &beside);
    }

    /// The pipeline that draws the region, and its inputs.
    fn of_region(
        &self,
        recorder: &Recorder<'_>,
        frame: &Frame<'_>,
        overlay: &RegionOverlay<'_>,
    ) -> (&Draw, Vec<Group>) {
        let bind = |draw| recorder.bind(draw, GROUP_REGION, &[overlay.picture.light.into()]);
        if overlay.effect < 1.0 {
            let draw = by_form(&self.mixed, frame);
            return (draw, vec![bind(draw), bind_frame(recorder, draw, frame)]);
        }
        (&self.region, vec![bind(&self.region)])
    }
}

/// The draw for a frame in the form of a picture or of planes.
fn by_form<'a>([of_picture, of_planes]: &'a [Draw; 2], frame: &Frame<'_>) -> &'a Draw {
    match frame {
        Frame::Picture(_) => of_picture,
        Frame::Planes(_) => of_planes,
    }
}

fn bind_frame(recorder: &Recorder<'_>, draw: &Draw, frame: &Frame<'_>) -> Group {
    match frame {
        Frame::Picture(picture) => recorder.bind(draw, GROUP_DRAW, &[picture.light.into()]),
        Frame::Planes(planes) => recorder.bind(draw, GROUP_DRAW, &planes.views.map(Resource::from)),
    }
}

/// The pixels of a screen whose centres lie in a rectangle of the picture, if there are any; the
/// rectangle may extend beyond the screen.
fn shown_rect(rect: &PixelRect, image_from_screen: &DAffine2) -> Option<PixelRect> {
    let screen_from_image = image_from_screen.inverse();
    let [one, other] = [rect.origin_px, rect.origin_px + rect.size_px]
        .map(|corner| screen_from_image.transform_point2(corner.as_dvec2()));
    // The first pixel whose centre is at a border or beyond it.
    let [first, end] = [one.min(other), one.max(other)].map(|corner| (corner - 0.5).ceil().as_uvec2());
    let size_px = end.saturating_sub(first);
    (size_px.min_element() > 0).then_some(PixelRect {
        origin_px: first,
        size_px,
    })
}
