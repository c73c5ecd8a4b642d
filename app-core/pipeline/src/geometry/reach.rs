//! The work region: the rectangle of the camera image that toy and shadows can reach.
//!
//! Homographies map its pixels to receiver points, so passes that draw in a receiver's plane draw straight onto the
//! pixels that show it: texel and pixel coincide, and an edge in the plane is as sharp as the screen allows.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DMat4, DVec2, DVec3, DVec4};

use crate::geometry::extent::Extent;
use crate::geometry::rect::{PixelRect, PlaneRect};
use crate::geometry::scene_layout::SceneLayout;
use crate::geometry::view::View;
use app_scene::geometry::bounds::Bounds;
use app_scene::reflection::{N_MIRRORED_EYES, Reflection};

/// Occlusion of ambient light by the toy counts out to this many toy heights from its footprint.
const AMBIENT_REACH_HEIGHTS: f64 = 0.5;
/// Scene state of a receiver is kept out to this many toy sizes from the toy: a low light's shadow is unbounded.
const KEPT_REACH_SIZES: f64 = 6.0;

/// Extent of a toy and its shadows in the picture and on the receivers, grown point by point.
#[derive(Clone, Debug)]
pub struct Reach<'a> {
    view: &'a View,
    world_from_anchor: DMat4,
    planes: Vec<PlaneReach>,
    /// Eyes behind the first receiver that see the toy reflected, homogeneous in anchor space;
    /// empty if the receiver is matt.
    mirrored_eyes: Vec<DVec4>,
    /// Radius around the toy's footprint within which it occludes ambient light.
    ambient_reach_m: f64,
    /// Extent in the picture.
    extent: Extent,
    /// Extent of the toy alone.
    toy: Extent,
    /// Widest penumbra of each light in the picture.
    penumbrae_px: Vec<f64>,
}

/// The extent on one receiver, in its plane.
#[derive(Clone, Debug)]
struct PlaneReach {
    world_from_plane: DMat4,
    plane_from_anchor: DMat4,
    /// Extent of the receiver itself.
    receiver: PlaneRect,
    /// False for a receiver that is seen from behind: it changes nothing in the picture.
    is_seen: bool,
    /// Corners of the square around each light's disc: their shadows bound those of the whole light.
    lights: Vec<[DVec4; 4]>,
    rect: PlaneRect,
    kept: PlaneRect,
}

impl<'a> Reach<'a> {
    /// Starts empty, for a toy within `toy`, in anchor space.
    #[must_use]
    pub fn new(view: &'a View, toy: &Bounds, layout: &SceneLayout<'_>) -> Self {
        let world_from_anchor = layout.world_from_anchor();
        let kept_m = KEPT_REACH_SIZES * (toy.max - toy.min).max_element();
        let planes = layout.receivers.iter().map(|receiver| {
            let plane_from_world = receiver.world_from_plane.inverse();
            let plane_from_anchor = plane_from_world * world_from_anchor;
            let target = plane_from_anchor.transform_point3(toy.centre());
            let middle = DVec2::new(target.x, target.z);
            let lights = layout.lights.iter();
            let corners = lights.map(|light| light.corners_in(&plane_from_world, target));
            PlaneReach {
                world_from_plane: receiver.world_from_plane,
                plane_from_anchor,
                receiver: receiver.rect,
                is_seen: view.sees_front_of(&receiver.world_from_plane),
                lights: corners.collect(),
                rect: PlaneRect {
                    min: DVec2::INFINITY,
                    max: DVec2::NEG_INFINITY,
                },
                kept: PlaneRect {
                    min: receiver.rect.nearest(middle - kept_m),
                    max: receiver.rect.nearest(middle + kept_m),
                },
            }
        });
        Self {
            view,
            world_from_anchor,
            planes: planes.collect(),
            mirrored_eyes: Vec::new(),
            ambient_reach_m: AMBIENT_REACH_HEIGHTS * toy.max.y.max(0.0),
            extent: Extent::EMPTY,
            toy: Extent::EMPTY,
            penumbrae_px: vec![0.0; layout.lights.len()],
        }
    }

    /// Includes the toy's image in the first receiver, for a toy with the given centre. Only the
    /// inner part of the lobe counts, beyond which the image fades.
    #[must_use]
    pub fn with_reflection(mut self, reflection: Option<&Reflection>, toy_in_anchor: DVec3) -> Self {
        let eye = self.view.camera_in(&self.world_from_anchor);
        let eyes = reflection.map(|reflection| reflection.mirrored_eyes(eye, toy_in_anchor.with_y(0.0)));
        self.mirrored_eyes = eyes.map_or(Vec::new(), |eyes| {
            eyes.into_iter()
                .take(3 * N_MIRRORED_EYES / 4)
                .step_by(2)
                .collect()
        });
        self
    }

    /// Includes a point of the toy, in anchor space, its shadows and the receivers near it.
    pub fn include(&mut self, in_anchor: DVec3) {
        self.include_image(in_anchor.with_y(in_anchor.y.max(0.0)));
        let at = self
            .view
            .image_px_from(&self.world_from_anchor, in_anchor.extend(1.0));
        self.extent.include(at);
        self.toy.include(at);
        for k in 0..self.planes.len() {
            let in_plane = self.planes[k].plane_from_anchor.transform_point3(in_anchor);
            // A wall far from the toy keeps its ambient light.
            if k == 0 || in_plane.y < 2.0 * self.ambient_reach_m {
                for side in [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y] {
                    let near = DVec2::new(in_plane.x, in_plane.z) + self.ambient_reach_m * side;
                    self.include_on(k, near);
                }
            }
            let on_receiver = in_plane.with_y(in_plane.y.max(0.0));
            for light in 0..self.penumbrae_px.len() {
                self.include_shadow(k, on_receiver, light);
            }
        }
    }

    /// The rectangle around all points, within the image; `None` if they are out of the picture.
    #[must_use]
    pub fn region(&self) -> Option<PixelRect> {
        self.extent.rect(self.view.image_px)
    }

    /// The rectangle around the points of the toy, within the image; `None` if they are out of the
    /// picture.
    #[must_use]
    pub fn toy(&self) -> Option<PixelRect> {
        self.toy.rect(self.view.image_px)
    }

    /// Width in pixels of each light's widest penumbra; infinite if a shadow is unbounded.
    #[must_use]
    pub fn penumbrae_px(&self) -> &[f64] {
        &self.penumbrae_px
    }

    /// Extent of toy and shadows on each receiver, within the rectangle that is kept.
    #[must_use]
    pub fn plane_rects(&self) -> Vec<PlaneRect> {
        self.planes.iter().map(|plane| plane.rect).collect()
    }

    /// Includes the image of a point that is not under the first receiver.
    fn include_image(&mut self, in_anchor: DVec3) {
        for index in 0..self.mirrored_eyes.len() {
            let image = shadow_of(in_anchor, self.mirrored_eyes[index]);
            if image.z > 0.0 {
                self.include_on(0, image.truncate() / image.z);
            }
        }
    }

    /// Includes the shadow of a point that is not under receiver `k`, and its penumbra.
    fn include_shadow(&mut self, k: usize, in_plane: DVec3, light: usize) {
        let corners = self.planes[k].lights[light];
        for corner in corners.into_iter().filter(|corner| corner.y > 0.0) {
            let shadow = shadow_of(in_plane, corner);
            if shadow.z > 0.0 {
                self.include_on(k, shadow.truncate() / shadow.z);
                continue;
            }
            // A light no higher than the point casts a shadow as far as the receiver goes.
            for end in self.planes[k].receiver.corners() {
                self.include_on(k, end);
            }
        }
        if self.planes[k].is_seen {
            let width_px = self.planes[k].penumbra_px(self.view, in_plane, corners);
            self.penumbrae_px[light] = self.penumbrae_px[light].max(width_px);
        }
    }

    fn include_on(&mut self, k: usize, in_plane: DVec2) {
        let plane = &mut self.planes[k];
        let on_receiver = plane.receiver.nearest(in_plane);
        let kept = plane.kept.nearest(on_receiver);
        plane.rect.min = plane.rect.min.min(kept);
        plane.rect.max = plane.rect.max.max(kept);
        if !plane.is_seen {
            return;
        }
        let at = DVec4::new(on_receiver.x, 0.0, on_receiver.y, 1.0);
        let px = self.view.image_px_from(&plane.world_from_plane, at);
        self.extent.include(px);
    }
}

/// Intersection of the plane y = 0 with the line from a homogeneous light through `p`, as (x, z,
/// w). w is not positive if there is none.
pub(crate) fn shadow_of(p: DVec3, light: DVec4) -> DVec3 {
    let at = light.y * p - p.y * light.truncate();
    DVec3::new(at.x, at.z, light.y - light.w * p.y)
}

impl PlaneReach {
    /// Width in the picture of the shadow edge that a point casts: the largest distance between
    /// shadows from opposite corners around the light, relative to the distance of the corners.
    /// Infinite if one is unbounded, or behind the camera.
    fn penumbra_px(&self, view: &View, in_plane: DVec3, [a, b, c, d]: [DVec4; 4]) -> f64 {
        let seen_at = |light: DVec4| {
            let shadow = shadow_of(in_plane, light);
            if light.y <= 0.0 || shadow.z <= 0.0 {
                return None;
            }
            let at = self.receiver.nearest(shadow.truncate() / shadow.z);
            let px = view.image_px_from(&self.world_from_plane, DVec4::new(at.x, 0.0, at.y, 1.0));
            (px.z > 0.0).then(|| px.truncate() / px.z)
        };
        let apart = |one, other| Some(seen_at(one)?.distance(seen_at(other)?));
        apart(a, d)
            .zip(apart(b, c))
            .map_or(f64::INFINITY, |(one, other)| FRAC_1_SQRT_2 * one.max(other))
    }
}

impl View {
    /// The rectangle that a toy within `toy`, in anchor space, and its shadows can reach, or `None`
    /// if it is out of the picture.
    #[must_use]
    pub fn region(&self, toy: &Bounds, layout: &SceneLayout<'_>) -> Option<PixelRect> {
        let mut reach = Reach::new(self, toy, layout);
        toy.corners().for_each(|corner| reach.include(corner));
        reach.region()
    }
}
