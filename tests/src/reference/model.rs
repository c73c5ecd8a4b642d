//! What every pass knows of the scene, and the model of the receiver: twin of `common/globals.wgsl` and
//! `common/model.wgsl`.

use app_core::light_points::light_in_plane;
use app_core::region::{PixelRect, Place, View};
use glam::{DMat3, DVec2, DVec3, DVec4, UVec2};

use super::raster::Raster;
use super::{ConstantError, shader_constant};

/// The work region over a receiver, and the lights.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// From (u, v, 1) in pixels of the region to (x, z, w) on the receiver; w > 0 in front of the camera.
    pub plane_from_region_px: DMat3,
    /// Size of the region, in pixels.
    pub size_px: UVec2,
    /// Width of the fade at the left, top, right and bottom edge, in pixels; 0 where there is none.
    pub border_px: [f64; 4],
    /// Homogeneous, in plane space: (position, 1) or (unit direction to the light, 0).
    pub lights: Vec<DVec4>,
    /// Where the lights' shares are stated, (x, z) in plane space.
    pub reference_in_plane: DVec2,
    /// The receiver ends at plus and minus this, in metres.
    pub half_extent_m: DVec2,
}

impl Region {
    /// The region `rect` of a camera's picture.
    #[must_use]
    pub fn new(view: &View, rect: &PixelRect, place: &Place<'_>) -> Self {
        Self {
            plane_from_region_px: view.plane_from_region_px(rect),
            size_px: rect.size_px,
            border_px: view.globals(rect, place).border_px.map(f64::from),
            lights: place
                .lights
                .iter()
                .map(|light| light_in_plane(light, place.plane_from_world))
                .collect(),
            reference_in_plane: place.reference_in_plane,
            half_extent_m: place.receiver.half_extent_m,
        }
    }

    /// The point of the endless plane, (x, z) in metres, that is seen at `region_px`.
    #[must_use]
    pub fn plane_point(&self, region_px: DVec2) -> Option<DVec2> {
        let at = self.plane_from_region_px * region_px.extend(1.0);
        (at.z > 0.0).then(|| at.truncate() / at.z)
    }

    /// The same, within the receiver.
    #[must_use]
    pub fn receiver_point(&self, region_px: DVec2) -> Option<DVec2> {
        self.plane_point(region_px)
            .filter(|at| at.abs().cmple(self.half_extent_m).all())
    }

    /// Irradiance of light `i` at a receiver point over that at the reference point: cos / d^2.
    #[must_use]
    pub fn falloff(&self, i: usize, in_plane: DVec2) -> f64 {
        let light = self.lights[i];
        if light.w == 0.0 {
            return 1.0;
        }
        let irradiance = |at: DVec2| {
            let to_light = light.truncate() - DVec3::new(at.x, 0.0, at.y);
            let cosine = to_light.normalize().y;
            cosine / to_light.length_squared()
        };
        irradiance(in_plane) / irradiance(self.reference_in_plane)
    }
}

/// What is learned from the real shadow and the real toy, per colour channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Frame over plate where nothing changed.
    pub gain: DVec3,
    /// Light thrown back by the toy, as a fraction of the ambient light it takes away.
    pub bounce: DVec3,
    /// Each light's share of the plate's radiance at the reference point.
    pub shares: Vec<DVec3>,
    /// Radiance of the toy over its base colour: constant, vertical gradient, and one factor per light's cosine.
    pub toy: Vec<DVec3>,
    /// Energy of the light columns over that of the plate.
    pub contrast: DVec3,
}

impl Solution {
    /// Plate's irradiance at a receiver point over that at the reference point, were the ambient light even.
    #[must_use]
    pub fn plate_falloff(&self, region: &Region, in_plane: DVec2) -> DVec3 {
        let shares = self.shares.iter().enumerate();
        DVec3::ONE
            + shares
                .map(|(i, share)| *share * (region.falloff(i, in_plane) - 1.0))
                .sum::<DVec3>()
    }

    /// A frame as a fraction of the plate, from the ambient visibility and that of each light.
    ///
    /// Written with the shares `f` at the point itself: gain (A (1 - sum f) + bounce (1 - A) + sum f V).
    #[must_use]
    pub fn receiver_model(&self, region: &Region, in_plane: DVec2, ambient: f64, visibility: DVec4) -> DVec3 {
        let total = self.plate_falloff(region, in_plane);
        let mut kept = DVec3::splat(ambient) + self.bounce * (1.0 - ambient);
        for (i, share) in self.shares.iter().enumerate() {
            let share_here = *share * region.falloff(i, in_plane) / total;
            kept += share_here * (visibility[i] - ambient);
        }
        self.gain * kept
    }
}

/// What the passes see of a frame, over the region. Colours are linear.
#[derive(Clone, Debug)]
pub struct Pictures {
    /// The camera's frame.
    pub frame: Raster<DVec3>,
    /// The place without the toy.
    pub plate: Raster<DVec3>,
    /// 1 where the frame shows the receiver alone.
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

/// Linear light between which an 8-bit code carries evidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvidenceRange {
    /// Below, a code is mostly quantisation.
    pub darkest: f64,
    /// Above, a code may be clipped.
    pub brightest: f64,
}

impl EvidenceRange {
    /// Reads it from `shader`, which includes `common/pixel.wgsl`.
    ///
    /// # Errors
    /// When it does not.
    pub fn from_shader(shader: &str) -> Result<Self, ConstantError> {
        Ok(Self {
            darkest: shader_constant(shader, "DARKEST_EVIDENCE")?,
            brightest: shader_constant(shader, "BRIGHTEST_EVIDENCE")?,
        })
    }

    /// 1 where both values are within.
    #[must_use]
    pub fn holds(&self, a: f64, b: f64) -> f64 {
        let is_within = |value: f64| (self.darkest..=self.brightest).contains(&value);
        f64::from(u8::from(is_within(a) && is_within(b)))
    }
}
