//! A phone platform's estimate of the light.

use glam::DVec3;

use super::check::{self, InputError};

/// Number of spherical harmonics' coefficients up to the second degree, for three channels.
pub const N_HARMONICS: usize = 27;
/// Weights of the channels in luminance. Source: ITU-R BT.709.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The light estimate of ARCore's environmental HDR or of ARKit in one frame, as far as the
/// platform reports it. It is learned from the camera's view of a room, and may be wrong by tens of
/// degrees.
///
/// It belongs to one frame: estimates of several frames are never summed. The direction is a
/// starting point of the search if the toy's shadow alone shows no light. Nothing else is used:
/// shares and colours of lights are taken from the real shadow, which contains the camera's own
/// white balance, unlike an ambient intensity or a colour temperature.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightEstimate {
    /// Unit vector from the scene towards the main light. ARKit reports it only with a face in
    /// view.
    pub direction_to_light_in_world: Option<DVec3>,
    /// Its linear intensity in red, green and blue, relative to the exposure.
    pub intensity: Option<[f64; 3]>,
    /// Intensity of the surroundings: ARKit's lumen, about 1000 in a well-lit room, or ARCore's
    /// mean of the picture's codes.
    pub ambient_intensity: Option<f64>,
    /// Colour temperature of the surroundings, in kelvin; about 6500 is neutral.
    pub color_temperature_k: Option<f64>,
    /// Radiance of the surroundings, linear, relative to the exposure: red, green and blue of each
    /// coefficient, in the order of (degree, order) (0, 0), (1, -1), (1, 0), (1, 1), (2, -2) to (2,
    /// 2), real and without the Condon-Shortley phase: the coefficients of degree 1 belong to y, z
    /// and x of the world. The order of the numbers is ARCore's; ARKit has all of red first.
    pub spherical_harmonics: Option<[f64; N_HARMONICS]>,
}

impl LightEstimate {
    /// Unit vector towards most of the light: the main light, or else the direction of the
    /// harmonics of degree 1.
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
