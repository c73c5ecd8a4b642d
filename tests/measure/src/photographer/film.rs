//! Pictures of a world: linear light per pixel and mask data, then sRGB codes.

use std::thread;

use app_core::scene::{Camera, Image};
use glam::DVec3;

use super::rays::{Place, Thing};
use super::world::Quality;
use crate::random::Random;

/// A camera's view of a world, pixel by pixel, rows from the top.
#[derive(Clone, Debug)]
pub struct Film {
    /// Width and height.
    pub size_px: [u32; 2],
    /// Linear radiance.
    pub light: Vec<DVec3>,
    /// Covered fraction of the pixel.
    pub toy: Vec<f64>,
    /// One minus the smallest visibility over all lights, on receivers.
    pub shadow: Vec<f64>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Pixel {
    light: DVec3,
    toy: f64,
    shadow: f64,
}

/// Takes a picture. Rows are distributed over as many threads as there are processors.
#[must_use]
pub fn expose(place: &Place<'_>, camera: &Camera) -> Film {
    let size_px = place.world().size_px;
    let [width, height] = size_px.map(|side| side as usize);
    let mut pixels = vec![Pixel::default(); width * height];
    let n_threads = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        // Alternately, so that no thread has all rows with the toy.
        let mut shares: Vec<Vec<(usize, &mut [Pixel])>> = (0..n_threads).map(|_| Vec::new()).collect();
        for (y, row) in pixels.chunks_exact_mut(width).enumerate() {
            shares[y % n_threads].push((y, row));
        }
        for share in shares {
            scope.spawn(move || {
                for (y, row) in share {
                    for (x, pixel) in row.iter_mut().enumerate() {
                        *pixel = take(place, camera, [x, y]);
                    }
                }
            });
        }
    });
    Film {
        size_px,
        light: pixels.iter().map(|pixel| pixel.light).collect(),
        toy: pixels.iter().map(|pixel| pixel.toy).collect(),
        shadow: pixels.iter().map(|pixel| pixel.shadow).collect(),
    }
}

/// One pixel: the mean over a grid of rays.
fn take(place: &Place<'_>, camera: &Camera, [x, y]: [usize; 2]) -> Pixel {
    let Quality { n_across, .. } = place.world().quality;
    let step = 1.0 / f64::from(n_across);
    let mut sum = Pixel::default();
    for (row, column) in (0..n_across).flat_map(|row| (0..n_across).map(move |column| (row, column))) {
        let u = x as f64 + step * (f64::from(column) + 0.5);
        let v = y as f64 + step * (f64::from(row) + 0.5);
        let sample = look(place, camera, [u, v], (2 * (row % 2) + column % 2) as usize);
        sum.light += sample.light;
        sum.toy += sample.toy;
        sum.shadow += sample.shadow;
    }
    let share = step * step;
    Pixel {
        light: share * sum.light,
        toy: share * sum.toy,
        shadow: share * sum.shadow,
    }
}

fn look(place: &Place<'_>, camera: &Camera, [u, v]: [f64; 2], pattern: usize) -> Pixel {
    let k = &camera.intrinsics;
    let in_camera = DVec3::new((u - k.cx_px) / k.fx_px, (k.cy_px - v) / k.fy_px, -1.0);
    let origin = camera.world_from_camera.w_axis.truncate();
    let direction = camera.world_from_camera.transform_vector3(in_camera);
    let Some(hit) = place.nearest(origin, direction, None) else {
        return Pixel {
            light: place.backdrop(),
            ..Pixel::default()
        };
    };
    let (light, visibility) = place.look(&hit, pattern);
    let is_toy = matches!(hit.thing, Thing::Body(_));
    Pixel {
        light,
        toy: if is_toy { 1.0 } else { 0.0 },
        shadow: if is_toy { 0.0 } else { 1.0 - visibility },
    }
}

impl Film {
    /// The picture in sRGB codes, with a gain per channel and with Gaussian noise of `noise_codes`.
    #[must_use]
    pub fn develop(&self, gain: DVec3, noise_codes: f64, seed: u64) -> Image {
        let mut noise = Random::new(seed);
        let codes = |light: &DVec3| {
            let [r, g, b] = (gain * *light).to_array().map(|light| {
                let grain = if noise_codes > 0.0 {
                    noise_codes * noise.normal()
                } else {
                    0.0
                };
                byte(encoded(light) + grain)
            });
            [r, g, b, 255]
        };
        self.image(self.light.iter().flat_map(codes).collect())
    }

    /// A mask: `self` shows the moved toy, `real` the real one.
    #[must_use]
    pub fn mask(&self, real: &Self) -> Image {
        let is_toy = |covered: f64| if covered >= 0.5 { 255 } else { 0 };
        let pixels = (0..self.light.len()).flat_map(|i| {
            [
                is_toy(self.toy[i]),
                is_toy(real.toy[i]),
                byte(255.0 * self.shadow[i]),
                byte(255.0 * real.shadow[i]),
            ]
        });
        self.image(pixels.collect())
    }

    fn image(&self, rgba8: Vec<u8>) -> Image {
        let [width_px, height_px] = self.size_px;
        Image {
            width_px,
            height_px,
            rgba8,
        }
    }
}

/// The sRGB code of linear light, before rounding. Source: IEC 61966-2-1.
fn encoded(linear: f64) -> f64 {
    let linear = linear.clamp(0.0, 1.0);
    let code = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    255.0 * code
}

fn byte(code: f64) -> u8 {
    #[allow(clippy::cast_possible_truncation, reason = "it is from 0 to 255 by then")]
    let byte = code.round().clamp(0.0, 255.0) as u8;
    byte
}
