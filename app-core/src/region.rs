//! The work region: the rectangle of the camera image that toy and shadows can reach.
//!
//! Its pixels are receiver points through homographies, so passes that draw in a receiver's plane draw straight onto
//! the pixels that show it: texel and pixel coincide, and an edge in the plane is as sharp as the screen allows.

use glam::{DMat4, DVec2, DVec3, DVec4, UVec2};

use crate::light_points::light_corners;
use crate::view::{NEAR_M, Place, View};

/// The ambient light that the toy takes away counts out to this many toy heights from its footprint.
const AMBIENT_REACH_HEIGHTS: f64 = 0.5;
/// What is known of a receiver is kept out to this many toy sizes from the toy: a low light's shadow has no end.
const KEPT_REACH_SIZES: f64 = 6.0;
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

    /// A rectangle of `size_px` within the image that holds this one, which is no larger, as near its middle as can be.
    #[must_use]
    pub fn within(&self, size_px: UVec2, image_px: UVec2) -> Self {
        let spare_px = size_px.saturating_sub(self.size_px) / 2;
        let last_px = image_px.saturating_sub(size_px);
        Self {
            origin_px: self.origin_px.saturating_sub(spare_px).min(last_px),
            size_px,
        }
    }
}

/// A box in a space of metres.
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

    /// The box around points; inside out when there is none.
    #[must_use]
    pub fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let nothing = Self {
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
        };
        points.fold(nothing, |bounds, p| Self {
            min: bounds.min.min(p),
            max: bounds.max.max(p),
        })
    }

    /// The box around this one in another space.
    #[must_use]
    pub fn transformed(&self, there_from_here: &DMat4) -> Self {
        Self::around(self.corners().map(|p| there_from_here.transform_point3(p)))
    }
}

/// A rectangle of a receiver's plane, (x, z) in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneRect {
    /// Smallest coordinates.
    pub min: DVec2,
    /// Largest coordinates.
    pub max: DVec2,
}

/// Grows around what a toy and its shadows reach in the picture and on the receivers, point by point.
#[derive(Clone, Debug)]
pub struct Reach<'a> {
    view: &'a View,
    world_from_stage: DMat4,
    planes: Vec<PlaneReach>,
    /// How far around its footprint the toy takes ambient light away.
    ambient_reach_m: f64,
    min_px: DVec2,
    max_px: DVec2,
    /// A point behind the camera: the rectangle has no bound.
    is_endless: bool,
}

/// The same on one receiver.
#[derive(Clone, Debug)]
struct PlaneReach {
    world_from_plane: DMat4,
    plane_from_stage: DMat4,
    half_extent_m: DVec2,
    /// What is reached on a receiver that is seen from behind changes nothing in the picture.
    is_seen: bool,
    /// Corners of each light's disc, boxed: their shadows bound those of the whole light.
    sources: Vec<DVec4>,
    rect: PlaneRect,
    kept: PlaneRect,
}

impl<'a> Reach<'a> {
    /// Starts empty, for a toy within `toy`, in stage space.
    #[must_use]
    pub fn new(view: &'a View, toy: &Bounds, place: &Place<'_>) -> Self {
        let world_from_stage = place.world_from_stage();
        let kept_m = KEPT_REACH_SIZES * (toy.max - toy.min).max_element();
        let planes = place.receivers.iter().map(|receiver| {
            let plane_from_world = receiver.world_from_plane.inverse();
            let plane_from_stage = plane_from_world * world_from_stage;
            let target = plane_from_stage.transform_point3(toy.centre());
            let middle = DVec2::new(target.x, target.z);
            let lights = place.lights.iter();
            let corners = lights.flat_map(|light| light_corners(light, &plane_from_world, target));
            let half_extent_m = receiver.half_extent_m;
            PlaneReach {
                world_from_plane: receiver.world_from_plane,
                plane_from_stage,
                half_extent_m,
                is_seen: view.sees_front_of(receiver),
                sources: corners.filter(|source| source.y > 0.0).collect(),
                rect: PlaneRect {
                    min: DVec2::INFINITY,
                    max: DVec2::NEG_INFINITY,
                },
                kept: PlaneRect {
                    min: (middle - kept_m).clamp(-half_extent_m, half_extent_m),
                    max: (middle + kept_m).clamp(-half_extent_m, half_extent_m),
                },
            }
        });
        Self {
            view,
            world_from_stage,
            planes: planes.collect(),
            ambient_reach_m: AMBIENT_REACH_HEIGHTS * toy.max.y.max(0.0),
            min_px: DVec2::INFINITY,
            max_px: DVec2::NEG_INFINITY,
            is_endless: false,
        }
    }

    /// Takes in a point of the toy, in stage space, its shadows and the receivers near it.
    pub fn include(&mut self, in_stage: DVec3) {
        self.include_px(
            self.view
                .image_px_from(&self.world_from_stage, in_stage.extend(1.0)),
        );
        for k in 0..self.planes.len() {
            let in_plane = self.planes[k].plane_from_stage.transform_point3(in_stage);
            // A wall far from the toy keeps its ambient light.
            if k == 0 || in_plane.y < 2.0 * self.ambient_reach_m {
                for side in [DVec2::X, DVec2::NEG_X, DVec2::Y, DVec2::NEG_Y] {
                    let near = DVec2::new(in_plane.x, in_plane.z) + self.ambient_reach_m * side;
                    self.include_on(k, near);
                }
            }
            for source in 0..self.planes[k].sources.len() {
                self.include_shadow(k, in_plane, self.planes[k].sources[source]);
            }
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

    /// What toy and shadows reach of each receiver, as far as it is kept.
    #[must_use]
    pub fn plane_rects(&self) -> Vec<PlaneRect> {
        self.planes.iter().map(|plane| plane.rect).collect()
    }

    /// The shadow of a point over receiver `k`; what lies under it casts none.
    fn include_shadow(&mut self, k: usize, in_plane: DVec3, source: DVec4) {
        let shadow = shadow_of(in_plane.with_y(in_plane.y.max(0.0)), source);
        if shadow.z > 0.0 {
            self.include_on(k, shadow.truncate() / shadow.z);
            return;
        }
        // A light no higher than the point casts a shadow as far as the receiver goes.
        let end = self.planes[k].half_extent_m;
        for corner in [end, -end, DVec2::new(end.x, -end.y), DVec2::new(-end.x, end.y)] {
            self.include_on(k, corner);
        }
    }

    fn include_on(&mut self, k: usize, in_plane: DVec2) {
        let plane = &mut self.planes[k];
        let on_receiver = in_plane.clamp(-plane.half_extent_m, plane.half_extent_m);
        let kept = on_receiver.clamp(plane.kept.min, plane.kept.max);
        plane.rect.min = plane.rect.min.min(kept);
        plane.rect.max = plane.rect.max.max(kept);
        if !plane.is_seen {
            return;
        }
        let at = DVec4::new(on_receiver.x, 0.0, on_receiver.y, 1.0);
        let px = self.view.image_px_from(&plane.world_from_plane, at);
        self.include_px(px);
    }

    fn include_px(&mut self, at: DVec3) {
        if at.z <= NEAR_M {
            self.is_endless = true;
            return;
        }
        self.min_px = self.min_px.min(at.truncate() / at.z);
        self.max_px = self.max_px.max(at.truncate() / at.z);
    }
}

/// Where the line from a homogeneous light through `p` meets y = 0, as (x, z, w); w is not positive where it does not.
fn shadow_of(p: DVec3, light: DVec4) -> DVec3 {
    let at = light.y * p - p.y * light.truncate();
    DVec3::new(at.x, at.z, light.y - light.w * p.y)
}

impl View {
    /// The rectangle that a toy within `toy`, in stage space, and its shadows can reach, or `None` when it is out of the
    /// picture.
    #[must_use]
    pub fn region(&self, toy: &Bounds, place: &Place<'_>) -> Option<PixelRect> {
        let mut reach = Reach::new(self, toy, place);
        toy.corners().for_each(|corner| reach.include(corner));
        reach.region()
    }
}
