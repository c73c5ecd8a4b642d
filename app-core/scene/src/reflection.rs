//! Reflection of a glossy receiver: its surroundings, which its plate shows as well, and the toy in
//! front of them.
//!
//! Source: the lobe is that of Beckmann and Spizzichino 1963, sampled by its slopes; its strength
//! by angle is Karis' fit of a rough dielectric's reflectance (2014, "Physically Based Shading on
//! Mobile").

use glam::{DVec3, DVec4};

use crate::scene::{FieldError, InputError};

/// Number of eyes behind the receiver from which an image of the toy is drawn.
pub const N_MIRRORED_EYES: usize = 32;
/// Roughness of the smoothest and of the roughest receiver: the reflection of a rougher one is
/// indistinguishable from its own colour.
pub const ROUGHNESS: std::ops::RangeInclusive<f64> = 0.01..=1.0;
/// Reflectance of a dielectric at normal incidence.
const FROM_ABOVE: f64 = 0.04;
/// Sine of the lowest reflected ray.
const LOWEST: f64 = 0.02;
/// Largest light of the surroundings, relative to white.
const MOST_LIGHT: f32 = 1e3;

/// Reflection of the receiver below the toy.
///
/// The receiver shows its own colour in the incident light, plus `reflectance` times the reflected
/// light: that of the surroundings, or of the toy if it hides them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflection {
    /// Width of the lobe, as Beckmann's alpha: the root of twice the variance of its slopes.
    pub roughness: f64,
    /// Linear light of the surroundings, at the exposure of the plates.
    pub surroundings: [f32; 3],
    /// Light of the toy less that of the surroundings; negative if the toy is darker.
    pub toy_above_surroundings: [f32; 3],
}

impl Reflection {
    /// Share of the light that is reflected towards an eye, for the cosine between its direction
    /// and the receiver's normal.
    #[must_use]
    pub fn reflectance(&self, cosine: f64) -> f64 {
        reflectance(self.roughness, cosine)
    }

    /// Mirror images of an eye that looks at a foot on the plane y = 0, one for each slope of the
    /// lobe: the line from one of them to a point meets the plane where the reflected point is
    /// visible. Each is homogeneous with w = -1, so that it projects points above the plane in the
    /// same way as a light above it does.
    #[must_use]
    pub fn mirrored_eyes(&self, eye: DVec3, foot: DVec3) -> Vec<DVec4> {
        let to_eye = eye - foot;
        let view = to_eye.normalize_or(DVec3::Y);
        (0..N_MIRRORED_EYES)
            .map(|index| {
                let normal = slope_normal(self.roughness, index);
                let mut ray = 2.0 * normal.dot(view) * normal - view;
                ray.y = ray.y.max(LOWEST);
                (to_eye.length() * ray.normalize() - foot).extend(-1.0)
            })
            .collect()
    }

    /// Validates the values.
    pub fn check(&self, field: &str) -> Result<(), InputError> {
        let range = |name: &str, value: f64, min: f64, max: f64| {
            // The form of this condition refuses NaN.
            if (min..=max).contains(&value) {
                return Ok(());
            }
            Err(InputError {
                field: format!("{field}.{name}"),
                reason: FieldError::Range { value, min, max },
            })
        };
        range("roughness", self.roughness, *ROUGHNESS.start(), *ROUGHNESS.end())?;
        let most = f64::from(MOST_LIGHT);
        for channel in 0..3 {
            range("surroundings", self.surroundings[channel].into(), 0.0, most)?;
            let toy = self.toy_above_surroundings[channel].into();
            range("toy_above_surroundings", toy, -most, most)?;
        }
        Ok(())
    }
}

/// Reflectance of a dielectric of a roughness, for the cosine between the direction of view and the
/// normal, in light from all around.
#[must_use]
pub fn reflectance(roughness: f64, cosine: f64) -> f64 {
    let root = roughness.sqrt();
    let x = 1.0 - root;
    let y = 0.0425 - 0.0275 * root;
    let [z, w] = [1.04 - 0.572 * root, 0.022 * root - 0.04];
    let grazing = (x * x).min((-9.28 * cosine).exp2()) * x + y;
    FROM_ABOVE * (z - 1.04 * grazing) + w + 1.04 * grazing
}

/// Normal of one of the lobe's slopes, which are all equally likely.
fn slope_normal(roughness: f64, index: usize) -> DVec3 {
    let golden_angle_rad = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let part = (index as f64 + 0.5) / N_MIRRORED_EYES as f64;
    let slope = roughness * (-(-part).ln_1p()).sqrt();
    let (sin, cos) = (index as f64 * golden_angle_rad).sin_cos();
    DVec3::new(slope * cos, 1.0, slope * sin).normalize()
}
