//! Pictures of light probes by exact rays: a flat Fresnel lens of ring facets with the ghosts of
//! its back walls, and a mirror ball.

use std::sync::Arc;

use app_core::scene::{Camera, FacetSlope, ProbePicture, ProbeShape};
use glam::{DMat4, DVec2, DVec3};

use super::film::Film;
use super::lamp::Lamp;

/// Rays through a pixel along each side.
const N_ACROSS: usize = 8;
/// Linear light beside the probe, and of reflections from below, at the exposure of a frame.
const TABLE: f64 = 0.3;

/// A probe with its pose and its imperfections.
#[derive(Clone, Debug)]
pub struct Mirror {
    /// Its shape.
    pub shape: ProbeShape,
    /// Pose, rigid.
    pub world_from_probe: DMat4,
    /// Width of a lens's facets, each with the slope of its centre; 0 for a smooth lens.
    pub pitch_m: f64,
    /// Light from the back walls of facets.
    pub ghosts: Vec<Ghost>,
}

/// A streak of light on a lens.
#[derive(Clone, Copy, Debug)]
pub struct Ghost {
    /// Its ends on the disc, (x, z) of probe space in metres.
    pub ends_m: [DVec2; 2],
    /// Its width.
    pub width_m: f64,
    /// Linear light at the exposure of a frame.
    pub light: f64,
}

/// The exposure of a probe's picture.
#[derive(Clone, Copy, Debug)]
pub struct Exposure {
    /// Exposure over that of a frame.
    pub ratio: f64,
    /// Standard deviation of the camera lens's blur, in pixels.
    pub blur_px: f64,
    /// Standard deviation of the noise, in codes.
    pub noise_codes: f64,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for Exposure {
    fn default() -> Self {
        Self {
            ratio: 1.0 / 64.0,
            blur_px: 0.6,
            noise_codes: 1.0,
            seed: 1,
        }
    }
}

impl Mirror {
    /// A Fresnel lens 10 cm across, its facets a tenth of a millimetre wide and as steep as a hemisphere.
    #[must_use]
    pub fn lens(world_from_probe: DMat4) -> Self {
        Self {
            shape: ProbeShape::FresnelLens {
                radius_m: 0.05,
                slope: FacetSlope::Hemisphere,
            },
            world_from_probe,
            pitch_m: 1e-4,
            ghosts: Vec::new(),
        }
    }

    /// A ball 6 cm across.
    #[must_use]
    pub fn ball(world_from_probe: DMat4) -> Self {
        Self {
            shape: ProbeShape::MirrorBall { radius_m: 0.03 },
            ..Self::lens(world_from_probe)
        }
    }

    /// Photographs it under lamps and a uniform sky.
    #[must_use]
    pub fn photograph(
        &self,
        (lamps, sky): (&[Lamp], DVec3),
        (camera, size_px): (&Camera, [u32; 2]),
        exposure: &Exposure,
    ) -> ProbePicture {
        let window = self.window(camera, size_px);
        let [width, height] = window.size.map(|side| side * N_ACROSS);
        let eye = camera.world_from_camera.w_axis.truncate();
        let k = &camera.intrinsics;
        let probe_from_world = self.world_from_probe.inverse();
        let from = probe_from_world.transform_point3(eye);
        let mut fine = vec![DVec3::ZERO; width * height];
        for (index, light) in fine.iter_mut().enumerate() {
            let at = DVec2::new((index % width) as f64, (index / width) as f64);
            let in_window = (at + 0.5) / N_ACROSS as f64;
            let [u, v] = (in_window + DVec2::from_array(window.first.map(|first| first as f64))).to_array();
            let sight = DVec3::new((u - k.cx_px) / k.fx_px, (k.cy_px - v) / k.fy_px, -1.0);
            let along = camera.world_from_camera.transform_vector3(sight).normalize();
            *light = self.seen(from, probe_from_world.transform_vector3(along), lamps, sky);
        }
        let mut light = vec![DVec3::splat(TABLE); size_px.map(|side| side as usize).iter().product()];
        for (index, of_pixel) in blurred(&fine, window.size, exposure.blur_px)
            .into_iter()
            .enumerate()
        {
            let [x, y] = [index % window.size[0], index / window.size[0]];
            light[(window.first[1] + y) * size_px[0] as usize + window.first[0] + x] = of_pixel;
        }
        let film = Film {
            size_px,
            light,
            toy: Vec::new(),
            shadow: Vec::new(),
        };
        let image = film.develop(DVec3::splat(exposure.ratio), exposure.noise_codes, exposure.seed);
        ProbePicture {
            image: Arc::new(image),
            camera: *camera,
            world_from_probe: self.world_from_probe,
            exposure_ratio: exposure.ratio,
        }
    }

    /// The pixels that can show it, and some around them; all of them if it is beside the camera.
    fn window(&self, camera: &Camera, size_px: [u32; 2]) -> Window {
        let size = size_px.map(|side| side as usize);
        let middle = self.world_from_probe.w_axis.truncate();
        let in_camera = camera.world_from_camera.inverse().transform_point3(middle);
        let (k, reach_m) = (&camera.intrinsics, 1.5 * self.shape.radius_m());
        let Some(at_px) = k.pixel_of(in_camera).filter(|_| -in_camera.z > 2.0 * reach_m) else {
            return Window { first: [0; 2], size };
        };
        let reach_px = reach_m * k.fx_px.max(k.fy_px) / (-in_camera.z - reach_m) + 8.0;
        let bound = |at: f64, side: usize| {
            #[allow(clippy::cast_possible_truncation, reason = "negative ones become 0")]
            let at = at as usize;
            at.min(side)
        };
        let first = [0, 1].map(|axis| bound(at_px[axis] - reach_px, size[axis]));
        let last = [0, 1].map(|axis| bound(at_px[axis] + reach_px, size[axis]));
        Window {
            first,
            size: [last[0] - first[0], last[1] - first[1]],
        }
    }

    /// Light along a ray of probe space.
    fn seen(&self, from: DVec3, along: DVec3, lamps: &[Lamp], sky: DVec3) -> DVec3 {
        let Some((at, normal)) = self.meets(from, along) else {
            return DVec3::splat(TABLE);
        };
        let mirrored = along - 2.0 * along.dot(normal) * normal;
        let at_in_world = self.world_from_probe.transform_point3(at);
        let to = self.world_from_probe.transform_vector3(mirrored).normalize();
        let around = if to.y > 0.0 { sky } else { DVec3::splat(TABLE) };
        let of_lamps: DVec3 = lamps.iter().map(|lamp| radiance(lamp, at_in_world, to)).sum();
        let of_ghosts: f64 = self.ghosts.iter().map(|ghost| ghost.at(at)).sum();
        around + of_lamps + DVec3::splat(of_ghosts)
    }

    /// Intersection of a ray of probe space with the probe, and the normal there.
    fn meets(&self, from: DVec3, along: DVec3) -> Option<(DVec3, DVec3)> {
        match &self.shape {
            ProbeShape::FresnelLens { radius_m, slope } => {
                let at = from + along * (-from.y / along.y);
                let out = DVec2::new(at.x, at.z);
                if from.y <= 0.0 || along.y >= 0.0 || out.length() > *radius_m {
                    return None;
                }
                let facet = if self.pitch_m > 0.0 {
                    self.pitch_m * ((out.length() / self.pitch_m).floor() + 0.5)
                } else {
                    out.length()
                };
                let (lean, up) = steepness(slope, facet.min(*radius_m), *radius_m).sin_cos();
                let outward = lean * out.normalize_or_zero();
                Some((at, DVec3::new(outward.x, up, outward.y)))
            }
            ProbeShape::MirrorBall { radius_m } => {
                // |from + t along| = radius, the nearer solution.
                let (b, c) = (from.dot(along), from.length_squared() - radius_m * radius_m);
                let root = b * b - c;
                let at = from + along * (-b - root.max(0.0).sqrt());
                (root > 0.0 && b < 0.0).then(|| (at, at / *radius_m))
            }
        }
    }
}

/// Pixels from the first on.
struct Window {
    first: [usize; 2],
    size: [usize; 2],
}

fn steepness(slope: &FacetSlope, out_m: f64, radius_m: f64) -> f64 {
    match slope {
        FacetSlope::Hemisphere => (out_m / radius_m).asin(),
        FacetSlope::Focal { focal_m } => (out_m / focal_m).atan() / 2.0,
        // A calibration table is no construction of a lens.
        FacetSlope::Table(_) => 0.0,
    }
}

/// Radiance of a lamp's disc in a direction.
fn radiance(lamp: &Lamp, at: DVec3, to: DVec3) -> DVec3 {
    let cone = lamp.cone(at);
    if to.dot(cone.axis) > 0.0 && to.cross(cone.axis).length() < cone.sine {
        lamp.radiance()
    } else {
        DVec3::ZERO
    }
}

impl Ghost {
    fn at(&self, at: DVec3) -> f64 {
        let [from, to] = self.ends_m;
        let (off, along) = (DVec2::new(at.x, at.z) - from, to - from);
        let part = (off.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        if off.distance(part * along) < 0.5 * self.width_m {
            self.light
        } else {
            0.0
        }
    }
}

/// Pixels from subpixels: the mean over pixel and blur.
fn blurred(fine: &[DVec3], [width, height]: [usize; 2], blur_px: f64) -> Vec<DVec3> {
    let columns = width * N_ACROSS;
    let weights = spot(blur_px);
    // Along columns, then along rows.
    let mut halved = vec![DVec3::ZERO; columns * height];
    for (index, light) in halved.iter_mut().enumerate() {
        let (x, y) = (index % columns, index / columns);
        *light = weighted(&weights, y, height, |row| fine[row * columns + x]);
    }
    (0..width * height)
        .map(|index| {
            let (x, y) = (index % width, index / width);
            weighted(&weights, x, width, |column| halved[y * columns + column])
        })
        .collect()
}

/// Weights of the subpixels of a pixel and of its neighbours within the blur.
fn spot(blur_px: f64) -> Vec<f64> {
    #[allow(clippy::cast_possible_truncation, reason = "a few pixels")]
    let margin = (4.0 * blur_px).ceil() as usize * N_ACROSS;
    let place_px = |index: usize| (index as f64 + 0.5) / N_ACROSS as f64;
    let n = N_ACROSS + 2 * margin;
    let weight = |index: usize| {
        let inside = (margin..margin + N_ACROSS).map(|within| {
            let off_px = place_px(index) - place_px(within);
            if blur_px > 0.0 {
                (-0.5 * (off_px / blur_px).powi(2)).exp()
            } else {
                f64::from(u8::from(index == within))
            }
        });
        inside.sum::<f64>()
    };
    let weights: Vec<f64> = (0..n).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// Border pixels are repeated outside of the picture.
fn weighted(weights: &[f64], pixel: usize, n_pixels: usize, at: impl Fn(usize) -> DVec3) -> DVec3 {
    let margin = (weights.len() - N_ACROSS) / 2;
    let last = (n_pixels * N_ACROSS).saturating_sub(1);
    let terms = weights.iter().enumerate().map(|(index, weight)| {
        let place = (pixel * N_ACROSS + index).saturating_sub(margin).min(last);
        *weight * at(place)
    });
    terms.sum()
}
