//! The table around the toy's base, where the toy's shadow begins.

use glam::{DVec2, DVec3, Vec3Swizzles};

use crate::picture::{Level, places};
use crate::receivers::SeenReceiver;
use crate::shape::Shape;
use app_scene::things::Mark;

/// Height of the base over that of the toy.
const BASE: f64 = 0.1;
/// Reach around the base over the toy's height: with .2 to .3 the lights of nine books and ramps were
/// found, with .45 one ramp was not.
const REACH: f64 = 0.25;

/// Marks of a level's pixels that do not show the table around the toy's base; `None` without a
/// table or a toy above it.
pub(super) fn marks_beyond(shape: &Shape, receivers: &[SeenReceiver], level: &Level) -> Option<Vec<Mark>> {
    let table = receivers.first()?;
    let on_table = |point: DVec3| table.plane_from_camera.transform_point3(point);
    let points: Vec<DVec3> = shape.points.iter().map(|point| on_table(*point)).collect();
    let height_m = points.iter().map(|point| point.y).fold(0.0, f64::max);
    let base = points.iter().filter(|point| point.y <= BASE * height_m);
    let base: Vec<DVec2> = base.map(|point| point.xz()).collect();
    let (min, max) = base
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), at| {
            (min.min(*at), max.max(*at))
        });
    if base.is_empty() {
        return None;
    }
    let reach_m = REACH * height_m;
    let mark = |at| {
        let is_around = table.point_at(&level.intrinsics, at).is_some_and(|point| {
            let at = on_table(point).xz();
            at.distance(at.clamp(min, max)) <= reach_m
                && base.iter().any(|base| at.distance(*base) <= reach_m)
        });
        if is_around { Mark::None } else { Mark::Thing }
    };
    Some(places(level.frame.size_px).map(mark).collect())
}
