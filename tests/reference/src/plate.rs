//! CPU reference of `plate.wgsl`: the plate of this camera, from plates of other cameras.

use glam::{DVec2, DVec3, DVec4, IVec2, UVec2};

use super::model::{ReceiverPoint, Region, centre_px};
use super::raster::Raster;
use super::reflection::Reflection;

/// Distance from a plate's border, in pixels, over which it is blended with another one.
const FEATHER_PX: f64 = 32.0;
/// Power of the cosine between two viewing directions in a plate's quality.
const ANGLE_POWER: f64 = 4.0;
/// Power of the quality in a plate's weight: high, so that two are hardly ever mixed, which would
/// blur.
pub const CHOICE_POWER: f64 = 6.0;
/// Lower bound of that cosine: such a plate may be the only one.
const LEAST_COSINE: f64 = 0.1;
/// Weight relative to the best plate's below which another is skipped.
const LEAST_WEIGHT: f64 = 0.02;
/// Step of the difference quotient for a plate's resolution.
const STEP_PX: f64 = 1e-3;
/// Relative difference of depths by rounding.
const SAME_DEPTH: f64 = 1e-9;

/// A camera with the receivers in its view, and its position.
#[derive(Clone, Debug)]
pub struct Viewpoint {
    /// Its picture, or a part of it.
    pub region: Region,
    /// Its centre.
    pub centre_in_anchor: DVec3,
}

/// A plate.
#[derive(Clone, Debug)]
pub struct PlatePhoto {
    /// Its camera, with all of its picture as the region.
    pub camera: Viewpoint,
    /// Linear colours.
    pub picture: Raster<DVec3>,
    /// Factor to the exposure of the first plate.
    pub gain: DVec3,
}

impl Viewpoint {
    /// The camera's centre in the space of a receiver.
    fn centre_in(&self, receiver: usize) -> DVec3 {
        self.region.receivers[receiver]
            .plane_from_anchor
            .transform_point3(self.centre_in_anchor)
    }

    /// The surface at a pixel, front or back of a receiver; beyond all of them the first one's
    /// infinite plane.
    fn surface_point(&self, region_px: DVec2) -> Option<ReceiverPoint> {
        let beyond = || {
            let in_plane = self.region.receivers[0].plane_point(region_px)?;
            Some(ReceiverPoint {
                receiver: 0,
                in_plane,
            })
        };
        self.region.surface_point(region_px).or_else(beyond)
    }

    /// The image of a point; `None` if the camera sees its back, or another receiver is nearer
    /// there.
    fn sees(&self, point: ReceiverPoint) -> Option<DVec2> {
        let inverse_depth = |receiver: usize, px: DVec2| {
            (self.region.receivers[receiver].plane_from_region_px * px.extend(1.0)).z
        };
        let px = self.region.plane_of(point).region_px(point.in_plane)?;
        let own = inverse_depth(point.receiver, px);
        let is_free = self.region.surface_point(px).is_none_or(|nearest| {
            nearest.receiver == point.receiver
                || inverse_depth(nearest.receiver, px) <= own * (1.0 + SAME_DEPTH)
        });
        is_free.then_some(px)
    }
}

/// Linear colour of the plate at `texel` of the view's region, alpha 1 if one of `plates` shows it.
///
/// A plate's quality is its pixels per pixel of the view, by area and at most one, times a power of
/// the cosine between the two viewing directions. Its weight is a power of that relative to the
/// best one's, reduced towards its border.
#[must_use]
pub fn choose(view: &Viewpoint, plates: &[PlatePhoto], texel: UVec2) -> DVec4 {
    let at = centre_px(texel);
    let Some(point) = view.surface_point(at) else {
        return DVec4::ZERO;
    };
    let shown: Vec<Candidate<'_>> = plates
        .iter()
        .filter_map(|plate| candidate(view, plate, (at, point)))
        .collect();
    let best_quality = shown.iter().fold(0.0, |best: f64, one| best.max(one.quality));
    let weight = |one: &Candidate<'_>| one.inside * (one.quality / best_quality).powf(CHOICE_POWER);
    let best_weight = shown.iter().map(weight).fold(0.0, f64::max);
    let mut sum = DVec4::ZERO;
    for one in &shown {
        let weight = weight(one);
        if weight >= LEAST_WEIGHT * best_weight {
            let color = one.plate.gain * sharp(&one.plate.picture, one.px);
            let color = (color - reflected(view, &one.plate.camera, at)).max(DVec3::ZERO);
            sum += weight * color.extend(1.0);
        }
    }
    if shown.is_empty() {
        DVec4::ZERO
    } else {
        sum / sum.w
    }
}

/// Surroundings that a point of a glossy receiver, seen at a place of the view, reflects to another
/// camera.
fn reflected(view: &Viewpoint, camera: &Viewpoint, at: DVec2) -> DVec3 {
    let Some((reflection, point)) = view.region.reflection.zip(view.region.receiver_point(at)) else {
        return DVec3::ZERO;
    };
    let to_camera = Reflection {
        eye_in_plane: camera.centre_in(0),
        ..reflection
    };
    to_camera.light(point, DVec4::ONE, 1.0)
}

/// A plate that shows a point, and the point's image.
struct Candidate<'a> {
    plate: &'a PlatePhoto,
    px: DVec2,
    quality: f64,
    /// 1 away from its border.
    inside: f64,
}

fn candidate<'a>(
    view: &Viewpoint,
    plate: &'a PlatePhoto,
    (at, point): (DVec2, ReceiverPoint),
) -> Option<Candidate<'a>> {
    let receiver = point.receiver;
    let (own, other) = (view.centre_in(receiver), plate.camera.centre_in(receiver));
    // Front and back are different surfaces.
    let is_same_side = own.y * other.y > 0.0;
    let px = plate.camera.sees(point).filter(|_| is_same_side)?;
    let border_px = px.min(plate.picture.size().as_dvec2() - px).min_element();
    let inside = (border_px / FEATHER_PX).clamp(0.0, 1.0);
    let plate_px = |at: DVec2| {
        let in_plane = view.region.receivers[receiver].plane_point(at)?;
        plate.camera.region.receivers[receiver].region_px(in_plane)
    };
    let across = plate_px(at + STEP_PX * DVec2::X)? - plate_px(at - STEP_PX * DVec2::X)?;
    let along = plate_px(at + STEP_PX * DVec2::Y)? - plate_px(at - STEP_PX * DVec2::Y)?;
    let magnification = across.perp_dot(along).abs() / (2.0 * STEP_PX).powi(2);
    let there = DVec3::new(point.in_plane.x, 0.0, point.in_plane.y);
    let cosine = (own - there).normalize().dot((other - there).normalize());
    let quality = magnification.min(1.0) * cosine.max(LEAST_COSINE).powf(ANGLE_POWER);
    (inside > 0.0).then_some(Candidate {
        plate,
        px,
        quality,
        inside,
    })
}

/// Catmull-Rom interpolation of a picture; not negative. Source: Catmull and Rom 1974.
fn sharp(picture: &Raster<DVec3>, px: DVec2) -> DVec3 {
    let low = (px - 0.5).floor();
    let t = px - 0.5 - low;
    let last = picture.size().as_ivec2() - 1;
    let texel = |x: i32, y: i32| {
        let at = low.as_ivec2() + IVec2::new(x, y);
        picture.at(at.clamp(IVec2::ZERO, last).as_uvec2())
    };
    let row = |y: i32| hermite([-1, 0, 1, 2].map(|x| texel(x, y)), t.x);
    hermite([-1, 0, 1, 2].map(row), t.y).max(DVec3::ZERO)
}

/// From the second to the third of four values, with the slopes of the adjacent chords.
fn hermite([before, from, to, after]: [DVec3; 4], t: f64) -> DVec3 {
    let (leaving, arriving) = (0.5 * (to - before), 0.5 * (after - from));
    let (s, c) = (t * t, t * t * t);
    (2.0 * c - 3.0 * s + 1.0) * from
        + (c - 2.0 * s + t) * leaving
        + (3.0 * s - 2.0 * c) * to
        + (c - s) * arriving
}
