//! Reflectance of a rough dielectric for lamps, by a lobe, and for an even sky.
//!
//! Source: Blinn 1977, Walter et al. 2007, Schlick 1994, Hammon 2017, Karis 2014; the same as in
//! `common/gloss.wgsl`.

use app_scene::reflection::reflectance;
use glam::DVec3;

/// Reflectance at normal incidence, for refractive index 1.5.
const STRAIGHT: f64 = 0.04;
/// Smallest cosine; smaller ones are clamped.
const LEAST_COSINE: f64 = 0.05;
/// Slope of the transition from the light below to that above as the mirrored direction rises.
const HORIZON_SLOPE: f64 = 2.5;
/// Smallest and largest squared roughness of a lobe.
const LOBE: [f64; 2] = [1e-4, 0.98];
/// Share of a light's squared angular radius that adds to it.
const OF_LIGHT: f64 = 0.125;

/// Squared roughness of the lobe of a light.
pub(super) fn lobe(roughness: f64, angular_radius_rad: f64) -> f64 {
    let squared = roughness * roughness + OF_LIGHT * angular_radius_rad * angular_radius_rad;
    squared.clamp(LOBE[0], LOBE[1])
}

/// Reflected radiance of a light, relative to a white matt surface; all vectors are unit vectors.
pub(super) fn of_light(lobe: f64, normal: DVec3, to_camera: DVec3, to_light: DVec3) -> f64 {
    let half_way = (to_camera + to_light).normalize_or_zero();
    let exponent = 2.0 / lobe - 2.0;
    let distribution = 0.5 * (exponent + 2.0) * normal.dot(half_way).clamp(0.0, 1.0).powf(exponent);
    let fresnel = STRAIGHT + (1.0 - STRAIGHT) * (1.0 - to_light.dot(half_way).clamp(0.0, 1.0)).powi(5);
    let [l, v] = [to_light, to_camera].map(|direction| normal.dot(direction).max(LEAST_COSINE));
    let width = lobe.sqrt();
    let [masked_l, masked_v] = [l, v].map(|cosine| cosine * (1.0 - width) + width);
    0.5 * distribution * fresnel / (l * masked_v + v * masked_l)
}

/// Reflected radiance of the ambient light from above and from below.
pub(super) fn of_ambient(roughness: f64, normal: DVec3, to_camera: DVec3, up: DVec3) -> [f64; 2] {
    let cosine = normal.dot(to_camera).max(LEAST_COSINE);
    let reflectance = reflectance(roughness, cosine);
    let mirrored = 2.0 * normal.dot(to_camera) * normal - to_camera;
    let above = (0.5 + HORIZON_SLOPE * mirrored.dot(up)).clamp(0.0, 1.0);
    [reflectance * above, reflectance * (1.0 - above)]
}
