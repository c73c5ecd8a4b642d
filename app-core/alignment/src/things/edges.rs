//! Moves the sides of a rectangle on a plane to edges that the plate shows.
//!
//! A side that faces the camera above an upright face has two edges: its own, and that of the face
//! with the receiver below. Both must be seen, so that one is not taken for the other. Other sides
//! move to the nearest edge.

use std::ops::RangeInclusive;

use glam::{DMat4, DVec2, DVec3, Vec3Swizzles};

use crate::picture::{Color, Level};

/// Steps of a pixel of the level, and range of the search about a side in steps: for a side with a
/// face below it, and for another.
const STEPS_A_PX: f64 = 2.0;
const WITH_FACE: RangeInclusive<i32> = -60..=12;
const NEAR: RangeInclusive<i32> = -5..=9;
/// Distance in metres within which the edge of a listed plane is searched, the most steps of that,
/// those within which it is where it is listed, and the least contrast over that of the clearest
/// edge there. With these the sides of a book that is listed exactly stay, and of one that is listed
/// 10 mm too large or too small they come to within 7 mm.
/// They do not help if a pattern repeats as far apart as the plane is off: of a book with squares of
/// 10 mm that is listed 10 mm too large, all four sides stay. A line of squares within `AS_LISTED`
/// has a contrast of 1.23, .47, 1.11 and .78, the true edge one of .54, .28, 1.45 and .25.
/// The clearest line above a face that the camera sees is the true edge there, with 1.3 times the
/// contrast; but a side of the same book listed exactly would move to a line 12 mm inside, with 2.4
/// times.
const LISTED_M: f64 = 0.013;
const MOST_STEPS: f64 = 100.0;
const AS_LISTED: i32 = 3;
const CLEAR: f64 = 0.5;
/// Distance of the compared colours from an edge, in pixels.
const BESIDE_PX: f64 = 1.25;
/// Number of places along a side, and the part of it that they cover.
const N_PLACES: i32 = 60;
const COVERED: f64 = 0.8;
/// Least number of visible places.
const LEAST_PLACES: u32 = 20;
/// Least contrast of an edge, in logarithms of light.
const LEAST: f64 = 0.06;
/// Least light, for logarithms.
const DARKEST: f32 = 1e-3;

/// A side of a rectangle: its middle, the direction out of the rectangle, and half its length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) middle: DVec2,
    pub(super) outward: DVec2,
    pub(super) half_m: f64,
    /// Height of the upright face below it; `None` without one.
    pub(super) face_m: Option<f64>,
}

/// Distance in metres by which a side on a plane moves outward.
pub(super) fn moved_m(side: &Side, plane_from_camera: &DMat4, level: &Level) -> f64 {
    let seen = SeenSide::of(side, plane_from_camera, level);
    let Some(px_m) = seen.px_m() else { return 0.0 };
    let face_m = seen.face_m();
    let contrast = |step: i32| seen.edge(px_m, step, face_m);
    let step = match face_m {
        Some(_) => clearest(WITH_FACE, contrast),
        None => nearest(NEAR, contrast, |_, _| LEAST),
    };
    step.map_or(0.0, |step| px_m * step_px(step))
}

/// Distance in metres by which a listed side moves outward: to the nearest clear edge, or not at all
/// if that is as near as can be told.
pub(super) fn clearer_m(side: &Side, plane_from_camera: &DMat4, level: &Level) -> f64 {
    let seen = SeenSide::of(side, plane_from_camera, level);
    let Some(px_m) = seen.px_m() else { return 0.0 };
    let face_m = seen.face_m();
    #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
    let most = (STEPS_A_PX * LISTED_M / px_m).min(MOST_STEPS).ceil() as i32;
    // Stripes of a thing are as clear as its edge, which may be any where it is listed.
    let least = |step: i32, largest: f64| {
        if step.abs() > AS_LISTED {
            LEAST.max(CLEAR * largest)
        } else {
            LEAST
        }
    };
    let nearest = nearest(-most..=most, |step| seen.edge(px_m, step, face_m), least);
    let moved = nearest.filter(|step| step.abs() > AS_LISTED);
    moved.map_or(0.0, |step| px_m * step_px(step))
}

/// Contrast of a side where it is, in logarithms of light; `None` if too little of it is visible.
pub(super) fn contrast(side: &Side, plane_from_camera: &DMat4, level: &Level) -> Option<f64> {
    let seen = SeenSide::of(side, plane_from_camera, level);
    seen.contrast((0.0, 0.0), BESIDE_PX * seen.px_m()?)
}

/// The smaller contrast of a side and of its upright face's foot, where that is largest among the places
/// that count as where the side is; 0 if the face is not seen.
pub(super) fn face_contrast(side: &Side, plane_from_camera: &DMat4, level: &Level) -> f64 {
    let seen = SeenSide::of(side, plane_from_camera, level);
    let (Some(px_m), Some(face_m)) = (seen.px_m(), seen.face_m()) else {
        return 0.0;
    };
    let smaller = |step: i32| {
        let [upper, lower] = [0.0, face_m].map(|down_m| seen.line(px_m, step, down_m));
        upper.min(lower)
    };
    (-AS_LISTED..=AS_LISTED).map(smaller).fold(0.0, f64::max)
}

/// The step of most contrast.
fn clearest(steps: RangeInclusive<i32>, contrast: impl Fn(i32) -> f64) -> Option<i32> {
    let all = steps.map(|step| (contrast(step), step));
    let clearest = all.max_by(|a, b| a.0.total_cmp(&b.0));
    clearest
        .filter(|(contrast, _)| *contrast > LEAST)
        .map(|(_, step)| step)
}

/// The step of a peak of the contrast that is nearest to 0. `least` is the contrast that a step
/// needs, by the largest of all.
fn nearest(
    steps: RangeInclusive<i32>,
    contrast: impl Fn(i32) -> f64,
    least: impl Fn(i32, f64) -> f64,
) -> Option<i32> {
    let first = *steps.start();
    let contrasts: Vec<f64> = steps.map(contrast).collect();
    let largest = contrasts.iter().copied().fold(0.0, f64::max);
    let peaks = contrasts.windows(3).zip(first + 1..).filter(|(around, step)| {
        around[1] > least(*step, largest) && around[1] >= around[0] && around[1] > around[2]
    });
    peaks.map(|(_, step)| step).min_by_key(|step| step.abs())
}

fn step_px(step: i32) -> f64 {
    f64::from(step) / STEPS_A_PX
}

struct SeenSide<'a> {
    side: &'a Side,
    camera_from_plane: DMat4,
    level: &'a Level,
}

impl<'a> SeenSide<'a> {
    fn of(side: &'a Side, plane_from_camera: &DMat4, level: &'a Level) -> Self {
        Self {
            side,
            camera_from_plane: plane_from_camera.inverse(),
            level,
        }
    }

    /// Height of the upright face below it, if that is turned to the camera.
    fn face_m(&self) -> Option<f64> {
        self.side.face_m.filter(|_| self.faces_camera())
    }

    /// Contrast of the edge at a step, with that at the face's foot if there is one.
    fn edge(&self, px_m: f64, step: i32, face_m: Option<f64>) -> f64 {
        let at = |down_m: f64| self.line(px_m, step, down_m);
        face_m.map_or(at(0.0), |face_m| (at(0.0) * at(face_m)).sqrt())
    }

    /// Contrast of a line at a step, some distance below the side; 0 if too little of it is visible.
    fn line(&self, px_m: f64, step: i32, down_m: f64) -> f64 {
        let contrast = self.contrast((px_m * step_px(step), down_m), BESIDE_PX * px_m);
        contrast.unwrap_or(0.0)
    }

    /// Whether the camera is on the outer side.
    fn faces_camera(&self) -> bool {
        let eye = self.camera_from_plane.inverse().w_axis.truncate();
        (eye.xz() - self.side.middle).dot(self.side.outward) > 0.0
    }

    /// Pixel of a place on the plane, or below it.
    fn pixel(&self, at: DVec2, down_m: f64) -> Option<DVec2> {
        let point = DVec3::new(at.x, -down_m, at.y);
        let in_camera = self.camera_from_plane.transform_point3(point);
        self.level.intrinsics.pixel_of(in_camera)
    }

    /// Metres across the side that a pixel shows.
    fn px_m(&self) -> Option<f64> {
        const APART_M: f64 = 1e-4;
        let [a, b] =
            [0.0, APART_M].map(|out_m| self.pixel(self.side.middle + out_m * self.side.outward, 0.0));
        let (a, b) = a.zip(b)?;
        let along = [-1.0, 1.0].map(|end| {
            self.pixel(
                self.side.middle + end * self.side.half_m * self.side.outward.perp(),
                0.0,
            )
        });
        let (from, to) = along[0].zip(along[1])?;
        let across = (to - from).try_normalize()?.perp();
        let moved_px = (b - a).dot(across).abs();
        (moved_px > 0.0).then(|| APART_M / moved_px)
    }

    /// Difference of the mean logarithms of light on both sides of an edge, some distance outside of
    /// the side and below it; `None` if too little of it is visible.
    fn contrast(&self, (out_m, down_m): (f64, f64), beside_m: f64) -> Option<f64> {
        let plate = self.level.plate.as_ref()?;
        let (mut sum, mut n) = ([0.0; 3], 0_u32);
        for place in 0..N_PLACES {
            let part = COVERED * (2.0 * f64::from(place) / f64::from(N_PLACES - 1) - 1.0);
            let at = self.side.middle + part * self.side.half_m * self.side.outward.perp();
            let color = |out_m: f64| plate.sample(self.pixel(at + out_m * self.side.outward, down_m)?);
            if let Some((inside, outside)) = color(out_m - beside_m).zip(color(out_m + beside_m)) {
                n += 1;
                let log = |color: Color, channel: usize| f64::from(color[channel].max(DARKEST).ln());
                sum = [0, 1, 2].map(|channel| sum[channel] + log(inside, channel) - log(outside, channel));
            }
        }
        let square: f64 = sum.iter().map(|sum| sum * sum).sum();
        (n >= LEAST_PLACES).then(|| square.sqrt() / f64::from(n))
    }
}
