//! Uniforms shared by all passes: region, receivers, lights.

use glam::{DMat3, DMat4, DVec2, DVec3, Mat3, Mat4, Vec3, Vec4};

use crate::geometry::anchored::AnchoredReceiver;
use crate::geometry::rect::{PixelRect, PlaneRect};
use crate::geometry::scene_layout::SceneLayout;
use crate::geometry::seen::Caster;
use crate::geometry::silhouette::{AROUND_PX, ByCamera, ON_RECEIVER, OntoReceiver, Viewers};
use crate::geometry::view::View;
use crate::gpu::{Buffer, Mat3Columns, Mirrors, Slot, mirrors, shared_struct};
use app_scene::geometry::bounds::Sphere;
use app_scene::geometry::opaque::STANDS;
use app_scene::reflection::Reflection;
use app_scene::scene::{Light, MAX_LIGHTS, MAX_RECEIVERS};
use app_scene::sharpness::Spread;
use app_scene::things::MAX_FRONTS;

/// WGSL part of the globals.
pub(crate) const GLOBALS: Mirrors = mirrors!(
    "common/globals",
    structs: [ReceiverPlane, Globals],
    constants: [MAX_LIGHTS, MAX_RECEIVERS, MAX_FRONTS],
);
/// WGSL part of the test whether a receiver hides the toy.
pub(crate) const BEHIND: Mirrors = mirrors!("common/behind", constants: [ON_RECEIVER]);
/// Slots of passes that read nothing else of the scene.
pub(crate) const GLOBALS_GROUP: &[Slot] = &[Slot::uniform::<Globals>()];

shared_struct! {
    /// A receiver in a view.
    pub struct ReceiverPlane {
        pub plane_from_anchor: [[f32; 4]; 4],
        pub plane_from_region_px: Mat3Columns,
        pub clip_from_plane: Mat3Columns,
        pub lights: [[f32; 4]; MAX_LIGHTS],
        pub reference_in_plane: [f32; 2],
        pub _pad: [f32; 2],
        pub rect: [f32; 4],
        pub stands_on: [f32; MAX_RECEIVERS],
    }
}

shared_struct! {
    /// Uniforms shared by all passes.
    pub struct Globals {
        pub clip_from_anchor: [[f32; 4]; 4],
        pub receivers: [ReceiverPlane; MAX_RECEIVERS],
        pub lights: [[f32; 4]; MAX_LIGHTS],
        pub light_radii: [f32; MAX_LIGHTS],
        pub border_px: [f32; 4],
        pub camera_in_anchor: [f32; 3],
        pub n_lights: u32,
        pub region_size_px: [f32; 2],
        pub region_origin_px: [f32; 2],
        pub toy_box_origin_px: [f32; 2],
        pub toy_box_size_px: [f32; 2],
        pub physical_box_origin_px: [f32; 2],
        pub physical_box_size_px: [f32; 2],
        pub spread: [f32; 4],
        pub n_receivers: u32,
        pub seen_from_behind: u32,
        pub near_m: f32,
        pub soft_side: f32,
        pub soft_reach_px: f32,
        pub is_line: u32,
        pub _pad_0: [f32; 2],
        pub things_fronts: [[f32; 4]; MAX_FRONTS],
        pub reflection_channel: [f32; 4],
        pub reflected_surroundings: [f32; 4],
        pub reflected_toy: [f32; 4],
    }
}

/// The globals, on the processor and on the device.
#[derive(Clone, Copy)]
pub(crate) struct GlobalsOnDevice<'a> {
    pub(crate) uniform: &'a Globals,
    pub(crate) buffer: &'a Buffer,
}

impl Globals {
    /// The camera's projection of draws in a target of the toy box.
    pub(crate) fn by_camera(&self) -> ByCamera {
        let receivers = self.receivers.iter().take(self.n_receivers as usize);
        ByCamera {
            clip_from_anchor: Mat4::from_cols_array_2d(&self.clip_from_anchor),
            region_size_px: self.region_size_px.into(),
            origin_px: self.toy_box_origin_px.into(),
            around_px: self.around_px(),
            inverse_depths: receivers
                .map(|receiver| Vec3::from(receiver.plane_from_region_px.map(|[_, _, w, _]| w)))
                .collect(),
        }
    }

    /// Whether a receiver is steeper than the top of a thing may be, such as a wall or a side.
    pub(crate) fn is_upright(&self, receiver: usize) -> bool {
        let receiver = self.receivers.get(receiver);
        receiver.is_some_and(|receiver| receiver.plane_from_anchor[1][1] < STANDS)
    }

    /// Maximum distance of a pixel's sample positions from its centre.
    fn around_px(&self) -> f32 {
        AROUND_PX.max(self.soft_reach_px)
    }

    /// Whether the picture is softer than the plate and the toy's colours.
    pub(crate) fn is_soft(&self) -> bool {
        self.soft_reach_px > 0.0
    }

    /// Number of a light's points, from the first on, for which the whole shadow of a toy on a
    /// receiver lies before the camera. The points are in the receiver's space.
    pub(crate) fn n_whole_shadows(&self, receiver: usize, points: &[Vec4], toy: &Sphere) -> usize {
        let Some(receiver) = self.receivers.get(receiver) else {
            return 0;
        };
        let plane_from_anchor = Mat4::from_cols_array_2d(&receiver.plane_from_anchor);
        #[allow(clippy::cast_possible_truncation, reason = "metres")]
        let caster = Caster {
            centre: plane_from_anchor.transform_point3(toy.centre.as_vec3()),
            radius_m: toy.radius_m as f32,
        };
        let depth = Vec3::from(receiver.clip_from_plane.map(|[_, _, w, _]| w));
        let is_whole = |point: &&Vec4| caster.has_whole_shadow(**point, depth, self.near_m);
        points.iter().take_while(is_whole).count()
    }

    /// Projection of shadows from the points of a light, in a receiver's space, onto it. `None` if
    /// the light has no points, or points of different kinds.
    pub(crate) fn onto_receiver(&self, receiver: usize, points_in_plane: &[Vec4]) -> Option<OntoReceiver> {
        let receiver = self.receivers.get(receiver)?;
        let columns = receiver.clip_from_plane.map(|[x, y, w, _]| [x, y, w]);
        Some(OntoReceiver {
            plane_from_anchor: Mat4::from_cols_array_2d(&receiver.plane_from_anchor),
            light: Viewers::around(points_in_plane)?,
            clip_from_plane: Mat3::from_cols_array_2d(&columns),
            region_size_px: self.region_size_px.into(),
            near_m: self.near_m,
            around_px: self.around_px(),
        })
    }
}

/// Depth below which a shadow is clipped, relative to the camera's distance from the toy.
const NEAR_OVER_DISTANCE: f64 = 0.02;
/// Width of the fade into untouched pixels at an inner border of the region.
pub(crate) const BORDER_PX: u32 = 24;

/// The globals of the region `rect` of a camera's picture, with the whole region as both boxes.
#[must_use]
pub fn globals(view: &View, rect: &PixelRect, layout: &SceneLayout<'_>) -> Globals {
    let world_from_anchor = layout.world_from_anchor();
    let camera_in_anchor = view.camera_in(&world_from_anchor);
    let mut receivers = [bytemuck::Zeroable::zeroed(); MAX_RECEIVERS];
    for (slot, receiver) in receivers.iter_mut().zip(layout.receivers) {
        *slot = receiver_plane(view, rect, layout, receiver);
    }
    let end_px = rect.origin_px + rect.size_px;
    let fade = |is_inner: bool| if is_inner { BORDER_PX as f32 } else { 0.0 };
    #[allow(clippy::cast_possible_truncation, reason = "at most four")]
    let count = |n: usize, most: usize| n.min(most) as u32;
    Globals {
        clip_from_anchor: view
            .clip_from(rect, &world_from_anchor)
            .as_mat4()
            .to_cols_array_2d(),
        receivers,
        lights: lights_in(layout.lights, &world_from_anchor.inverse()),
        light_radii: light_radii(layout.lights),
        border_px: [
            fade(rect.origin_px.x > 0),
            fade(rect.origin_px.y > 0),
            fade(end_px.x < view.image_px.x),
            fade(end_px.y < view.image_px.y),
        ],
        camera_in_anchor: camera_in_anchor.as_vec3().to_array(),
        n_lights: count(layout.lights.len(), MAX_LIGHTS),
        region_size_px: rect.size_px.as_vec2().to_array(),
        region_origin_px: rect.origin_px.as_vec2().to_array(),
        toy_box_origin_px: [0.0; 2],
        toy_box_size_px: rect.size_px.as_vec2().to_array(),
        physical_box_origin_px: [0.0; 2],
        physical_box_size_px: rect.size_px.as_vec2().to_array(),
        spread: [0.0; 4],
        n_receivers: count(layout.receivers.len(), MAX_RECEIVERS),
        seen_from_behind: seen_from_behind(view, layout.receivers),
        near_m: narrowed(NEAR_OVER_DISTANCE * camera_in_anchor.distance(layout.toy_in_anchor)),
        soft_side: 0.0,
        soft_reach_px: 0.0,
        is_line: 0,
        _pad_0: [0.0; 2],
        things_fronts: [[0.0; 4]; MAX_FRONTS],
        reflection_channel: [0.0; 4],
        reflected_surroundings: [0.0; 4],
        reflected_toy: [0.0; 4],
    }
}

impl Globals {
    /// Sets parts of the region as the toy box and the physical box, counted from its corner.
    #[must_use]
    pub fn with_boxes(self, toy_box: &PixelRect, physical_box: &PixelRect) -> Self {
        Self {
            toy_box_origin_px: toy_box.origin_px.as_vec2().to_array(),
            toy_box_size_px: toy_box.size_px.as_vec2().to_array(),
            physical_box_origin_px: physical_box.origin_px.as_vec2().to_array(),
            physical_box_size_px: physical_box.size_px.as_vec2().to_array(),
            ..self
        }
    }

    /// Sets the reflection of the first receiver, and the channel of its visibility; `None` is a
    /// matt receiver.
    #[must_use]
    pub fn with_reflection(self, reflection: Option<(&Reflection, usize)>) -> Self {
        let Some((reflection, channel)) = reflection else {
            return self;
        };
        let mut reflection_channel = [0.0; 4];
        if let Some(slot) = reflection_channel.get_mut(channel) {
            *slot = 1.0;
        }
        let [r, g, b] = reflection.surroundings;
        let [toy_r, toy_g, toy_b] = reflection.toy_above_surroundings;
        Self {
            reflection_channel,
            reflected_surroundings: [r, g, b, narrowed(reflection.roughness.sqrt())],
            reflected_toy: [toy_r, toy_g, toy_b, 0.0],
            ..self
        }
    }

    /// Sets the spread of a point in the picture; without one the picture is as sharp as its
    /// pixels.
    #[must_use]
    pub fn with_spread(self, spread: Spread) -> Self {
        if spread == Spread::NONE {
            return Self {
                spread: [0.0; 4],
                soft_side: 0.0,
                soft_reach_px: 0.0,
                is_line: 0,
                ..self
            };
        }
        // A mean over three has twice the variance of one side's weight.
        let side = 0.25 * spread.variances_px2()[1].clamp(0.0, 1.0);
        let own = Spread {
            xx_px2: PIXEL_PX2 - 2.0 * side,
            xy_px2: 0.0,
            yy_px2: PIXEL_PX2 - 2.0 * side,
        };
        let [wide, narrow] = spread.and(own).axes_px();
        let outermost = if spread.is_line() {
            OUTERMOST_OF_LINE
        } else {
            OUTERMOST
        };
        let reach_px = (outermost * wide.abs() + OUTERMOST * narrow.abs()).max_element();
        Self {
            spread: [wide.x, wide.y, narrow.x, narrow.y].map(narrowed),
            soft_side: narrowed(side),
            soft_reach_px: narrowed(reach_px + if side > 0.0 { 1.0 } else { 0.0 }),
            is_line: u32::from(spread.is_line()),
            ..self
        }
    }
}

/// Variance of a position within a pixel, along each axis.
pub(crate) const PIXEL_PX2: f64 = 1.0 / 12.0;
/// Distance of the outermost of 64 positions from the centre, in standard deviations, with a margin
/// for rounding.
const OUTERMOST: f64 = 2.44;
/// The same along a line.
const OUTERMOST_OF_LINE: f64 = 1.74;

fn receiver_plane(
    view: &View,
    rect: &PixelRect,
    layout: &SceneLayout<'_>,
    receiver: &AnchoredReceiver,
) -> ReceiverPlane {
    let plane_from_world = receiver.world_from_plane.inverse();
    let plane_from_anchor = plane_from_world * layout.world_from_anchor();
    let nearest = plane_from_anchor.transform_point3(layout.toy_in_anchor);
    let reference = receiver.rect.nearest(DVec2::new(nearest.x, nearest.z));
    let PlaneRect { min, max } = receiver.rect;
    ReceiverPlane {
        plane_from_anchor: plane_from_anchor.as_mat4().to_cols_array_2d(),
        plane_from_region_px: columns(view.plane_from_region_px(rect, &receiver.world_from_plane)),
        clip_from_plane: columns(view.clip_from_plane(rect, &receiver.world_from_plane)),
        lights: lights_in(layout.lights, &plane_from_world),
        reference_in_plane: reference.as_vec2().to_array(),
        _pad: [0.0; 2],
        rect: [min.x, min.y, max.x, max.y].map(narrowed),
        stands_on: stands_on(receiver, layout.receivers),
    }
}

/// 1 for each of the receivers above which the middle of one is.
fn stands_on(receiver: &AnchoredReceiver, receivers: &[AnchoredReceiver]) -> [f32; MAX_RECEIVERS] {
    let PlaneRect { min, max } = receiver.rect;
    let middle = 0.5 * (min + max);
    let in_world = receiver
        .world_from_plane
        .transform_point3(DVec3::new(middle.x, 0.0, middle.y));
    let mut slots = [0.0; MAX_RECEIVERS];
    for (slot, below) in slots.iter_mut().zip(receivers) {
        let here = below.world_from_plane.inverse().transform_point3(in_world);
        let is_other = !std::ptr::eq(below, receiver);
        if is_other && here.y > 0.0 && below.rect.holds(DVec2::new(here.x, here.z)) {
            *slot = 1.0;
        }
    }
    slots
}

/// Bits of the receivers; bit k is 1 if receiver k is seen from behind.
fn seen_from_behind(view: &View, receivers: &[AnchoredReceiver]) -> u32 {
    let receivers = receivers.iter().take(MAX_RECEIVERS).enumerate();
    let behind = receivers.filter(|(_, receiver)| !view.sees_front_of(&receiver.world_from_plane));
    behind.fold(0, |seen, (index, _)| seen | 1 << index)
}

fn light_radii(lights: &[Light]) -> [f32; MAX_LIGHTS] {
    let mut radii = [0.0; MAX_LIGHTS];
    for (slot, light) in radii.iter_mut().zip(lights) {
        *slot = narrowed(light.radius());
    }
    radii
}

fn lights_in(lights: &[Light], space_from_world: &DMat4) -> [[f32; 4]; MAX_LIGHTS] {
    let mut slots = [[0.0; 4]; MAX_LIGHTS];
    for (slot, light) in slots.iter_mut().zip(lights) {
        *slot = light.centre_in(space_from_world).as_vec4().to_array();
    }
    slots
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "metres in f32 as shaders have them"
)]
fn narrowed(metres: f64) -> f32 {
    metres as f32
}

/// A 3 x 3 matrix in uniform layout.
pub(crate) fn columns(m: DMat3) -> Mat3Columns {
    m.as_mat3().to_cols_array_2d().map(|[x, y, z]| [x, y, z, 0.0])
}
