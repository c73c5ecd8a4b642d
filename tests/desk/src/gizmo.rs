//! Lights drawn over a photograph: their direction from the toy, their width, and its uncertainty.

use std::f64::consts::TAU;

use app_core::alignment::{AlignmentReport, LightSearch};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Image, Light, Scene};
use glam::{DVec2, DVec3};

use crate::alignment::{SeenLight, middle};
use crate::false_color::{ERROR_RAMP, Ramp, color_at};
pub use crate::false_color::{LIGHT_FOUND as FOUND, LIGHT_GIVEN as GIVEN};

/// Length of a ray over the diagonal of the toy's box.
const RAY: f64 = 0.45;
/// Dots along a line, and around a ring.
const N_DOTS: u32 = 600;
/// Radius of a dashed ring, in standard deviations.
const DEVIATIONS: f64 = 2.0;
/// Side of the picture of a hemisphere, and radius of its horizon, in pixels.
const HEMISPHERE_PX: u32 = 400;
const HORIZON_PX: f64 = 190.0;
const SURROUNDINGS: [u8; 4] = [32, 32, 32, 255];

/// A light to draw.
#[derive(Clone, Copy, Debug)]
pub struct Gizmo {
    /// The light seen from the toy's centre.
    pub seen: SeenLight,
    /// Standard deviation of its direction, in radians, if known.
    pub deviation_rad: Option<f64>,
}

impl Gizmo {
    /// The lights of a list, seen from the toy of an input.
    #[must_use]
    pub fn listed(scene: &Scene, input: &FrameInput) -> Vec<Self> {
        let lights = input.lights.as_deref().unwrap_or(&scene.lights);
        Self::of(lights, middle(scene, &input.world_from_object), |_| None)
    }

    /// The lights of an aligned input, with alignment's report about them.
    #[must_use]
    pub fn aligned(scene: &Scene, input: &FrameInput, report: &AlignmentReport) -> Vec<Self> {
        let lights = input.lights.as_deref().unwrap_or(&scene.lights);
        let deviation = |index: usize| {
            let discovered = report.discovered.get(index);
            let told = discovered.map(|light| light.deviation.direction_rad);
            told.or_else(|| report.lights.get(index).map(|light| light.deviation_rad))
        };
        Self::of(lights, middle(scene, &input.world_from_object), deviation)
    }

    fn of(lights: &[Light], from: DVec3, deviation: impl Fn(usize) -> Option<f64>) -> Vec<Self> {
        let lights = lights.iter().enumerate();
        let gizmo = |(index, light)| Self {
            seen: SeenLight::from(from, light),
            deviation_rad: deviation(index).filter(|deviation| deviation.is_finite()),
        };
        lights.map(gizmo).collect()
    }
}

/// Draws for each light a ray from the toy's centre towards it, at its end a ring as wide as the
/// light, and a dashed ring of two standard deviations of its direction.
pub fn rays(picture: &mut Image, (scene, input): (&Scene, &FrameInput), lights: &[Gizmo], color: [u8; 3]) {
    let from = middle(scene, &input.world_from_object);
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose);
    let diagonal = bounds.map_or(DVec3::ZERO, |bounds| (bounds.max - bounds.min).as_dvec3());
    let length_m = RAY * input.world_from_object.transform_vector3(diagonal).length();
    for light in lights {
        let direction = light.seen.direction_in_world;
        let end = from + length_m * direction;
        let camera = &input.camera;
        for dot in 0..N_DOTS {
            let part = f64::from(dot) / f64::from(N_DOTS);
            mark(picture, camera, from.lerp(end, part), color);
        }
        let wide_m = length_m * light.seen.angular_radius_rad.min(1.4).tan();
        ring(picture, camera, (end, direction, wide_m), (color, 1));
        if let Some(deviation_rad) = light.deviation_rad {
            let known_m = length_m * (DEVIATIONS * deviation_rad).min(1.4).tan();
            ring(picture, camera, (end, direction, known_m), (color, 12));
        }
    }
}

/// A ring around an end, whole, or dashed in groups of equally many dots.
fn ring(
    picture: &mut Image,
    camera: &Camera,
    (middle, normal, radius_m): (DVec3, DVec3, f64),
    (color, group): ([u8; 3], u32),
) {
    let (a, b) = normal.any_orthonormal_pair();
    for dot in (0..N_DOTS).filter(|dot| group == 1 || (dot / group).is_multiple_of(2)) {
        let at = DVec2::from_angle(TAU * f64::from(dot) / f64::from(N_DOTS)) * radius_m;
        mark(picture, camera, middle + at.x * a + at.y * b, color);
    }
}

fn mark(picture: &mut Image, camera: &Camera, at: DVec3, color: [u8; 3]) {
    if let Some(at_px) = camera.pixel_of(at) {
        dot(picture, at_px, color);
    }
}

/// Paints the pixel at a place, if that is in the picture.
pub(crate) fn dot(picture: &mut Image, at_px: DVec2, color: [u8; 3]) {
    let at = at_px.floor();
    let size = DVec2::new(f64::from(picture.width_px), f64::from(picture.height_px));
    if at.cmpge(DVec2::ZERO).all() && at.cmplt(size).all() {
        let at = at.as_uvec2();
        let first = 4 * (at.y * picture.width_px + at.x) as usize;
        picture.rgba8[first..first + 3].copy_from_slice(&color);
    }
}

/// The hemisphere above the receiver that the search for lights scored, seen from above with the
/// camera below: the centre is straight up, the rim the horizon, and areas are preserved (Lambert).
/// Brightness is the score of a light there; rings are lights, about two standard deviations wide,
/// and 6 pixels at least.
#[must_use]
pub fn hemisphere(search: &LightSearch, camera: &Camera, lights: &[(Gizmo, [u8; 3])]) -> Image {
    let plane = Plane::new(search.up_in_world, camera);
    let best = search
        .explained
        .iter()
        .fold(0.0, |best: f64, (_, score)| best.max(*score));
    let mut picture = Image {
        width_px: HEMISPHERE_PX,
        height_px: HEMISPHERE_PX,
        rgba8: Vec::new(),
    };
    for row in 0..HEMISPHERE_PX {
        for column in 0..HEMISPHERE_PX {
            let color = match plane.direction(DVec2::new(f64::from(column), f64::from(row)) + 0.5) {
                Some(direction) => {
                    let near = |(other, _): &&(DVec3, f64)| direction.dot(*other);
                    let nearest = search.explained.iter();
                    let nearest = nearest.max_by(|a, b| near(a).total_cmp(&near(b)));
                    let score = nearest.map_or(0.0, |(_, score)| *score);
                    shade(ERROR_RAMP, if best > 0.0 { score / best } else { 0.0 })
                }
                None => SURROUNDINGS,
            };
            picture.rgba8.extend(color);
        }
    }
    for (light, color) in lights {
        let at_px = plane.pixel(light.seen.direction_in_world);
        let radius_px = HORIZON_PX * DEVIATIONS * light.deviation_rad.unwrap_or(0.0);
        for step in 0..N_DOTS {
            let turn = DVec2::from_angle(TAU * f64::from(step) / f64::from(N_DOTS));
            dot(&mut picture, at_px + turn * radius_px.max(6.0), *color);
        }
    }
    picture
}

#[expect(clippy::cast_possible_truncation, reason = "a colour")]
fn shade(ramp: Ramp, t: f64) -> [u8; 4] {
    let [r, g, b] = color_at(ramp, t as f32);
    [r, g, b, 255]
}

/// Directions as places in the picture.
struct Plane {
    /// To the right, up in the picture, and straight up.
    axes: [DVec3; 3],
}

impl Plane {
    fn new(up: DVec3, camera: &Camera) -> Self {
        let away = -camera.world_from_camera.z_axis.truncate();
        let away = away.reject_from(up).try_normalize();
        let away = away.unwrap_or_else(|| up.any_orthonormal_vector());
        Self {
            axes: [away.cross(up), away, up],
        }
    }

    /// The direction at a place; `None` beyond the horizon.
    fn direction(&self, at_px: DVec2) -> Option<DVec3> {
        let at = (at_px - 0.5 * f64::from(HEMISPHERE_PX)) / HORIZON_PX;
        let r2 = at.length_squared();
        // Lambert's azimuthal projection: the distance is the chord's, 1 at the horizon.
        let level = (2.0 - r2).max(0.0).sqrt();
        let [right, away, up] = self.axes;
        (r2 <= 1.0).then(|| level * (at.x * right - at.y * away) + (1.0 - r2) * up)
    }

    fn pixel(&self, direction: DVec3) -> DVec2 {
        let [x, y, z] = self.axes.map(|axis| axis.dot(direction));
        let stretch = (1.0 + z.max(0.0)).sqrt().recip();
        DVec2::splat(0.5 * f64::from(HEMISPHERE_PX)) + HORIZON_PX * stretch * DVec2::new(x, -y)
    }
}
