//! The work region: the rectangle of the camera image that toy and shadows can reach, and the maps from and to it.
//!
//! Its pixels are receiver points through a homography, so passes that draw in the receiver's plane draw straight onto
//! the pixels that show it: texel and pixel coincide, and an edge in the plane is as sharp as the screen allows.

use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, UVec2};

use crate::gpu::layout::{Globals, MAX_LIGHTS};
use crate::light_points::{light_corners, light_in_plane};
use crate::scene::{Intrinsics, Light, Receiver};

/// Nearest depth that the camera can show, in metres.
const NEAR_M: f64 = 0.01;
/// The ambient light that the toy takes away counts out to this many toy heights from its footprint.
const AMBIENT_REACH_HEIGHTS: f64 = 0.5;
/// Width of the fade into untouched pixels at an inner border of the region.
pub(crate) const BORDER_PX: u32 = 24;

/// A rectangle of the camera image, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    /// Top left corner.
    pub origin_px: UVec2,
    /// Size; not zero.
    pub size_px: UVec2,
}

/// A box in the receiver's plane space, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The eight corners.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        (0..8).map(|k| {
            DVec3::new(
                if k & 1 == 0 { self.min.x } else { self.max.x },
                if k & 2 == 0 { self.min.y } else { self.max.y },
                if k & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The middle of the box.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }
}

/// A camera over a receiver: all transforms between the image and the plane, composed in f64.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Size of the camera image.
    pub image_px: UVec2,
    intrinsics: Intrinsics,
    camera_from_plane: DMat4,
}

impl View {
    /// A camera at `world_from_camera` over `receiver`.
    #[must_use]
    pub fn new(
        image_px: UVec2,
        intrinsics: Intrinsics,
        world_from_camera: &DMat4,
        receiver: &Receiver,
    ) -> Self {
        Self {
            image_px,
            intrinsics,
            camera_from_plane: world_from_camera.inverse() * receiver.world_from_plane,
        }
    }

    /// Image position of a homogeneous point in plane space, as (u w, v w, w) with w its depth in metres.
    fn image_px_from_plane(&self, in_plane: DVec4) -> DVec3 {
        let at = self.camera_from_plane * in_plane;
        let depth = -at.z;
        let k = &self.intrinsics;
        DVec3::new(
            k.fx_px * at.x + k.cx_px * depth,
            -k.fy_px * at.y + k.cy_px * depth,
            depth,
        )
    }

    /// Clip space of `rect` from plane space; depth is reversed and endless.
    #[must_use]
    pub fn clip_from_stage(&self, rect: &PixelRect) -> DMat4 {
        let k = &self.intrinsics;
        let size = rect.size_px.as_dvec2();
        let centre = DVec2::new(k.cx_px, k.cy_px) - rect.origin_px.as_dvec2();
        let clip_from_camera = DMat4::from_cols(
            DVec4::new(2.0 * k.fx_px / size.x, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 2.0 * k.fy_px / size.y, 0.0, 0.0),
            DVec4::new(
                1.0 - 2.0 * centre.x / size.x,
                2.0 * centre.y / size.y - 1.0,
                0.0,
                -1.0,
            ),
            DVec4::new(0.0, 0.0, NEAR_M, 0.0),
        );
        clip_from_camera * self.camera_from_plane
    }

    /// Homography from (u, v, 1) in pixels of `rect` to (x, z, w) on the receiver; w is 1 / depth.
    ///
    /// Not finite for a camera whose centre lies in the receiver's plane, which sees it as a line.
    #[must_use]
    pub fn plane_from_region_px(&self, rect: &PixelRect) -> DMat3 {
        let column = |in_plane: DVec4| {
            let at = self.image_px_from_plane(in_plane);
            let origin = rect.origin_px.as_dvec2();
            DVec3::new(at.x - origin.x * at.z, at.y - origin.y * at.z, at.z)
        };
        DMat3::from_cols(column(DVec4::X), column(DVec4::Z), column(DVec4::W)).inverse()
    }

    /// The camera's centre, in plane space.
    #[must_use]
    pub fn camera_in_stage(&self) -> DVec3 {
        self.camera_from_plane.inverse().w_axis.truncate()
    }

    /// The rectangle that a toy within `toy` and its shadows can reach, or `None` when it is out of the picture.
    #[must_use]
    pub fn region(&self, toy: &Bounds, lights: &[Light], plane_from_world: &DMat4) -> Option<PixelRect> {
        let mut reach = Reach::new(self, toy, lights, plane_from_world);
        toy.corners().for_each(|corner| reach.include(corner));
        reach.region()
    }

    /// What the shaders know of the scene.
    #[must_use]
    pub fn globals(&self, rect: &PixelRect, place: &Place<'_>) -> Globals {
        let clip_from_stage = self.clip_from_stage(rect);
        let receiver_column = |column: DVec4| DVec3::new(column.x, column.y, column.w);
        let mut lights = [[0.0; 4]; MAX_LIGHTS];
        for (slot, light) in lights.iter_mut().zip(place.lights) {
            *slot = light_in_plane(light, place.plane_from_world).as_vec4().to_array();
        }
        let n_lights = place.lights.len().min(MAX_LIGHTS);
        let end_px = rect.origin_px + rect.size_px;
        #[allow(clippy::cast_precision_loss, reason = "a few pixels")]
        let fade = |is_inner: bool| if is_inner { BORDER_PX as f32 } else { 0.0 };
        Globals {
            clip_from_stage: clip_from_stage.as_mat4().to_cols_array_2d(),
            plane_from_region_px: columns(self.plane_from_region_px(rect)),
            clip_from_receiver: columns(DMat3::from_cols(
                receiver_column(clip_from_stage.x_axis),
                receiver_column(clip_from_stage.z_axis),
                receiver_column(clip_from_stage.w_axis),
            )),
            lights,
            border_px: [
                fade(rect.origin_px.x > 0),
                fade(rect.origin_px.y > 0),
                fade(end_px.x < self.image_px.x),
                fade(end_px.y < self.image_px.y),
            ],
            camera_in_stage: self.camera_in_stage().as_vec3().to_array(),
            #[allow(clippy::cast_possible_truncation, reason = "at most MAX_LIGHTS")]
            n_lights: n_lights as u32,
            reference_in_plane: place.reference_in_plane.as_vec2().to_array(),
            half_extent_m: place.receiver.half_extent_m.as_vec2().to_array(),
            region_size_px: rect.size_px.as_vec2().to_array(),
            region_origin_px: rect.origin_px.as_vec2().to_array(),
        }
    }
}

/// Grows around what a toy and its shadows reach in the picture, point by point.
#[derive(Clone, Debug)]
pub struct Reach<'a> {
    view: &'a View,
    /// Corners of each light's disc, boxed: their shadows bound those of the whole light.
    sources: Vec<DVec4>,
    /// How far around its footprint the toy takes ambient light away.
    ambient_reach_m: f64,
    min_px: DVec2,
    max_px: DVec2,
    /// A shadow without end, or a point behind the camera: the rectangle has no bound.
    is_endless: bool,
}

impl<'a> Reach<'a> {
    /// Starts empty, for a toy within `toy`.
    #[must_use]
    pub fn new(view: &'a View, toy: &Bounds, lights: &[Light], plane_from_world: &DMat4) -> Self {
        let sources = lights
            .iter()
            .flat_map(|light| light_corners(light, plane_from_world, toy.centre()));
        Self {
            view,
            sources: sources.collect(),
            ambient_reach_m: AMBIENT_REACH_HEIGHTS * toy.max.y.max(0.0),
            min_px: DVec2::INFINITY,
            max_px: DVec2::NEG_INFINITY,
            is_endless: false,
        }
    }

    /// Takes in a point of the toy, in plane space, its shadows and the ground near it.
    pub fn include(&mut self, in_plane: DVec3) {
        self.include_homogeneous(in_plane.extend(1.0));
        for side in [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z] {
            let near = in_plane + self.ambient_reach_m * side;
            self.include_homogeneous(DVec4::new(near.x, 0.0, near.z, 1.0));
        }
        for k in 0..self.sources.len() {
            self.include_homogeneous(shadow_of(in_plane, self.sources[k]));
        }
    }

    /// The rectangle around all points, within the image; `None` when they are out of the picture.
    #[must_use]
    pub fn region(&self) -> Option<PixelRect> {
        let image_px = self.view.image_px;
        if self.is_endless {
            return Some(PixelRect {
                origin_px: UVec2::ZERO,
                size_px: image_px,
            });
        }
        let within = |px: DVec2| px.clamp(DVec2::ZERO, image_px.as_dvec2()).as_uvec2();
        let (min_px, max_px) = (within(self.min_px.floor()), within(self.max_px.ceil()));
        let size_px = max_px.saturating_sub(min_px);
        (size_px.min_element() > 0).then_some(PixelRect {
            origin_px: min_px,
            size_px,
        })
    }

    fn include_homogeneous(&mut self, in_plane: DVec4) {
        let at = self.view.image_px_from_plane(in_plane);
        if in_plane.w <= 0.0 || at.z <= NEAR_M * in_plane.w {
            self.is_endless = true;
            return;
        }
        self.min_px = self.min_px.min(at.truncate() / at.z);
        self.max_px = self.max_px.max(at.truncate() / at.z);
    }
}

/// Receiver, lights and where the lights' shares are stated.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    /// The plane that catches the shadow.
    pub receiver: &'a Receiver,
    /// At most four lights; further ones are left out.
    pub lights: &'a [Light],
    /// Inverse of the receiver's own transform.
    pub plane_from_world: &'a DMat4,
    /// The receiver under the toy, (x, z) in plane space.
    pub reference_in_plane: DVec2,
}

fn columns(m: DMat3) -> [[f32; 4]; 3] {
    m.as_mat3().to_cols_array_2d().map(|[x, y, z]| [x, y, z, 0.0])
}

/// Where the line from a homogeneous light through `p` meets y = 0, homogeneous; w is not positive where it does not.
fn shadow_of(p: DVec3, light: DVec4) -> DVec4 {
    let at = light.y * p - p.y * light.truncate();
    DVec4::new(at.x, 0.0, at.z, light.y - light.w * p.y)
}

impl PixelRect {
    /// Grown by `margin_px` on each side, as far as the image goes.
    #[must_use]
    pub fn grown(&self, margin_px: u32, image_px: UVec2) -> Self {
        let origin_px = self.origin_px.saturating_sub(UVec2::splat(margin_px));
        let end_px = (self.origin_px + self.size_px + margin_px).min(image_px);
        Self {
            origin_px,
            size_px: end_px - origin_px,
        }
    }

    /// Whether all of `other` lies within.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        self.origin_px.cmple(other.origin_px).all()
            && (self.origin_px + self.size_px)
                .cmpge(other.origin_px + other.size_px)
                .all()
    }
}

impl View {
    /// Widest penumbra that a toy within `toy` casts from `light`, in pixels at the toy's distance.
    ///
    /// An edge at height h, at distance D from a disc of radius R that is a height d over the receiver, makes a
    /// penumbra of 2 R h D / (d - h)^2 along the light; a far disc of half-angle b at elevation e one of
    /// 2 h tan b / sin^2 e.
    #[must_use]
    pub fn penumbra_px(&self, light: &Light, plane_from_world: &DMat4, toy: &Bounds) -> f64 {
        let centre = toy.centre();
        let height_m = toy.max.y.max(0.0);
        let light_at = light_in_plane(light, plane_from_world);
        let width_m = match *light {
            Light::Sphere { radius_m, .. } => {
                let above_toy_m = light_at.y - height_m;
                // A light no higher than the toy has no end of its penumbra.
                if above_toy_m <= 0.0 {
                    return if radius_m > 0.0 { f64::INFINITY } else { 0.0 };
                }
                let distance_m = light_at
                    .truncate()
                    .distance(DVec3::new(centre.x, height_m, centre.z));
                2.0 * radius_m * height_m * distance_m / (above_toy_m * above_toy_m)
            }
            Light::Directional {
                angular_radius_rad, ..
            } => 2.0 * height_m * angular_radius_rad.tan() / (light_at.y * light_at.y),
        };
        let depth_m = self.image_px_from_plane(centre.extend(1.0)).z.max(NEAR_M);
        width_m * self.intrinsics.fx_px.max(self.intrinsics.fy_px) / depth_m
    }
}
