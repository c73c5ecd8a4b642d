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
/// Least height in metres of an upright face.
const LEAST_FACE_M: f64 = 0.004;
/// Standard errors by which a contrast exceeds one that varies along the line, as a pattern's does.
const SURE: f64 = 2.0;
/// Least contrast at a step where side and foot have peaks, over the largest one. A book of wood on terrazzo
/// has .9: its side has a contrast of .07, and the foot one of .6; a line of the terrazzo has .11. A front with
/// a shadow along its foot has no such step.
const AT_PEAKS: f64 = 0.7;
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
    /// The space of the receiver down to which an upright face reaches; `None` without such a face.
    pub(super) foot_from_plane: Option<DMat4>,
}

/// Distance in metres by which a side on a plane moves outward.
pub(super) fn moved_m(side: &Side, plane_from_camera: &DMat4, level: &Level) -> f64 {
    let seen = SeenSide::of(side, plane_from_camera, level);
    let Some(px_m) = seen.px_m() else { return 0.0 };
    let step = if seen.has_face() {
        seen.above_face(px_m)
    } else {
        nearest(NEAR, |step| seen.edge(px_m, step, false), |_, _| LEAST)
    };
    step.map_or(0.0, |step| px_m * step_px(step))
}

/// Distance in metres by which a listed side moves outward: to the nearest clear edge, or not at all
/// if that is as near as can be told.
pub(super) fn clearer_m(side: &Side, plane_from_camera: &DMat4, level: &Level) -> f64 {
    let seen = SeenSide::of(side, plane_from_camera, level);
    let Some(px_m) = seen.px_m() else { return 0.0 };
    let has_face = seen.has_face();
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
    let nearest = nearest(-most..=most, |step| seen.edge(px_m, step, has_face), least);
    let moved = nearest.filter(|step| step.abs() > AS_LISTED);
    moved.map_or(0.0, |step| px_m * step_px(step))
}

/// Contrast of a side where it is, in logarithms of light, with that of its upright face's foot if the
/// face is seen; `None` if too little of it is visible.
pub(super) fn contrast(side: &Side, plane_from_camera: &DMat4, level: &Level) -> Option<f64> {
    let seen = SeenSide::of(side, plane_from_camera, level);
    let px_m = seen.px_m()?;
    let own = seen.contrast((0.0, Line::Own), BESIDE_PX * px_m)?;
    let with_foot = |step: i32| seen.edge(px_m, step, true);
    let best = || (-AS_LISTED..=AS_LISTED).map(with_foot).fold(0.0, f64::max);
    Some(if seen.has_face() { best() } else { own })
}

/// The smaller contrast of a side and of its upright face's foot, where that is largest among the places
/// that count as where the side is; 0 if the face is not seen.
pub(super) fn face_contrast(side: &Side, plane_from_camera: &DMat4, level: &Level) -> f64 {
    let seen = SeenSide::of(side, plane_from_camera, level);
    let Some(px_m) = seen.px_m().filter(|_| seen.has_face()) else {
        return 0.0;
    };
    let smaller = |step: i32| {
        let [upper, lower] = [Line::Own, Line::Foot].map(|line| seen.line(px_m, step, line));
        upper.min(lower)
    };
    (-AS_LISTED..=AS_LISTED).map(smaller).fold(0.0, f64::max)
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

/// Whether values have a peak at an index, or next to it.
fn has_peak(values: &[f64], at: usize) -> bool {
    let is_peak = |at: usize| {
        let around = &values[at.saturating_sub(1)..values.len().min(at + 2)];
        around.iter().all(|value| *value <= values[at])
    };
    (at.saturating_sub(1)..values.len().min(at + 2)).any(is_peak)
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

    /// Whether an upright face below it is turned to the camera.
    fn has_face(&self) -> bool {
        let height_m = |foot_from_plane: DMat4| {
            let middle = DVec3::new(self.side.middle.x, 0.0, self.side.middle.y);
            foot_from_plane.transform_point3(middle).y
        };
        let is_high = self
            .side
            .foot_from_plane
            .is_some_and(|foot| height_m(foot) > LEAST_FACE_M);
        is_high && self.faces_camera()
    }

    /// The step at which a side and the foot of its upright face have most contrast together. If both
    /// have a peak there, it is most likely the side's: a side that is taken for its foot, or for the edge of
    /// the face's own shadow, has a line of a pattern in place of one of them.
    fn above_face(&self, px_m: f64) -> Option<i32> {
        let of = |line: Line| {
            WITH_FACE
                .map(|step| self.sure(px_m, step, line))
                .collect::<Vec<f64>>()
        };
        let (own, foot) = (of(Line::Own), of(Line::Foot));
        let both = |at: &usize| (own[*at] * foot[*at]).sqrt();
        let clearest = |steps: &mut dyn Iterator<Item = usize>| {
            steps
                .max_by(|a, b| both(a).total_cmp(&both(b)))
                .filter(|at| both(at) > LEAST)
        };
        let all = clearest(&mut (0..own.len()))?;
        let at_peaks = clearest(&mut (0..own.len()).filter(|at| has_peak(&own, *at) && has_peak(&foot, *at)));
        let at = at_peaks
            .filter(|at| both(at) > AT_PEAKS * both(&all))
            .unwrap_or(all);
        WITH_FACE.clone().nth(at)
    }

    /// Contrast of the edge at a step, with that at the face's foot if there is one.
    fn edge(&self, px_m: f64, step: i32, has_face: bool) -> f64 {
        let at = |line: Line| self.sure(px_m, step, line);
        if has_face {
            (at(Line::Own) * at(Line::Foot)).sqrt()
        } else {
            at(Line::Own)
        }
    }

    /// Contrast of a line at a step; 0 if too little of it is visible.
    fn line(&self, px_m: f64, step: i32, line: Line) -> f64 {
        let contrast = self.contrast((px_m * step_px(step), line), BESIDE_PX * px_m);
        contrast.unwrap_or(0.0)
    }

    /// The same without what the contrast's own variation along the line explains.
    fn sure(&self, px_m: f64, step: i32, line: Line) -> f64 {
        let difference = self.difference((px_m * step_px(step), line), BESIDE_PX * px_m);
        difference.map_or(0.0, |(mean, error)| (mean - SURE * error).max(0.0))
    }

    /// Whether the camera is on the outer side.
    fn faces_camera(&self) -> bool {
        let eye = self.camera_from_plane.inverse().w_axis.truncate();
        (eye.xz() - self.side.middle).dot(self.side.outward) > 0.0
    }

    /// Pixel of a place on the plane, or straight below it.
    fn pixel(&self, at: DVec2, line: Line) -> Option<DVec2> {
        let on_plane = DVec3::new(at.x, 0.0, at.y);
        let below = |foot_from_plane: &DMat4| {
            let foot = foot_from_plane.transform_point3(on_plane) * DVec3::new(1.0, 0.0, 1.0);
            foot_from_plane.inverse().transform_point3(foot)
        };
        let point = match line {
            Line::Own => on_plane,
            Line::Foot => below(self.side.foot_from_plane.as_ref()?),
        };
        let in_camera = self.camera_from_plane.transform_point3(point);
        self.level.intrinsics.pixel_of(in_camera)
    }

    /// Metres across the side that a pixel shows.
    fn px_m(&self) -> Option<f64> {
        const APART_M: f64 = 1e-4;
        let [a, b] =
            [0.0, APART_M].map(|out_m| self.pixel(self.side.middle + out_m * self.side.outward, Line::Own));
        let (a, b) = a.zip(b)?;
        let along = [-1.0, 1.0].map(|end| {
            self.pixel(
                self.side.middle + end * self.side.half_m * self.side.outward.perp(),
                Line::Own,
            )
        });
        let (from, to) = along[0].zip(along[1])?;
        let across = (to - from).try_normalize()?.perp();
        let moved_px = (b - a).dot(across).abs();
        (moved_px > 0.0).then(|| APART_M / moved_px)
    }

    /// Difference of the mean logarithms of light on both sides of a line, some distance outside of
    /// the side; `None` if too little of it is visible.
    fn contrast(&self, at: (f64, Line), beside_m: f64) -> Option<f64> {
        self.difference(at, beside_m).map(|(mean, _)| mean)
    }

    /// The same with its standard error.
    fn difference(&self, (out_m, line): (f64, Line), beside_m: f64) -> Option<(f64, f64)> {
        let plate = self.level.plate.as_ref()?;
        let (mut sum, mut squares, mut n) = ([0.0; 3], 0.0, 0_u32);
        for place in 0..N_PLACES {
            let part = COVERED * (2.0 * f64::from(place) / f64::from(N_PLACES - 1) - 1.0);
            let at = self.side.middle + part * self.side.half_m * self.side.outward.perp();
            let color = |out_m: f64| plate.sample(self.pixel(at + out_m * self.side.outward, line)?);
            if let Some((inside, outside)) = color(out_m - beside_m).zip(color(out_m + beside_m)) {
                n += 1;
                let log = |color: Color, channel: usize| f64::from(color[channel].max(DARKEST).ln());
                let difference = [0, 1, 2].map(|channel| log(inside, channel) - log(outside, channel));
                squares += difference.iter().map(|value| value * value).sum::<f64>();
                sum = [0, 1, 2].map(|channel| sum[channel] + difference[channel]);
            }
        }
        let n_places = f64::from(n);
        let square = sum.iter().map(|sum| sum * sum).sum::<f64>() / (n_places * n_places);
        let error = ((squares / n_places - square).max(0.0) / n_places).sqrt();
        (n >= LEAST_PLACES).then_some((square.sqrt(), error))
    }
}

/// A line along a side.
#[derive(Clone, Copy)]
enum Line {
    /// The side itself.
    Own,
    /// The foot of the face below it.
    Foot,
}
