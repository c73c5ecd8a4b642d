//! The toy's specular reflection, in the layout of the shaders.

use crate::gpu::shader::{Mirrors, mirrors};
use crate::gpu::shared::shared_struct;
use app_scene::gloss::{Gloss, N_GLOSSES as N_STRENGTHS};
use app_scene::scene::MAX_LIGHTS;

/// WGSL part of the reflection.
pub(crate) const GLOSS: Mirrors = mirrors!("common/gloss", structs: [Specular], constants: [N_GLOSSES]);
/// Number of materials that have a strength of their own.
pub(crate) const N_GLOSSES: usize = N_STRENGTHS;
/// Variance of a half-way vector's slope along one direction, relative to the squared angular
/// radius of its light, times the two of a squared roughness. A disc's variance is a quarter, and a
/// half-way vector turns by half as much.
const OF_LIGHT: f32 = 0.125;
/// Smallest squared roughness of a lobe: sharper ones would be noise between pixels.
const LEAST_LOBE: f32 = 1e-4;
/// Largest squared roughness of a lobe: the exponent would not be positive above it.
const MOST_LOBE: f32 = 0.98;

shared_struct! {
    /// One lobe for each light.
    pub struct Specular {
        pub lobes: [f32; MAX_LIGHTS],
        pub strengths: [[f32; 4]; 2],
        pub roughness: f32,
        pub _pad_0: f32,
        pub _pad_1: [f32; 2],
    }
}

impl Specular {
    /// The reflection of a toy that is lit by lights of these angular radii.
    #[must_use]
    pub fn new(gloss: &Gloss, angular_radii_rad: impl Iterator<Item = f64>) -> Self {
        let squared = gloss.roughness * gloss.roughness;
        let mut lobes = [squared.clamp(LEAST_LOBE, MOST_LOBE); MAX_LIGHTS];
        for (lobe, radius_rad) in lobes.iter_mut().zip(angular_radii_rad) {
            #[allow(clippy::cast_possible_truncation, reason = "an angle, to 7 digits")]
            let radius_rad = radius_rad as f32;
            *lobe = (squared + OF_LIGHT * radius_rad * radius_rad).clamp(LEAST_LOBE, MOST_LOBE);
        }
        let [a, b, c, d, e, f, g, h] = gloss.strengths;
        Self {
            lobes,
            strengths: [[a, b, c, d], [e, f, g, h]],
            roughness: gloss.roughness,
            _pad_0: 0.0,
            _pad_1: [0.0; 2],
        }
    }

    /// Whether any part of the toy is glossy.
    #[must_use]
    pub fn is_glossy(&self) -> bool {
        self.strengths.iter().flatten().any(|strength| *strength > 0.0)
    }
}
