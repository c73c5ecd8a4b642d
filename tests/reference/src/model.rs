//! Common data of all passes, the model of the receiver, and the reliability of pixel values: CPU
//! reference of `common/globals.wgsl`, `common/model.wgsl` and `common/pixel.wgsl`.

use app_pipeline::geometry::rect::{PixelRect, PlaneRect};
use app_pipeline::geometry::scene_layout::SceneLayout;
use app_pipeline::geometry::view::View;
use app_pipeline::passes::globals::globals;
use glam::{DMat3, DMat4, DVec2, DVec3, DVec4, UVec2};

use super::raster::Raster;
use super::reflection::Reflection;

/// Linear value of the 8-bit code 10: darker ones are mostly quantisation.
pub(super) const DARKEST_USABLE: f64 = 0.003_035_27;
/// Linear value of the 8-bit code 250: brighter ones may be clipped.
pub(super) const BRIGHTEST_USABLE: f64 = 0.955_973_35;

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
    /// Reflection of the first receiver; `None` if it is matt.
    pub reflection: Option<Reflection>,
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
    /// behind the receiver.
    #[must_use]
    pub fn falloff(&self, i: usize, in_plane: DVec2) -> f64 {
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
}

impl Region {
    /// The region `rect` of a camera's picture.
    #[must_use]
    pub fn new(view: &View, rect: &PixelRect, layout: &SceneLayout<'_>) -> Self {
        let globals = globals(view, rect, layout);
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
            border_px: globals.border_px.map(f64::from),
            lights: lights_in(&world_from_anchor.inverse()),
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
        let direct_fractions = self.receivers[point.receiver].direct_fractions.iter().enumerate();
        let plane = region.plane_of(point);
        let more = direct_fractions
            .map(|(i, direct_fraction)| *direct_fraction * (plane.falloff(i, point.in_plane) - 1.0));
        DVec3::ONE + more.sum::<DVec3>()
    }

    /// A light's share of the plate's radiance at a point.
    #[must_use]
    pub fn light_fraction(&self, region: &Region, i: usize, point: ReceiverPoint) -> DVec3 {
        let falloff = region.plane_of(point).falloff(i, point.in_plane);
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
