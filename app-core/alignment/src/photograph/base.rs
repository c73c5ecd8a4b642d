//! The table around the toy's base, where the toy's shadow begins.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec3Swizzles};

use crate::picture::{Level, places};
use crate::receivers::{SeenReceiver, receiver_at};
use crate::shape::Shape;
use app_scene::things::Mark;

/// Height of the base over that of the toy.
const BASE: f64 = 0.1;
/// Reach around the base over the toy's height: with .2 to .3 the lights of nine books and ramps were
/// found, with .45 one ramp was not.
const REACH: f64 = 0.25;

/// Distance between points of the base that count, over the reach.
const APART: f64 = 0.25;

/// Marks of a level's pixels that do not show the table around the toy's base; `None` without a
/// table, or if no point of the toy is close to it.
pub(super) fn marks_beyond(shape: &Shape, receivers: &[SeenReceiver], level: &Level) -> Option<Vec<Mark>> {
    let table = receivers.first()?;
    let on_table = |point: DVec3| table.plane_from_camera.transform_point3(point);
    let points: Vec<DVec3> = shape.points.iter().map(|point| on_table(*point)).collect();
    let height_m = points.iter().map(|point| point.y).fold(0.0, f64::max);
    let reach_m = REACH * height_m;
    let base = base(&points, (BASE * height_m, APART * reach_m));
    let (min, max) = base
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), at| {
            (min.min(*at), max.max(*at))
        });
    let mark = |at| {
        let is_around = receiver_at(receivers, &level.intrinsics, at).is_some_and(|(receiver, point)| {
            let at = on_table(point).xz();
            receiver == 0
                && at.distance(at.clamp(min, max)) <= reach_m
                && base.iter().any(|base| at.distance(*base) <= reach_m)
        });
        if is_around { Mark::None } else { Mark::Thing }
    };
    (!base.is_empty()).then(|| places(level.frame.size_px).map(mark).collect())
}

/// Points of the lowest part of a toy, seen from above, one in each cell.
fn base(points: &[DVec3], (most_m, cell_m): (f64, f64)) -> Vec<DVec2> {
    let lowest = points.iter().filter(|point| point.y <= most_m);
    let of_cells: BTreeMap<[i64; 2], DVec2> = lowest
        .map(|point| ((point.xz() / cell_m).floor().as_i64vec2().to_array(), point.xz()))
        .collect();
    of_cells.into_values().collect()
}
