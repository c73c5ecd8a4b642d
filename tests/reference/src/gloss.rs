//! CPU reference of `gloss.wgsl` and `common/gloss.wgsl`: reflection of a glossy toy, and the
//! pixels that show its paint below.
//!
//! Source: Blinn 1977, Walter et al. 2007, Schlick 1994, Hammon 2017, Karis 2014.

use std::f64::consts::PI;

use glam::{DVec3, DVec4};

use super::fit::toy_radiance;
use super::model::{BRIGHTEST_USABLE, Region, Solution};
use super::smoothstep;

/// Reflectance of a dielectric of refractive index 1.5 at normal incidence: ((1.5 - 1) / (1.5 +
/// 1))^2.
const STRAIGHT: f64 = 0.04;
/// Smallest cosine to camera or light.
const LEAST_COSINE: f64 = 0.05;
/// Slope of the share of light from above in the mirrored direction: half at the horizon, all from
/// a rise of a fifth on.
const RISE_TO_ABOVE: f64 = 0.2;
/// A light's disc has a quarter of its squared radius as variance, half-way vectors turn by half as
/// much, and squared roughness is twice a variance.
const WIDENING: f64 = 2.0 / 4.0 / 4.0;
/// Number of materials with a strength of their own.
const N_STRENGTHS: usize = 8;
/// Share of lamps' highlights in a pixel's light up to which the paint counts fully, and from which
/// on it does not count.
const TOLD: [f64; 2] = [0.5, 0.8];
/// The limit for a clipped pixel.
const HIGHLIGHT: f64 = 0.1;

/// A glossy toy under lights with these angular radii.
#[derive(Clone, Debug, PartialEq)]
pub struct Glossy {
    /// Roughness of its surface.
    pub roughness: f64,
    /// Strengths of its materials, relative to plastic.
    pub strengths: Vec<f64>,
    /// Angular radius of each light, seen from the toy.
    pub angular_radii_rad: Vec<f64>,
}

/// A visible point of the toy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenPoint {
    /// Position in metres.
    pub in_anchor: DVec3,
    /// Normal, a unit vector.
    pub normal: DVec3,
    /// The camera's centre.
    pub camera_in_anchor: DVec3,
    /// Index of the material.
    pub material: usize,
    /// Cosine to each light, multiplied by its visibility.
    pub received: DVec4,
}

impl Glossy {
    /// Reflected light of the ambient light from above and from below, and of each light at the
    /// plate's level.
    #[must_use]
    pub fn columns(&self, region: &Region, point: &SeenPoint) -> Vec<f64> {
        let strength = self.strengths[point.material.min(N_STRENGTHS - 1)];
        let to_camera = (point.camera_in_anchor - point.in_anchor).normalize();
        let reflectance = ambient_reflectance(self.roughness, point.normal.dot(to_camera).max(LEAST_COSINE));
        let mirrored = -to_camera + 2.0 * to_camera.dot(point.normal) * point.normal;
        let above = ((mirrored.y / RISE_TO_ABOVE + 1.0) / 2.0).clamp(0.0, 1.0);
        let of_light = |(index, light): (usize, &DVec4)| {
            let to_light = (light.truncate() - light.w * point.in_anchor).normalize();
            let radius_rad = self.angular_radii_rad[index];
            let squared = self.roughness.powi(2) + WIDENING * radius_rad.powi(2);
            strength * point.received[index] * PI * brdf(squared, point.normal, [to_camera, to_light])
        };
        let of_sky = [reflectance * above, reflectance * (1.0 - above)].map(|part| strength * part);
        let of_lights = region.lights.iter().enumerate().map(of_light);
        of_sky.into_iter().chain(of_lights).collect()
    }
}

/// Reflectance of a rough dielectric under an even sky: Karis' fit of the split sum.
fn ambient_reflectance(roughness: f64, cosine: f64) -> f64 {
    let r =
        DVec4::new(-1.0, -0.0275, -0.572, 0.022) * roughness.sqrt() + DVec4::new(1.0, 0.0425, 1.04, -0.04);
    let a004 = (r.x * r.x).min((-9.28 * cosine).exp2()) * r.x + r.y;
    STRAIGHT * (-1.04 * a004 + r.z) + (1.04 * a004 + r.w)
}

/// Blinn's distribution, Schlick's Fresnel term, Hammon's approximation of Smith's shadowing.
fn brdf(squared: f64, normal: DVec3, [to_camera, to_light]: [DVec3; 2]) -> f64 {
    let half_way = (to_camera + to_light).normalize();
    let exponent = 2.0 / squared - 2.0;
    let distribution = (exponent + 2.0) / (2.0 * PI) * normal.dot(half_way).max(0.0).powf(exponent);
    let fresnel = STRAIGHT + (1.0 - STRAIGHT) * (1.0 - to_light.dot(half_way)).powi(5);
    let [v, l] = [to_camera, to_light].map(|direction| normal.dot(direction).max(LEAST_COSINE));
    let roughness = squared.sqrt();
    let masked = |cosine: f64| cosine + roughness - cosine * roughness;
    let visible = 0.5 / (l * masked(v) + v * masked(l));
    distribution * fresnel * visible
}

/// Radiance of the columns, relative to the gain: of the ambient light, and of the lights.
#[must_use]
pub fn reflected(solution: &Solution, columns: &[f64]) -> [DVec3; 2] {
    let (of_sky, of_lights) = columns.split_at(2);
    let sky = of_sky
        .iter()
        .zip(&solution.toy)
        .map(|(part, light)| *part * *light);
    let lights = of_lights
        .iter()
        .zip(&solution.toy[2..])
        .zip(&solution.intensities);
    [
        sky.sum(),
        lights
            .map(|((part, light), intensity)| *part * *light * *intensity)
            .sum(),
    ]
}

/// Reflected radiance relative to the gain, and the weight of a pixel that shows `shown` for the
/// paint of `base`.
#[must_use]
pub fn reflection(
    solution: &Solution,
    columns: &[f64],
    point: &SeenPoint,
    (base, shown): (DVec3, DVec3),
) -> DVec4 {
    let [of_sky, of_lights] = reflected(solution, columns);
    let paint = base * toy_radiance(solution, point.normal, point.received);
    let total = (of_sky + of_lights + paint).element_sum();
    let share = of_lights.element_sum() / total;
    let is_clipped = shown.max_element() > BRIGHTEST_USABLE && share > HIGHLIGHT;
    let told = if is_clipped {
        0.0
    } else {
        1.0 - smoothstep(TOLD[0], TOLD[1], share)
    };
    (of_sky + of_lights).extend(told)
}
