//! Reflection of the receiver below the toy, estimated from the toy's image in it.
//!
//! Frame = gain ((plate - e s) M + e (s + t R)): e is the reflectance at a pixel's angle, s the
//! light of the surroundings, t the difference of the toy's light from it, R the part of the lobe
//! that the toy hides, and M the model of the unshadowed light. The plate holds e s. For a given
//! width of the lobe and M of the previous round the problem is linear, and is fitted by reweighted
//! least squares. Several widths are tried; the one with the smallest residual is used.

use glam::{DMat4, DVec3, DVec4, IVec2};
use nalgebra::{SMatrix, SVector};

use super::cast::{Caster, N_AMBIENT};
use super::lamp::Lamp;
use super::receiver_pixels::{ReceiverPixel, receiver_pixels};
use super::shadows::{LEAST_PIXELS, ROBUST_FAR, Shadows};
use crate::picture::{Level, Pyramid};
use crate::raster::{Rasterizer, project};
use crate::receivers::SeenReceiver;
use crate::robust;
use crate::shape::Shape;
use app_scene::reflection::Reflection;
use app_scene::scene::{Light, MAX_LIGHTS};

/// Widths of the lobe that are tried.
const ROUGHNESSES: [f64; 9] = [0.02, 0.035, 0.06, 0.09, 0.13, 0.18, 0.25, 0.35, 0.5];
/// Maximum number of pixels of the level in use.
const MOST_PIXELS: i32 = 135_000;
/// Sampling stride: one pixel in `STRIDE` is used.
const STRIDE: usize = 3;
/// Columns of gain, bounce, ambient light and lamps, followed by the surroundings and the toy.
const FIRST_AMBIENT: usize = 2;
const FIRST_LAMP: usize = FIRST_AMBIENT + N_AMBIENT;
const SURROUNDINGS: usize = FIRST_LAMP + MAX_LIGHTS;
const TOY: usize = SURROUNDINGS + 1;
const N_COLUMNS: usize = TOY + 1;
/// Rounds of reweighting.
const N_ROUNDS: usize = 5;
/// Scale of robust weights, in standard deviations.
const ROBUST: f64 = 5.0;
/// Prior that keeps an unobserved unknown at 0, relative to the energy of the gain's column.
const PRIOR: f64 = 1e-6;
/// Hidden part of the lobe from which on a pixel constrains the reflection.
const HIDDEN: f64 = 0.1;
/// Minimum number of such pixels.
const LEAST_HIDDEN: usize = 60;

/// Share of the residual without a reflection that one must explain, in the pixels that reflect the
/// toy.
///
/// Measured: tables of alpha .1 to .4 give .46 to .9, through a phone's pipeline .24 to .62 (.4 is
/// not detected there), a real desk .44; 40 matt ones give up to .13, and with the widest lobe .16.
const LEAST_EXPLAINED: f64 = 0.2;

/// Minimum difference in brightness between the toy and its surroundings in the reflection, as a
/// mean over the channels. Less can come from a misplaced shadow (.06 if a light is 3 degrees off),
/// and is hardly visible.
const LEAST_LIGHT: f64 = 0.12;

type Row = SVector<f64, N_COLUMNS>;

/// A reflection that explains a part of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FoundReflection {
    pub(crate) reflection: Reflection,
    /// Ratio of frame to plate in unchanged pixels.
    pub(crate) gain: [f64; 3],
}

/// Estimates the reflection of a toy in given lights. `None` if the receiver is matt, no plate
/// shows it without the toy, too little of it is visible, or lights leave no channel for it.
pub(crate) fn reflection(
    lights: &[Light],
    (shape, receivers): (&Shape, &[SeenReceiver]),
    pyramid: &Pyramid,
    world_from_camera: &DMat4,
) -> Option<FoundReflection> {
    let level = pyramid.largest_within(MOST_PIXELS);
    level.plate.as_ref()?;
    let camera_from_world = world_from_camera.inverse();
    let lamps = lights
        .iter()
        .map(|light| Lamp::new(light, &camera_from_world, shape.centre));
    let lamps = lamps.collect::<Option<Vec<_>>>()?;
    if lamps.len() >= MAX_LIGHTS {
        return None;
    }
    let mut raster = Rasterizer::default();
    let mut shadows = Shadows::new(&mut raster, (shape, receivers), level, None);
    if shadows.pixels.len() < LEAST_PIXELS {
        return None;
    }
    let shading = shadows.shading(&mut raster, &lamps, ROBUST_FAR);
    shadows.light(&lamps, &shading);
    let evidence = Evidence::of(&shadows, &shadows.taken_of_all(&mut raster, &lamps));
    let without = evidence.fit(None, &evidence.start());
    let mut trial = |roughness: f64| {
        let image = Image::of(&mut raster, &shadows.caster, &shadows.pixels, roughness);
        let seen = evidence.seen(&image);
        Trial {
            roughness,
            fit: evidence.fit(Some(&seen), &without.factors),
            seen,
        }
    };
    let trials = ROUGHNESSES.map(&mut trial);
    let best = (0..trials.len()).min_by(|a, b| trials[*a].left().total_cmp(&trials[*b].left()))?;
    let between = between(&trials, best)?;
    let finer = trial(between);
    let best = if finer.left() < trials[best].left() {
        &finer
    } else {
        &trials[best]
    };
    best.found(&without)
}

/// A width of the lobe that is tried.
struct Trial {
    roughness: f64,
    /// Reflectance of each pixel, and its product with the part of the lobe that the toy hides.
    seen: Vec<[f64; 2]>,
    fit: Fit,
}

impl Trial {
    fn left(&self) -> f64 {
        self.fit.losses.iter().sum()
    }

    /// The reflection of this trial, if it explains enough of the residual without it.
    fn found(&self, without: &Fit) -> Option<FoundReflection> {
        let is_hidden = |seen: &[f64; 2]| seen[1] > HIDDEN * seen[0];
        let hidden: Vec<usize> = (0..self.seen.len())
            .filter(|index| is_hidden(&self.seen[*index]))
            .collect();
        let left = |fit: &Fit| -> f64 { hidden.iter().map(|index| fit.losses[*index]).sum() };
        let factors = &self.fit.factors;
        let gain = [0, 1, 2].map(|channel: usize| factors[channel][0]);
        let toy_light = [0, 1, 2].map(|channel: usize| (factors[channel][TOY] / gain[channel]).abs());
        let is_constrained = hidden.len() >= LEAST_HIDDEN
            && left(&self.fit) <= (1.0 - LEAST_EXPLAINED) * left(without)
            && toy_light.iter().sum::<f64>() >= 3.0 * LEAST_LIGHT;
        #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
        let light =
            |column: usize| [0, 1, 2].map(|channel: usize| (factors[channel][column] / gain[channel]) as f32);
        (is_constrained && gain.iter().all(|gain| *gain > 0.0)).then(|| FoundReflection {
            reflection: Reflection {
                roughness: self.roughness,
                surroundings: light(SURROUNDINGS),
                toy_above_surroundings: light(TOY),
            },
            gain,
        })
    }
}

/// The width with the smallest residual, from the parabola through the best trial and its
/// neighbours. `None` if it is the widest, which is indistinguishable from ambient light.
fn between(trials: &[Trial], best: usize) -> Option<f64> {
    let place = |index: usize| trials[index].roughness.ln();
    if best + 1 >= trials.len() {
        return None;
    }
    if best == 0 {
        return Some(trials[0].roughness);
    }
    let [[x0, y0], [x1, y1], [x2, y2]] =
        [best - 1, best, best + 1].map(|index| [place(index), trials[index].left()]);
    let [down, up] = [(x1 - x0) * (y1 - y2), (x1 - x2) * (y1 - y0)];
    let turn = down - up;
    let step = (x1 - x0) * down - (x1 - x2) * up;
    Some(if turn.abs() > f64::MIN_POSITIVE {
        (x1 - 0.5 * step / turn).clamp(x0, x2).exp()
    } else {
        x1.exp()
    })
}

/// Observation of a level's receiver: the index of each pixel, the reflectance and the part of the
/// lobe that the toy hides.
pub(crate) fn reflected(
    (shape, receivers): (&Shape, &[SeenReceiver]),
    level: &Level,
    reflection: &Reflection,
) -> Vec<(IVec2, f64, f64)> {
    let mut raster = Rasterizer::default();
    let corners = project(shape.points.iter().copied(), &level.intrinsics);
    let coverage = raster.coverage(&corners, &shape.faces, level.frame.size_px);
    let pixels = receiver_pixels(
        level,
        (&coverage, None),
        receivers,
        (shape.centre, shape.radius_m),
        |_| true,
    );
    let caster = Caster::new(shape, receivers, level.intrinsics, level.frame.size_px);
    let image = Image::of(&mut raster, &caster, &pixels, reflection.roughness);
    let first = pixels.iter().enumerate().filter(|(_, pixel)| pixel.receiver == 0);
    first
        .map(|(index, pixel)| {
            (
                pixel.at,
                image.reflectances[index],
                f64::from(image.hidden[index]),
            )
        })
        .collect()
}

/// The toy's image in the first receiver.
struct Image {
    /// Reflectance at each pixel's angle.
    reflectances: Vec<f64>,
    /// Part of the lobe that the toy hides, for each pixel.
    hidden: Vec<f32>,
}

impl Image {
    fn of(raster: &mut Rasterizer, caster: &Caster<'_>, pixels: &[ReceiverPixel], roughness: f64) -> Self {
        let lobe = Reflection {
            roughness,
            surroundings: [0.0; 3],
            toy_above_surroundings: [0.0; 3],
        };
        let Some(receiver) = caster.receivers.first() else {
            return Self {
                reflectances: vec![0.0; pixels.len()],
                hidden: vec![0.0; pixels.len()],
            };
        };
        let plane_from_camera = &receiver.plane_from_camera;
        let eye = plane_from_camera.w_axis.truncate();
        let foot = plane_from_camera
            .transform_point3(caster.shape.centre)
            .with_y(0.0);
        let eyes: Vec<DVec4> = lobe.mirrored_eyes(eye, foot);
        let reflectance = |pixel: &ReceiverPixel| {
            let to_eye: DVec3 = eye - plane_from_camera.transform_point3(pixel.point);
            lobe.reflectance(to_eye.normalize_or(DVec3::Y).y)
        };
        Self {
            reflectances: pixels.iter().map(reflectance).collect(),
            hidden: caster.image(raster, pixels, &eyes),
        }
    }
}

/// Pixels of the first receiver.
struct Evidence {
    /// Their indices among all pixels.
    places: Vec<usize>,
    pixels: Vec<ReceiverPixel>,
    /// Rows relative to the plate; the last two columns are 0.
    rows: Vec<Row>,
    n_columns: usize,
}

/// A fit's solution, and each pixel's residual.
struct Fit {
    factors: [Row; 3],
    losses: Vec<f64>,
}

impl Evidence {
    fn of(shadows: &Shadows<'_>, taken: &[Vec<f32>]) -> Self {
        let shaded = shadows.shaded(taken);
        let all = shadows
            .pixels
            .iter()
            .enumerate()
            .filter(|(_, pixel)| pixel.receiver == 0);
        let places: Vec<usize> = all.map(|(index, _)| index).step_by(STRIDE).collect();
        let row = |index: &usize| {
            let mut row = Row::zeros();
            row[0] = 1.0;
            let hidden = f64::from(shaded.ambient[*index][0]);
            row[1] = hidden * (1.0 - hidden);
            for part in 0..N_AMBIENT {
                row[FIRST_AMBIENT + part] = -f64::from(shaded.ambient[*index][part]);
            }
            for (lamp, taken) in taken.iter().enumerate() {
                row[FIRST_LAMP + lamp] = -f64::from(taken[*index]);
            }
            row
        };
        Self {
            pixels: places.iter().map(|index| shadows.pixels[*index]).collect(),
            rows: places.iter().map(row).collect(),
            n_columns: FIRST_LAMP + taken.len(),
            places,
        }
    }

    /// The start values, which reproduce the plate.
    fn start(&self) -> [Row; 3] {
        let mut lit = Row::zeros();
        lit[0] = 1.0;
        [lit; 3]
    }

    /// Reflectance of each pixel, and its product with the part of the lobe that the toy hides.
    fn seen(&self, image: &Image) -> Vec<[f64; 2]> {
        let places = self.places.iter();
        places
            .map(|index| {
                let reflectance = image.reflectances[*index];
                [reflectance, reflectance * f64::from(image.hidden[*index])]
            })
            .collect()
    }

    fn fit(&self, seen: Option<&[[f64; 2]]>, start: &[Row; 3]) -> Fit {
        let mut fit = Fit {
            factors: *start,
            losses: vec![0.0; self.pixels.len()],
        };
        for _ in 0..N_ROUNDS {
            fit.losses.fill(0.0);
            for channel in 0..3 {
                fit.factors[channel] = self.refit(seen, &fit.factors[channel], channel, &mut fit.losses);
            }
        }
        fit
    }

    /// A pixel's equation, from the current estimate of its light.
    fn equation(&self, index: usize, channel: usize, seen: Option<&[[f64; 2]]>, known: &Row) -> Row {
        let row = &self.rows[index];
        let mut equation = row * f64::from(self.pixels[index].plate[channel]);
        if let Some(seen) = seen {
            let model = row.dot(known) / known[0].max(f64::MIN_POSITIVE);
            equation[SURROUNDINGS] = seen[index][0] * (1.0 - model);
            equation[TOY] = seen[index][1];
        }
        equation
    }

    fn refit(&self, seen: Option<&[[f64; 2]]>, known: &Row, channel: usize, losses: &mut [f64]) -> Row {
        let mut normal: SMatrix<f64, N_COLUMNS, N_COLUMNS> = SMatrix::zeros();
        let mut side = Row::zeros();
        let n_known = if seen.is_some() { N_COLUMNS } else { self.n_columns };
        for (index, pixel) in self.pixels.iter().enumerate() {
            let precision = f64::from(pixel.precision[channel]);
            if precision <= 0.0 {
                continue;
            }
            let equation = self.equation(index, channel, seen, known);
            let value = f64::from(pixel.frame[channel]);
            let square = precision * (value - equation.dot(known)).powi(2);
            losses[index] += robust::loss(square, ROBUST * ROBUST);
            let weight = precision * robust::weight(square / (ROBUST * ROBUST));
            for j in 0..n_known {
                let scaled = weight * equation[j];
                if scaled != 0.0 {
                    side[j] += scaled * value;
                    for i in j..n_known {
                        normal[(i, j)] += scaled * equation[i];
                    }
                }
            }
        }
        let prior = PRIOR * normal[(0, 0)].max(f64::MIN_POSITIVE);
        for j in 0..N_COLUMNS {
            normal[(j, j)] += prior;
        }
        let solved = normal.cholesky().map(|factor| factor.solve(&side));
        match solved {
            Some(solved) if solved[SURROUNDINGS] >= 0.0 => solved,
            Some(_) => {
                // The light of the surroundings is not negative.
                for i in 0..N_COLUMNS {
                    normal[(i, SURROUNDINGS)] = 0.0;
                    normal[(SURROUNDINGS, i)] = 0.0;
                }
                normal[(SURROUNDINGS, SURROUNDINGS)] = 1.0;
                side[SURROUNDINGS] = 0.0;
                normal.cholesky().map_or(*known, |factor| factor.solve(&side))
            }
            None => *known,
        }
    }
}
