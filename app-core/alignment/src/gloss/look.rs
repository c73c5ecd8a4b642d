//! Visible pixels of a toy, and the light that each receives from every light.

use std::collections::BTreeSet;

use glam::{DMat4, DVec3};

use super::columns::{Columns, N_COLUMNS};
use super::light_depth::LightDepth;
use super::reflectance;
use crate::pose::Surfel;
use crate::raster::Rasterizer;
use crate::shape::Shape;
use app_scene::geometry::color::linear_of_codes;
use app_scene::geometry::disc::vogel_disc;
use app_scene::gloss::N_GLOSSES;
use app_scene::scene::{Light, MAX_LIGHTS};

/// Cells of normals along each axis, for each unit of length: their sides are some 15 degrees.
const NORMAL_CELLS: f64 = 4.0;
/// Points over a light.
const N_POINTS: usize = 8;
/// Assumed distance of a far light, in radii of the toy.
const FAR: f64 = 100.0;
/// Range of codes that are neither clipped nor mostly rounding.
const USABLE_CODES: [usize; 2] = [10, 250];

/// Lights around a toy, in camera space.
pub(crate) struct Lights {
    lights: Vec<Light>,
    up: DVec3,
}

impl Lights {
    /// The first lights of a list.
    pub(crate) fn new(listed: &[Light], camera_from_world: &DMat4) -> Self {
        let lights = listed.iter().take(MAX_LIGHTS);
        Self {
            lights: lights.map(|light| light.moved(camera_from_world)).collect(),
            up: camera_from_world
                .transform_vector3(DVec3::Y)
                .normalize_or(DVec3::Y),
        }
    }
}

/// A pixel of the toy.
pub(super) struct Sample {
    pub(super) shown: [f64; 3],
    pub(super) is_usable: [bool; 3],
    pub(super) base: [f64; 3],
    /// Index of the strength of its material.
    pub(super) material: usize,
    /// Light that a white matt surface there receives from the ambient light above and below, and
    /// from each light.
    pub(super) received: Columns,
    normal: DVec3,
    to_camera: DVec3,
    to_lights: [DVec3; MAX_LIGHTS],
}

/// Observations of a toy.
pub(crate) struct Look {
    pub(super) samples: Vec<Sample>,
    angular_radii_rad: Vec<f64>,
    up: DVec3,
    /// Number of columns in use.
    pub(super) n_columns: usize,
    pub(super) n_materials: usize,
}

impl Look {
    /// Observations of a shape that a photograph shows at its place.
    pub(crate) fn new(shape: &Shape, surfels: &[Surfel], lights: &Lights) -> Self {
        let mut raster = Rasterizer::default();
        let maps: Vec<Vec<LightDepth>> = lights
            .lights
            .iter()
            .map(|light| maps(&mut raster, shape, light))
            .collect();
        let table = linear_of_codes();
        let [darkest, brightest] = USABLE_CODES.map(|code| table[code]);
        let sample = |surfel: &Surfel| {
            let normal = surfel.normal;
            let mut received = Columns::zeros();
            let upward = normal.dot(lights.up);
            (received[0], received[1]) = (0.5 + 0.5 * upward, 0.5 - 0.5 * upward);
            let mut to_lights = [DVec3::ZERO; MAX_LIGHTS];
            for (index, (light, maps)) in lights.lights.iter().zip(&maps).enumerate() {
                to_lights[index] = light.direction_from(surfel.point).unwrap_or(normal);
                let cosine = normal.dot(to_lights[index]);
                if cosine > 0.0 {
                    received[2 + index] = cosine * visible(maps, surfel, cosine);
                }
            }
            Sample {
                shown: surfel.shown.map(f64::from),
                is_usable: surfel.shown.map(|value| (darkest..=brightest).contains(&value)),
                base: surfel.base.map(f64::from),
                material: surfel.material.min(N_GLOSSES - 1),
                received,
                normal,
                to_camera: (-surfel.point).normalize_or(normal),
                to_lights,
            }
        };
        let samples: Vec<Sample> = surfels.iter().map(sample).collect();
        let radii = lights.lights.iter();
        Self {
            n_materials: samples
                .iter()
                .map(|sample| sample.material + 1)
                .max()
                .unwrap_or(0),
            samples,
            angular_radii_rad: radii
                .map(|light| light.angular_radius_rad_from(shape.centre))
                .collect(),
            up: lights.up,
            n_columns: (2 + lights.lights.len()).min(N_COLUMNS),
        }
    }

    /// Number of clearly different normals.
    pub(super) fn n_normals(&self) -> usize {
        let cell = |sample: &Sample| (NORMAL_CELLS * sample.normal).round().as_ivec3().to_array();
        self.samples.iter().map(cell).collect::<BTreeSet<_>>().len()
    }

    /// Number of samples.
    pub(super) fn len(&self) -> usize {
        self.samples.len()
    }

    /// Reflection of each column's light by each sample, at strength 1.
    pub(super) fn reflected(&self, roughness: f64) -> Vec<Columns> {
        let lobes: Vec<f64> = self
            .angular_radii_rad
            .iter()
            .map(|radius_rad| reflectance::lobe(roughness, *radius_rad))
            .collect();
        let of_sample = |sample: &Sample| {
            let mut columns = Columns::zeros();
            let ambient = reflectance::of_ambient(roughness, sample.normal, sample.to_camera, self.up);
            (columns[0], columns[1]) = (ambient[0], ambient[1]);
            for (index, lobe) in lobes.iter().enumerate() {
                let received = sample.received[2 + index];
                if received > 0.0 {
                    let to_light = sample.to_lights[index];
                    columns[2 + index] =
                        received * reflectance::of_light(*lobe, sample.normal, sample.to_camera, to_light);
                }
            }
            columns
        };
        self.samples.iter().map(of_sample).collect()
    }
}

/// Maps from points spread over a light.
fn maps(raster: &mut Rasterizer, shape: &Shape, light: &Light) -> Vec<LightDepth> {
    let Some(direction) = light.direction_from(shape.centre) else {
        return Vec::new();
    };
    let distance_m = light.distance_m_from(shape.centre);
    let distance_m = distance_m.unwrap_or(FAR * shape.radius_m);
    let (across, along) = direction.any_orthonormal_pair();
    let radius_m = distance_m * light.slope_from(shape.centre).unwrap_or(0.0);
    let points = vogel_disc(N_POINTS).map(|at| radius_m * (at.x * across + at.y * along));
    let eyes = points.map(|offset| shape.centre + distance_m * direction + offset);
    eyes.filter_map(|eye| LightDepth::new(raster, shape, eye))
        .collect()
}

/// Visible share of a light at a surfel.
fn visible(maps: &[LightDepth], surfel: &Surfel, cosine: f64) -> f64 {
    if maps.is_empty() {
        return 1.0;
    }
    let sum: f64 = maps
        .iter()
        .map(|map| map.visible(surfel.point, surfel.normal, cosine))
        .sum();
    sum / maps.len() as f64
}
