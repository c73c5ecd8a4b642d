//! The upright sides of a thing with a level top, such as a box: rectangles between the edges of the
//! top and the receiver below.

use glam::{DMat4, DVec2, DVec3, IVec2};

use super::grown::Grown;
use crate::picture::{Level, places};
use crate::receivers::{SeenReceiver, receiver_at};

/// Smallest cosine between a level top and the receiver, and least height of it in metres.
const LEVEL: f64 = 0.9998;
const LEAST_M: f64 = 0.004;
/// Largest distance in metres between a side and a receiver that it lies along.
const ALONG_M: f64 = 0.012;
/// Least pixels of a side in the level, and the least part of them that shows a thing.
const LEAST_PIXELS: usize = 80;
const FILLED: f64 = 0.6;
/// Outward directions in the space of the top.
const OUTWARD: [DVec3; 4] = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];

/// A side with the pixels of a level that show it.
pub(super) struct Side {
    pub(super) plane: SeenReceiver,
    pub(super) half_m: DVec2,
    pub(super) pixels: Vec<IVec2>,
}

/// The sides of a level top that are visible and show a thing; `others` are the other receivers, of
/// which the first one is below it.
pub(super) fn sides(level: &Level, grown: &Grown, top: &SeenReceiver, others: &[SeenReceiver]) -> Vec<Side> {
    let Some(height_m) = others.first().and_then(|table| height_m(top, table)) else {
        return Vec::new();
    };
    let sides = OUTWARD.into_iter().map(|outward| side(top, outward, height_m));
    let sides = sides.filter(|(plane, _)| !others.iter().any(|other| is_along(plane, other)));
    let seen = sides.filter_map(|(plane, half_m)| {
        let all: Vec<SeenReceiver> = [&plane, top].into_iter().chain(others).cloned().collect();
        let is_seen =
            |at: &IVec2| receiver_at(&all, &level.intrinsics, *at).is_some_and(|(index, _)| index == 0);
        let pixels: Vec<IVec2> = places(level.frame.size_px).filter(is_seen).collect();
        let n_thing = pixels.iter().filter(|at| grown.of_pixel(**at).is_some()).count();
        let is_filled = n_thing as f64 >= FILLED * pixels.len() as f64;
        (pixels.len() >= LEAST_PIXELS && is_filled).then_some(Side {
            plane,
            half_m,
            pixels,
        })
    });
    seen.collect()
}

/// Whether a side lies along a receiver, such as a wall.
fn is_along(side: &SeenReceiver, receiver: &SeenReceiver) -> bool {
    let receiver_from_side = receiver.plane_from_camera * side.plane_from_camera.inverse();
    receiver_from_side.y_axis.y > LEVEL && receiver_from_side.w_axis.y.abs() < ALONG_M
}

/// Height of a level top above a receiver; `None` if it is tilted, or hardly above it.
fn height_m(top: &SeenReceiver, table: &SeenReceiver) -> Option<f64> {
    let table_from_top = table.plane_from_camera * top.plane_from_camera.inverse();
    let height_m = table_from_top.w_axis.y;
    (table_from_top.y_axis.y > LEVEL && height_m > LEAST_M).then_some(height_m)
}

/// The side below an edge of a top, with half its width and height.
fn side(top: &SeenReceiver, outward: DVec3, height_m: f64) -> (SeenReceiver, DVec2) {
    let along = outward.cross(DVec3::NEG_Y);
    let half = top.half_extent_m();
    let half = DVec3::new(half.x, 0.0, half.y);
    let middle = outward * half - 0.5 * height_m * DVec3::Y;
    let half_m = DVec2::new(along.abs().dot(half), 0.5 * height_m);
    let top_from_side = DMat4::from_cols(
        along.extend(0.0),
        outward.extend(0.0),
        DVec3::NEG_Y.extend(0.0),
        middle.extend(1.0),
    );
    let side_from_camera = top_from_side.inverse() * top.plane_from_camera;
    (SeenReceiver::of_size(side_from_camera, half_m), half_m)
}
