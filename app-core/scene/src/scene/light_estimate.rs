//! What a phone's platform estimates of the light.

use glam::DVec3;

use super::check::{self, InputError};

/// Numbers of a spherical harmonic's expansion up to the second degree, with three channels each.
pub const N_HARMONICS: usize = 27;
/// Weight of the channels in luminance. Source: ITU-R BT.709.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// What ARCore's environmental HDR or ARKit estimates of the light in one frame, as far as the platform tells; learned from what a
/// camera sees of a room, it may be wrong by tens of degrees.
///
/// It is of one frame: those of several are never added up. A direction is looked along where the toy's shadow tells of no light by
/// itself. Nothing else is used: shares and colours of lights are those of the real shadow, which holds the camera's own white
/// balance, unlike an ambient intensity or a colour temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightEstimate {
    /// Unit vector from the scene towards the main light. ARKit tells it with a face in view alone.
    pub direction_to_light_in_world: Option<DVec3>,
    /// Its linear intensity in red, green and blue, relative to the exposure.
    pub intensity: Option<[f64; 3]>,
    /// Intensity of the surroundings: ARKit's lumen, about 1000 where it is well lit, or ARCore's mean of the picture's codes.
    pub ambient_intensity: Option<f64>,
    /// Of the surroundings, in kelvin; about 6500 is neutral.
    pub color_temperature_k: Option<f64>,
    /// Radiance from all around, linear, relative to the exposure: red, green and blue of each coefficient, in the order of (degree,
    /// order) (0, 0), (1, -1), (1, 0), (1, 1), (2, -2) to (2, 2), real and without the Condon-Shortley phase: those of degree 1 go with
    /// y, z and x of the world. The order of the numbers is ARCore's; ARKit has all of red first.
    pub spherical_harmonics: Option<[f64; N_HARMONICS]>,
}

impl LightEstimate {
    /// Unit vector towards where most light comes from: the main light, or else what the harmonics of degree 1 point to.
    ///
    /// Source: Sloan 2008, "Stupid Spherical Harmonics (SH) Tricks", optimal linear direction.
    #[must_use]
    pub fn direction_in_world(&self) -> Option<DVec3> {
        self.direction_to_light_in_world.or_else(|| {
            let harmonics = self.spherical_harmonics?;
            let luminance = |index: usize| -> f64 {
                let channels = &harmonics[3 * index..3 * index + 3];
                channels
                    .iter()
                    .zip(LUMINANCE)
                    .map(|(one, weight)| one * weight)
                    .sum()
            };
            DVec3::new(luminance(3), luminance(1), luminance(2)).try_normalize()
        })
    }

    /// Validates the numbers, whose fields are below `field`.
    pub fn check(&self, field: &str) -> Result<(), InputError> {
        let at = |name: &str, checked| InputError::at(&format!("{field}.{name}"), checked);
        if let Some(direction) = self.direction_to_light_in_world {
            at("direction_to_light_in_world", check::unit(direction))?;
        }
        for intensity in self.intensity.iter().flatten().chain(&self.ambient_intensity) {
            at(
                "intensity",
                check::number(*intensity, &check::INTENSITY).map(drop),
            )?;
        }
        if let Some(kelvin) = self.color_temperature_k {
            at(
                "color_temperature_k",
                check::number(kelvin, &check::KELVIN).map(drop),
            )?;
        }
        for number in self.spherical_harmonics.iter().flatten() {
            at(
                "spherical_harmonics",
                check::number(*number, &check::HARMONIC).map(drop),
            )?;
        }
        Ok(())
    }
}
