//! Common data of all passes, the model of the receiver, and the reliability of pixel values: CPU
//! reference of `common/globals.wgsl`, `common/model.wgsl` and `common/pixel.wgsl`.

use app_pipeline::geometry::rect::{PixelRect, PlaneRect};
use app_pipeline::geometry::scene_layout::SceneLayout;
use app_pipeline::geometry::view::View;
use app_scene::scene::Light;
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, UVec2};

use super::raster::Raster;
use super::reflection::Reflection;

/// Linear value of the 8-bit code 10: darker ones are mostly quantisation.
pub(super) const DARKEST_USABLE: f64 = 0.003_035_27;
/// Linear value of the 8-bit code 250: brighter ones may be clipped.
pub(super) const BRIGHTEST_USABLE: f64 = 0.955_973_35;

/// Width of the fade at an edge of the region within the picture, in pixels.
const BORDER_PX: f64 = 24.0;
/// Weight of a pixel that may be clipped in both pictures.
const CLIPPED_WEIGHT: f64 = 1e-3;

/// The work region over the receivers, and the lights.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// The planes that catch shadows.
    pub receivers: Vec<ReceiverPlane>,
    /// Size of the region, in pixels.
    pub size_px: UVec2,
    /// Width of the fade at the left, top, right and bottom edge, in pixels; 0 for none.
    pub border_px: [f64; 4],
    /// Homogeneous, in anchor space: (position, 1) or (unit direction to the light, 0).
    pub lights: Vec<DVec4>,
    /// Radius of each light's disc: in metres for a sphere, a slope for a direction.
    pub light_radii: Vec<f64>,
    /// Reflection of the first receiver; `None` if it is matt.
    pub reflection: Option<Reflection>,
}

/// Width of the fade at each edge of a part of a picture, as in [`Region::border_px`].
fn border_px(rect: &PixelRect, image_px: UVec2) -> [f64; 4] {
    let (first, end) = (rect.origin_px, rect.origin_px + rect.size_px);
    let is_inner = [first.x > 0, first.y > 0, end.x < image_px.x, end.y < image_px.y];
    is_inner.map(|is_inner| if is_inner { BORDER_PX } else { 0.0 })
}

/// One receiver as the camera sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceiverPlane {
    /// From anchor space.
    pub plane_from_anchor: DMat4,
    /// From (u, v, 1) in pixels of the region to (x, z, w) on the receiver; w > 0 in front of the camera.
    pub plane_from_region_px: DMat3,
    /// The lights in plane space, homogeneous.
    pub lights: Vec<DVec4>,
    /// Reference point of the lights' shares, (x, z) in plane space.
    pub reference_in_plane: DVec2,
    /// Extent of the receiver.
    pub rect: PlaneRect,
}

/// A point of a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReceiverPoint {
    /// Index of the receiver.
    pub receiver: usize,
    /// (x, z) in its plane space.
    pub in_plane: DVec2,
}

/// The corners of a rectangle, around it.
fn corners_of(PlaneRect { min, max }: &PlaneRect) -> [DVec2; 4] {
    [*min, DVec2::new(max.x, min.y), *max, DVec2::new(min.x, max.y)]
}

/// How dark the faces below the edges of a top are, from each corner to the next: 1 if a light meets
/// one.
fn darkness_of_faces(top: &ReceiverPlane) -> [f64; 4] {
    let corners = corners_of(&top.rect);
    [0, 1, 2, 3].map(|index| {
        let (a, b) = (corners[index], corners[(index + 1) % 4]);
        let outwards = DVec2::new(b.y - a.y, a.x - b.x);
        let meets =
            |light: &DVec4| outwards.dot(DVec2::new(light.x, light.z) - light.w * 0.5 * (a + b)) > 0.0;
        if top.lights.iter().any(meets) { 1.0 } else { 0.75 }
    })
}

/// Part of the sky that the faces below a rectangle's edges, so dark, hide from a point.
fn hidden_sky(at: DVec2, own_from_rect: &DMat4, rect: &PlaneRect, darkness: [f64; 4]) -> f64 {
    const N_AZIMUTHS: u32 = 200;
    let seen =
        |x: f64, z: f64| own_from_rect.transform_point3(DVec3::new(x, 0.0, z)) - DVec3::new(at.x, 0.0, at.y);
    let corners = corners_of(rect).map(|corner| seen(corner.x, corner.y));
    let middle = corners.into_iter().sum::<DVec3>() / 4.0;
    let turn = |a: DVec3, b: DVec3| a.x * b.z - a.z * b.x;
    let mut hidden = 0.0;
    for (index, a) in corners.iter().copied().enumerate() {
        let b = corners[(index + 1) % 4];
        if turn(a, b) * turn(a - middle, b - middle) >= 0.0 {
            continue;
        }
        let [a, b] = [a, b].map(|end| DVec3::new(end.x, end.y.max(0.0), end.z));
        let (from, mut over) = (a.z.atan2(a.x), b.z.atan2(b.x) - a.z.atan2(a.x));
        over -= std::f64::consts::TAU * (over / std::f64::consts::TAU).round();
        for step in 0..N_AZIMUTHS {
            let azimuth = from + over * (f64::from(step) + 0.5) / f64::from(N_AZIMUTHS);
            let along = DVec3::new(azimuth.cos(), 0.0, azimuth.sin());
            let part = turn(a, along) / (turn(a, along) - turn(b, along));
            let edge = a.lerp(b, part);
            let sine = edge.normalize().y;
            hidden +=
                darkness[index] * sine * sine * over.abs() / f64::from(N_AZIMUTHS) / std::f64::consts::TAU;
        }
    }
    hidden
}

/// Least part of the sky.
const LEAST_SKY: f64 = 0.02;
/// Least radius of a light's disc, projected onto a top.
const SHARPEST_M: f64 = 5e-4;

/// Area of the unit disc below a line at `height`, over that of the disc.
fn segment(height: f64) -> f64 {
    let angle = height.clamp(-1.0, 1.0).acos();
    1.0 - (angle - angle.sin() * angle.cos()) / std::f64::consts::PI
}

impl ReceiverPlane {
    /// The point of the infinite plane, (x, z) in metres, at `region_px`.
    #[must_use]
    pub fn plane_point(&self, region_px: DVec2) -> Option<DVec2> {
        let at = self.plane_from_region_px * region_px.extend(1.0);
        (at.z > 0.0).then(|| at.truncate() / at.z)
    }

    /// The image of a point of the plane.
    #[must_use]
    pub fn region_px(&self, in_plane: DVec2) -> Option<DVec2> {
        let at = self.plane_from_region_px.inverse() * in_plane.extend(1.0);
        (at.z > 0.0).then(|| at.truncate() / at.z)
    }

    /// Whether the camera is in front of the receiver: then x and z have the orientation of right
    /// and down in the picture.
    #[must_use]
    pub fn shows_front(&self) -> bool {
        self.plane_from_region_px.determinant() > 0.0
    }

    /// Irradiance of light `i` at a point over that at the reference point: cos / d^2; 0 from
    /// behind the receiver. Nothing is between them.
    fn open_falloff(&self, i: usize, in_plane: DVec2) -> f64 {
        let light = self.lights[i];
        if light.y <= 0.0 {
            return 0.0;
        }
        if light.w == 0.0 {
            return 1.0;
        }
        let irradiance = |at: DVec2| {
            let to_light = light.truncate() - DVec3::new(at.x, 0.0, at.y);
            to_light.normalize().y / to_light.length_squared()
        };
        irradiance(in_plane) / irradiance(self.reference_in_plane)
    }

    /// Whether the middle of another receiver is above this one.
    fn is_below_middle_of(&self, other: &Self) -> bool {
        let middle = 0.5 * (other.rect.min + other.rect.max);
        let in_anchor = other
            .plane_from_anchor
            .inverse()
            .transform_point3(DVec3::new(middle.x, 0.0, middle.y));
        let here = self.plane_from_anchor.transform_point3(in_anchor);
        !std::ptr::eq(self, other) && here.y > 0.0 && self.rect.holds(DVec2::new(here.x, here.z))
    }

    /// The part of light `i`, with a disc of a radius, that the receiver and what is below it hide
    /// from a point of its space: the larger of the part of the disc's shadow between its edges, and
    /// of the part to which the way, seen from above, enters it.
    #[must_use]
    pub fn hidden(&self, i: usize, [from, up]: [DVec3; 2], radius: f64) -> f64 {
        let light = self.lights[i];
        let to_light = light.truncate() - light.w * from;
        let is_below = from.y < 0.0 && light.y > 0.0;
        if !(is_below || from.y > 0.0 && light.y < 0.0) {
            return 0.0;
        }
        let part = from.y.abs() / to_light.y.abs();
        let seen = from + part * to_light;
        let above = from + up * (-from.y / up.y);
        let half = [to_light.x, to_light.z]
            .map(|to| (part * radius * to_light.y.hypot(to) / to_light.y.abs()).max(SHARPEST_M));
        let PlaneRect { min, max } = self.rect;
        let axes = [
            (above.x, seen.x, half[0], [min.x, max.x]),
            (above.z, seen.z, half[1], [min.y, max.y]),
        ];
        let on = axes.map(|(_, seen, half, [low, high])| {
            (segment((high - seen) / half) - segment((low - seen) / half)).max(0.0)
        });
        let is_beside = axes
            .iter()
            .any(|(above, _, _, [low, high])| above < low || above > high);
        let entered = axes.map(|(above, seen, half, [low, high])| match above {
            _ if above < low => segment((seen - low) / half),
            _ if above > high => segment((high - seen) / half),
            _ => f64::from(u8::from(is_beside)),
        });
        let between = self.between_corners(above, [seen, to_light], part * radius);
        let by_faces = f64::from(u8::from(is_below)) * entered[0] * entered[1] * between;
        (on[0] * on[1]).max(by_faces)
    }

    /// The part of a light's disc around `seen`, in the direction `to_light`, that is between the
    /// outermost corners of the receiver as seen from the point `above`.
    fn between_corners(&self, above: DVec3, [seen, to_light]: [DVec3; 2], radius: f64) -> f64 {
        let PlaneRect { min, max } = self.rect;
        let sides = [min.x, max.x].map(|x| {
            [min.y, max.y].map(|z| {
                let (x, z) = (x - above.x, z - above.z);
                let along = -z * to_light.x + x * to_light.z;
                let width = radius * x.hypot(z).hypot(along / to_light.y);
                let across = x * (seen.z - above.z) - z * (seen.x - above.x);
                across / width.max(SHARPEST_M * x.hypot(z))
            })
        });
        let sides = sides.as_flattened().iter().copied();
        let outer = [
            sides.clone().fold(f64::MIN, f64::max),
            -sides.fold(f64::MAX, f64::min),
        ];
        (segment(outer[0]) - segment(-outer[1])).max(0.0)
    }
}

impl Region {
    /// Irradiance of light `i` at a point over that at the reference point in the open: of the part
    /// that no top of a thing hides.
    #[must_use]
    pub fn falloff(&self, i: usize, point: ReceiverPoint) -> f64 {
        let own = self.plane_of(point);
        let from = DVec3::new(point.in_plane.x, 0.0, point.in_plane.y);
        let in_anchor = own.plane_from_anchor.inverse().transform_point3(from);
        let hidden = self.hidden_by_all(point.receiver, |_, plane| {
            let here = plane.plane_from_anchor.transform_point3(in_anchor);
            let in_anchor = own.plane_from_anchor.inverse().transform_vector3(DVec3::Y);
            let up = plane.plane_from_anchor.transform_vector3(in_anchor);
            plane.hidden(i, [here, up], self.light_radii[i])
        });
        own.open_falloff(i, point.in_plane) * (1.0 - hidden).max(0.0)
    }

    /// Part of the sky that the faces below other receivers leave at a point, by integration over
    /// azimuths: a face of elevation e hides sin^2 e.
    #[must_use]
    pub fn open_sky(&self, point: ReceiverPoint) -> f64 {
        let hidden = self.hidden_by_all(point.receiver, |own_from_top, top| {
            hidden_sky(point.in_plane, own_from_top, &top.rect, darkness_of_faces(top))
        });
        (1.0 - hidden).max(LEAST_SKY)
    }

    /// The part of a point's sky that the faces below one top hide by themselves, as black ones.
    #[must_use]
    pub fn sky_hidden_by(&self, top: &ReceiverPlane, point: ReceiverPoint) -> f64 {
        let own_from_anchor = self.plane_of(point).plane_from_anchor;
        let own_from_top = own_from_anchor * top.plane_from_anchor.inverse();
        hidden_sky(point.in_plane, &own_from_top, &top.rect, [1.0; 4])
    }

    /// What the tops of things on a receiver hide together: of what lies on another thing counts
    /// what that one leaves.
    fn hidden_by_all(&self, receiver: usize, hidden: impl Fn(&DMat4, &ReceiverPlane) -> f64) -> f64 {
        let tops: Vec<_> = self
            .tops(receiver)
            .map(|(own_from_top, top)| (top, hidden(&own_from_top, top)))
            .collect();
        let added = tops.iter().map(|(top, part)| {
            let below = tops.iter().filter(|(below, _)| below.is_below_middle_of(top));
            below
                .fold(*part, |left, (_, below)| left.min(part - below))
                .max(0.0)
        });
        added.sum()
    }

    /// The other receivers that are no walls of one, each with the matrix from its space.
    fn tops(&self, receiver: usize) -> impl Iterator<Item = (DMat4, &ReceiverPlane)> {
        let own_from_anchor = self.receivers[receiver].plane_from_anchor;
        let others = self.receivers.iter().enumerate();
        let others = others.filter(move |(index, _)| *index != receiver);
        let turned =
            others.map(move |(_, other)| (own_from_anchor * other.plane_from_anchor.inverse(), other));
        turned.filter(|(own_from_other, _)| own_from_other.y_axis.y >= 0.5)
    }

    /// The region `rect` of a camera's picture.
    #[must_use]
    pub fn new(view: &View, rect: &PixelRect, layout: &SceneLayout<'_>) -> Self {
        let world_from_anchor = layout.world_from_anchor();
        let lights_in = |space_from_world: &DMat4| {
            let lights = layout.lights.iter();
            lights.map(|light| light.centre_in(space_from_world)).collect()
        };
        let receivers = layout.receivers.iter().map(|receiver| {
            let plane_from_world = receiver.world_from_plane.inverse();
            let toy = (plane_from_world * world_from_anchor).transform_point3(layout.toy_in_anchor);
            ReceiverPlane {
                plane_from_anchor: plane_from_world * world_from_anchor,
                plane_from_region_px: view.plane_from_region_px(rect, &receiver.world_from_plane),
                lights: lights_in(&plane_from_world),
                reference_in_plane: receiver.rect.nearest(DVec2::new(toy.x, toy.z)),
                rect: receiver.rect,
            }
        });
        Self {
            receivers: receivers.collect(),
            size_px: rect.size_px,
            border_px: border_px(rect, view.image_px),
            lights: lights_in(&world_from_anchor.inverse()),
            light_radii: layout.lights.iter().map(Light::radius).collect(),
            reflection: None,
        }
    }

    /// Light that a receiver reflects at a point, over the gain.
    #[must_use]
    pub fn reflected(&self, point: ReceiverPoint, visibility: DVec4) -> DVec3 {
        let reflection = self.reflection.as_ref();
        reflection.map_or(DVec3::ZERO, |reflection| reflection.light(point, visibility, 1.0))
    }

    /// The nearest receiver at `region_px`, and its point; `None` if that is the receiver's back.
    #[must_use]
    pub fn receiver_point(&self, region_px: DVec2) -> Option<ReceiverPoint> {
        self.surface_point(region_px)
            .filter(|point| self.plane_of(*point).shows_front())
    }

    /// The nearest receiver at `region_px`, from either side, and its point.
    #[must_use]
    pub fn surface_point(&self, region_px: DVec2) -> Option<ReceiverPoint> {
        let hits = self.receivers.iter().enumerate().filter_map(|(receiver, plane)| {
            let in_plane = plane.plane_point(region_px)?;
            let inverse_depth = (plane.plane_from_region_px * region_px.extend(1.0)).z;
            plane
                .rect
                .holds(in_plane)
                .then_some((inverse_depth, ReceiverPoint { receiver, in_plane }))
        });
        hits.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, point)| point)
    }

    /// The receiver of a point.
    #[must_use]
    pub fn plane_of(&self, point: ReceiverPoint) -> &ReceiverPlane {
        &self.receivers[point.receiver]
    }
}

/// Parameters learned from the real shadow and the real toy, per colour channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Frame over plate at unchanged pixels.
    pub gain: DVec3,
    /// Each light's intensity over that in the plate.
    pub intensities: Vec<DVec3>,
    /// Parameters of each receiver.
    pub receivers: Vec<ReceiverSolution>,
    /// Radiance of the toy over base colour and gain: constant, vertical gradient, and one factor
    /// for each light at its intensity in the plate.
    pub toy: Vec<DVec3>,
}

/// Parameters of one receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceiverSolution {
    /// Light reflected by the toy, as a fraction of the ambient light that it blocks.
    pub bounce: DVec3,
    /// Each light's share of the plate's radiance at the reference point.
    pub direct_fractions: Vec<DVec3>,
    /// Fraction of the energy of the plate's column from pixels that are clipped in frame and
    /// plate.
    pub clipped: DVec3,
}

impl Solution {
    /// Plate's irradiance at a receiver point over that at the reference point, for uniform ambient
    /// light.
    #[must_use]
    pub fn plate_falloff(&self, region: &Region, point: ReceiverPoint) -> DVec3 {
        let direct_fractions = &self.receivers[point.receiver].direct_fractions;
        let direct: DVec3 = direct_fractions.iter().sum();
        let lit = direct_fractions.iter().enumerate();
        let lit = lit.map(|(i, direct_fraction)| *direct_fraction * region.falloff(i, point));
        (DVec3::ONE - direct) * region.open_sky(point) + lit.sum::<DVec3>()
    }

    /// A light's share of the plate's radiance at a point.
    #[must_use]
    pub fn light_fraction(&self, region: &Region, i: usize, point: ReceiverPoint) -> DVec3 {
        let falloff = region.falloff(i, point);
        let at_reference = self.receivers[point.receiver].direct_fractions[i];
        at_reference * falloff / self.plate_falloff(region, point)
    }

    /// A frame as a fraction of plate and gain, from the ambient visibility and that of each light.
    ///
    /// Written with the shares `f` at the point itself: A (1 - sum f) + bounce A (1 - A) + sum f level V; without any light
    /// A + bounce (1 - A).
    #[must_use]
    pub fn receiver_model(
        &self,
        region: &Region,
        point: ReceiverPoint,
        ambient: f64,
        visibility: DVec4,
    ) -> DVec3 {
        let bounce = self.receivers[point.receiver].bounce;
        let mut ratio = DVec3::splat(ambient) + bounce * bounced(ambient, self.intensities.len());
        for (i, intensity) in self.intensities.iter().enumerate() {
            let lit = *intensity * visibility[i];
            ratio += self.light_fraction(region, i, point) * (lit - ambient);
        }
        ratio
    }
}

/// Share of the toy's bounce at a point with that ambient visibility.
#[must_use]
pub fn bounced(ambient: f64, n_lights: usize) -> f64 {
    let hidden = 1.0 - ambient;
    if n_lights == 0 { hidden } else { ambient * hidden }
}

/// The passes' view of a frame, over the region. Colours are linear.
#[derive(Clone, Debug)]
pub struct Pictures {
    /// The camera's frame.
    pub frame: Raster<DVec3>,
    /// The place without the toy.
    pub plate: Raster<DVec3>,
    /// 1 if the frame shows the receiver alone.
    pub seen: Raster<f64>,
    /// Visibility of each light with the physical toy.
    pub visibility: Raster<DVec4>,
    /// Visibility of the ambient light with the physical toy, of any size.
    pub ambient: Raster<f64>,
}

/// The centre of a pixel.
#[must_use]
pub fn centre_px(texel: UVec2) -> DVec2 {
    texel.as_dvec2() + 0.5
}

/// The value of a coarse map of the whole region at `region_px`.
#[must_use]
pub fn coarse_at(map: &Raster<f64>, region: &Region, region_px: DVec2) -> f64 {
    map.bilinear(region_px * map.size().as_dvec2() / region.size_px.as_dvec2())
}

/// Whether both linear values may be clipped.
#[must_use]
pub fn is_clipped(a: f64, b: f64) -> bool {
    a.min(b) > BRIGHTEST_USABLE
}

/// Weight of a pixel of frame and plate as evidence about the light there, in one channel.
#[must_use]
pub fn evidence(frame: f64, plate: f64) -> f64 {
    if is_clipped(frame, plate) {
        CLIPPED_WEIGHT
    } else {
        usable(frame, plate)
    }
}

/// 1 if both linear values are reliable, else 0.
pub(super) fn usable(a: f64, b: f64) -> f64 {
    let is_within = |value: f64| (DARKEST_USABLE..=BRIGHTEST_USABLE).contains(&value);
    if is_within(a) && is_within(b) { 1.0 } else { 0.0 }
}
