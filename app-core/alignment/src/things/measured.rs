//! Fits a plane to a depth sensor's points on a thing.
//!
//! The points on the receiver around the thing calibrate the sensor: its offset and tilt, its noise,
//! and the errors that neighbouring points share.

use std::collections::HashMap;

use glam::{DMat3, DVec2, DVec3, IVec2, Vec3Swizzles};

use super::extent::Outline;
use super::groups::cross;
use crate::median::{DEVIATION_OF_MEDIAN, median, part_of};

/// Least points on a thing, and on the receiver around it.
const LEAST_POINTS: usize = 40;
/// Distance of a point from the thing's outline, in pixels of the level: closer ones may be mixed.
const WITHIN_PX: i32 = 3;
/// Largest height of a point on the receiver, in metres.
pub(super) const ON_TABLE_M: f64 = 0.025;
/// Largest distance of such a point from the thing's middle, in metres.
const AROUND_M: f64 = 0.3;
/// Least noise in metres.
const LEAST_NOISE_M: f64 = 5e-4;
/// Side of the cells in pixels of the level whose means show the errors that neighbours share, the
/// least points of a cell, and the least cells.
const CELL_PX: i32 = 32;
const LEAST_IN_CELL: usize = 20;
const LEAST_CELLS: usize = 4;
/// Largest distance from the plane of its points, in deviations of the noise, and the least part of
/// the thing's points that are on it.
const MOST_OFF: f64 = 2.5;
const LEAST_ON: f64 = 0.5;
/// First heights, as parts of the thing's points below them, and first slopes with their directions,
/// beside a level one.
const PARTS: [f64; 4] = [0.3, 0.5, 0.7, 0.9];
const SLOPES: [f64; 2] = [0.12, 0.3];
const N_SIDES: usize = 8;
const N_ROUNDS: usize = 8;
/// Least deviation of a height in metres, and of a slope.
const HEIGHT_M: f64 = 1e-3;
const SLOPE: f64 = 0.02;
/// Least part of these deviations that is left for exact points: a tenth of a millimetre.
const EXACT: f64 = 0.1;
/// Deviation of the shared errors if they are unknown, in metres.
const SHARED_M: f64 = 5e-3;

/// The plane of a thing by its points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// Height above the receiver at a place of it, and rise over metres along either axis.
    height_m: f64,
    slope: DVec2,
    /// Deviations of both.
    deviation_m: f64,
    slope_deviation: f64,
}

impl Measured {
    /// The plane about the thing's middle on the receiver; `None` if the points are too few, or on
    /// no plane. Points are in camera space.
    pub(super) fn of(outline: &Outline<'_>, middle: DVec2) -> Option<Self> {
        let measured = outline.points?;
        let mut on_thing = Vec::new();
        let mut on_table = Vec::new();
        for point in &measured.points {
            let Some(at) = outline.level.intrinsics.pixel_of(*point) else {
                continue;
            };
            let place = outline.table.plane_from_camera.transform_point3(*point);
            let at = at.floor().as_ivec2();
            if is_within(outline, at, Some(outline.thing)) {
                on_thing.push(place - DVec3::new(middle.x, 0.0, middle.y));
            } else if is_within(outline, at, None)
                && place.y.abs() < ON_TABLE_M
                && place.xz().distance(middle) < AROUND_M
            {
                let cell = at.div_euclid(IVec2::splat(CELL_PX));
                on_table.push((cell, place - DVec3::new(middle.x, 0.0, middle.y)));
            }
        }
        if on_thing.len() < LEAST_POINTS || on_table.len() < LEAST_POINTS {
            return None;
        }
        let [least_noise_m, least_m, least_slope] = least(measured.deviation_m);
        let table = of_table(on_table.iter().map(|(_, point)| *point))?;
        for point in on_table.iter_mut().map(|(_, point)| point).chain(&mut on_thing) {
            point.y = above_m(point, table);
        }
        let away_m = on_table.iter().map(|(_, point)| point.y.abs());
        let noise_m = (DEVIATION_OF_MEDIAN * median(away_m, f64::total_cmp)?).max(least_noise_m);
        let (plane, n, size_m) = fitted(&on_thing, noise_m)?;
        let deviation_m = (noise_m / n.sqrt()).hypot(shared_m(&on_table));
        Some(Self {
            height_m: plane.x,
            slope: plane.yz(),
            deviation_m: deviation_m.hypot(least_m),
            slope_deviation: (deviation_m / size_m.max(HEIGHT_M)).hypot(least_slope),
        })
    }

    /// Its height, and its rise over a size of the thing along either axis.
    pub(super) fn heights(&self, size_m: f64) -> [f64; 3] {
        [self.height_m, size_m * self.slope.x, size_m * self.slope.y]
    }

    /// Squared distance of another plane, in deviations.
    pub(super) fn square(&self, [height_m, along_x, along_z]: &[f64; 3], size_m: f64) -> f64 {
        let slope = DVec2::new(*along_x, *along_z) / size_m;
        let off = (height_m - self.height_m) / self.deviation_m;
        off * off + (slope - self.slope).length_squared() / (self.slope_deviation * self.slope_deviation)
    }
}

/// Deviation of the mean error of neighbouring points on the receiver, each with its cell.
fn shared_m(on_table: &[(IVec2, DVec3)]) -> f64 {
    let mut cells: HashMap<[i32; 2], Vec<f64>> = HashMap::new();
    for (cell, point) in on_table {
        cells.entry(cell.to_array()).or_default().push(point.y);
    }
    let full = cells
        .values()
        .filter(|heights_m| heights_m.len() >= LEAST_IN_CELL);
    let away_m: Vec<f64> = full
        .map(|heights_m| (heights_m.iter().sum::<f64>() / heights_m.len() as f64).abs())
        .collect();
    if away_m.len() < LEAST_CELLS {
        return SHARED_M;
    }
    median(away_m, f64::total_cmp).map_or(SHARED_M, |away_m| DEVIATION_OF_MEDIAN * away_m)
}

/// Whether a pixel and those around it are of a thing, or of none.
fn is_within(outline: &Outline<'_>, at: IVec2, thing: Option<usize>) -> bool {
    cross(at, WITHIN_PX).all(|at| outline.grown.of_pixel(at) == thing)
}

/// The plane of the points on the receiver, which is level and at 0 for a sensor without error.
pub(super) fn of_table(points: impl Iterator<Item = DVec3> + Clone) -> Option<DVec3> {
    let offset_m = median(points.clone().map(|point| point.y), f64::total_cmp)?;
    let away_m = points.clone().map(|point| (point.y - offset_m).abs());
    let spread_m = DEVIATION_OF_MEDIAN * median(away_m, f64::total_cmp)?;
    let all: Vec<DVec3> = points.collect();
    let mut plane = DVec3::new(offset_m, 0.0, 0.0);
    for _ in 0..N_ROUNDS {
        plane = nearer(&all, plane, MOST_OFF * spread_m.max(LEAST_NOISE_M))?;
    }
    Some(plane)
}

/// Least noise in metres, and least deviations of a height in metres and of a slope, for points of a
/// stated deviation.
fn least(deviation_m: Option<f64>) -> [f64; 3] {
    let part = deviation_m.map_or(1.0, |deviation_m| (deviation_m / HEIGHT_M).clamp(EXACT, 1.0));
    [LEAST_NOISE_M, HEIGHT_M, SLOPE].map(|least| part * least)
}

/// The plane on which most points are, from many starts, with their number and their deviation along
/// it in metres.
fn fitted(points: &[DVec3], noise_m: f64) -> Option<(DVec3, f64, f64)> {
    let mut heights_m: Vec<f64> = points.iter().map(|point| point.y).collect();
    heights_m.sort_unstable_by(f64::total_cmp);
    let height_m = |part: f64| heights_m[part_of(heights_m.len() - 1, part)];
    let sides =
        (0..N_SIDES).map(|side| DVec2::from_angle(std::f64::consts::TAU * side as f64 / N_SIDES as f64));
    let sloped = sides.flat_map(|side| SLOPES.map(|slope| slope * side));
    let slopes: Vec<DVec2> = std::iter::once(DVec2::ZERO).chain(sloped).collect();
    let most_m = MOST_OFF * noise_m;
    let starts = PARTS
        .iter()
        .flat_map(|part| slopes.iter().map(move |slope| (*part, *slope)));
    let ends = starts.filter_map(|(part, slope)| {
        let mut plane = DVec3::new(height_m(part), slope.x, slope.y);
        for _ in 0..N_ROUNDS {
            plane = nearer(points, plane, most_m)?;
        }
        Some((loss(points, plane, most_m), plane))
    });
    let (_, plane) = ends.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let on: Vec<DVec2> = on(points, plane, most_m).map(|point| point.xz()).collect();
    if (on.len() as f64) < LEAST_ON * points.len() as f64 {
        return None;
    }
    let n = on.len() as f64;
    let middle = on.iter().sum::<DVec2>() / n;
    let size_m = (on.iter().map(|at| at.distance_squared(middle)).sum::<f64>() / (2.0 * n)).sqrt();
    Some((plane, n, size_m))
}

/// Height of a point above a plane, which is its height at the origin and its slopes.
pub(super) fn above_m(point: &DVec3, plane: DVec3) -> f64 {
    point.y - plane.dot(DVec3::new(1.0, point.x, point.z))
}

/// The points on a plane.
fn on(points: &[DVec3], plane: DVec3, most_m: f64) -> impl Iterator<Item = &DVec3> {
    points
        .iter()
        .filter(move |point| above_m(point, plane).abs() < most_m)
}

/// The plane of least squares through the points on a plane; `None` if they are on a line.
fn nearer(points: &[DVec3], plane: DVec3, most_m: f64) -> Option<DVec3> {
    let (mut squares, mut heights) = (DMat3::ZERO, DVec3::ZERO);
    for point in on(points, plane, most_m) {
        let row = DVec3::new(1.0, point.x, point.z);
        squares += DMat3::from_cols(row.x * row, row.y * row, row.z * row);
        heights += point.y * row;
    }
    let nearer = squares.inverse() * heights;
    (squares.determinant() > 0.0 && nearer.is_finite()).then_some(nearer)
}

fn loss(points: &[DVec3], plane: DVec3, most_m: f64) -> f64 {
    let of_point = |point: &DVec3| (above_m(point, plane) / most_m).powi(2).min(1.0);
    points.iter().map(of_point).sum::<f64>() / points.len() as f64
}
