//! Finds things by exact points: they stand on the receiver under the toy, and the picture shows
//! that the toy's shadow does not fall on the receiver there.
//!
//! Pictures alone show a thing by colours that differ from the place's; points also show one of the
//! same material.

use glam::{DVec3, IVec2};

use super::extent::is_exact;
use super::groups::{groups, in_level};
use super::grown::{Grown, LEAST_ALONE};
use super::measured::{ON_TABLE_M, above_m, of_table};
use super::seeds::is_unexplained;
use crate::lights::Compared;
use crate::measured_points::MeasuredPoints;
use crate::picture::{Level, index_in, places};
use crate::receivers::SeenReceiver;

/// Least height of a point on a thing, in metres: more than the noise of points of 1 mm, and less than a
/// thin book.
const LEAST_M: f64 = 0.003;
/// Least points on the receiver.
const LEAST_POINTS: usize = 1000;

/// The things that exact points show, of which the pictures contradict the receivers; `None` without
/// any. `grown` are those that the pictures show.
pub(super) fn standing(
    grown: Option<&Grown>,
    (measured, receivers): (&[MeasuredPoints], &[SeenReceiver]),
    level: &Level,
    compared: &[Compared],
) -> Option<Grown> {
    let exact = measured.iter().find(|measured| is_exact(measured))?;
    let stands = places_above(grown, exact, receivers.first()?, level)?;
    let size_px = level.frame.size_px;
    let is_unexplained = in_level(size_px, compared, false, is_unexplained);
    let groups = groups(size_px, |index| stands[index]).into_iter();
    let counted = groups.map(|group| {
        (
            group.iter().filter(|index| is_unexplained[**index]).count(),
            group,
        )
    });
    // As many as one that pictures alone show. A ramp of the table's own wood has 803, and once its
    // plane is known none.
    let things: Vec<_> = counted.filter(|(n, _)| *n >= LEAST_ALONE).collect();
    (!things.is_empty()).then(|| Grown::of_groups(size_px, &things))
}

/// For each pixel of the level, whether points stand above the receiver there; `None` if too few are
/// on the receiver.
fn places_above(
    grown: Option<&Grown>,
    measured: &MeasuredPoints,
    table: &SeenReceiver,
    level: &Level,
) -> Option<Vec<bool>> {
    let place = |point: &DVec3| table.plane_from_camera.transform_point3(*point);
    let is_table = |point: &&DVec3| {
        let seen = level.intrinsics.pixel_of(**point);
        let shown = seen.and_then(|at| grown?.of_pixel(at.floor().as_ivec2()));
        shown.is_none() && place(point).y.abs() < ON_TABLE_M
    };
    let on_table: Vec<DVec3> = measured.points.iter().filter(is_table).map(place).collect();
    if on_table.len() < LEAST_POINTS {
        return None;
    }
    let plane = of_table(on_table.iter().copied())?;
    let mut is_standing = vec![false; (measured.size_px.x * measured.size_px.y) as usize];
    for (at, point) in measured.places.iter().zip(&measured.points) {
        if let Some(index) = index_in(measured.size_px, *at) {
            is_standing[index] = above_m(&place(point), plane) > LEAST_M;
        }
    }
    let size_px = level.frame.size_px;
    let per_px = measured.size_px.as_dvec2() / size_px.as_dvec2();
    let stands = |at: IVec2| {
        let at = ((at.as_dvec2() + 0.5) * per_px).floor().as_ivec2();
        index_in(measured.size_px, at).is_some_and(|index| is_standing[index])
    };
    Some(places(size_px).map(stands).collect())
}
