//! The upright sides of a thing with a level top, such as a box: rectangles between the edges of the
//! top and the receiver below.

use std::collections::HashSet;

use glam::{DMat4, DVec2, DVec3, IVec2, Vec3Swizzles};

use super::edges::{self, face_contrast};
use super::extent::LEVEL;
use super::grown::Grown;
use super::inner::certain;
use super::listed::{self, LEAST_M};
use super::planes::{FoundPlane, GROUND, Place, Search};
use crate::lights::{Compared, Comparison};
use crate::picture::{Level, places};
use crate::raster::Rasterizer;
use crate::receivers::{SeenReceiver, receiver_at};
use crate::report::PlaneAlignment;
use app_scene::scene::MAX_RECEIVERS;

/// Largest distance in metres between a side and a receiver that it lies along.
const ALONG_M: f64 = 0.012;
/// Least pixels of a side in the level; and the least part of them that shows a thing, or the least
/// contrast of both its upper and its lower edge in the plate: if a side has neither, the shadow has to
/// prove it. Seven sides of six books have contrasts of .24 to 2.4, and one has .1; below a listed top no
/// thing is searched if the top explains the shadow.
const LEAST_PIXELS: usize = 80;
const FILLED: f64 = 0.6;
const CLEAR: f64 = 0.2;
/// Least pixels of a side beside the toy for a comparison of losses.
const LEAST_COMPARED: usize = 60;
/// Outward directions in the space of the top.
const OUTWARD: [DVec3; 4] = [DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];

/// A side with the pixels of a level that show it.
struct Side {
    plane: SeenReceiver,
    half_m: DVec2,
    pixels: Vec<IVec2>,
    /// Whether the plate shows it, by a thing or by its edges.
    is_seen: bool,
}

/// Adds to a level's found planes the corrected listed ones, and the sides of level ones. `seen` are
/// the things that the level shows. Where a thing in the place's own colours ends is not seen, so the
/// shadow has to prove its sides.
pub(super) fn with_sides(
    place: &Place<'_>,
    (level, seen): (&Level, Option<&Grown>),
    comparison: &Comparison,
    mut planes: Vec<FoundPlane>,
) -> Vec<FoundPlane> {
    let listed = listed::corrected(place, level, comparison).into_iter();
    let is_known = |listed: &FoundPlane| planes.iter().any(|found| found.instead_of == listed.instead_of);
    let listed: Vec<FoundPlane> = listed.filter(|listed| !is_known(listed)).collect();
    planes.extend(listed);
    let upright = upright(place, (level, seen), comparison, &planes);
    planes.extend(upright);
    planes
}

/// The upright sides of level planes, as many as there may be receivers, the largest in the picture
/// first. The planes are the place's receivers above the ground, and those that were found.
fn upright(
    place: &Place<'_>,
    (level, grown): (&Level, Option<&Grown>),
    comparison: &Comparison,
    planes: &[FoundPlane],
) -> Vec<FoundPlane> {
    let mut known = place.receivers.to_vec();
    for found in planes {
        match found.instead_of {
            Some(index) => known[index] = found.plane.clone(),
            None => known.push(found.plane.clone()),
        }
    }
    let mut all: Vec<Side> = (GROUND + 1..known.len())
        .flat_map(|top| {
            let others = known.iter().enumerate().filter(|(index, _)| *index != top);
            let others: Vec<SeenReceiver> = others.map(|(_, other)| other.clone()).collect();
            sides(level, grown, &known[top], &others)
        })
        .collect();
    all.sort_by_key(|side| std::cmp::Reverse(side.pixels.len()));
    let raster = &mut Rasterizer::default();
    let taken = all.into_iter().filter_map(|side| {
        let losses = losses(place, level, comparison, &side, raster)?;
        Some(FoundPlane {
            report: PlaneAlignment {
                height_m: side.half_m.y,
                tilt_rad: std::f64::consts::FRAC_PI_2,
                half_extent_m: side.half_m.to_array(),
                losses,
            },
            plane: side.plane,
            instead_of: None,
            contrast: 0.0,
        })
    });
    taken.take(MAX_RECEIVERS.saturating_sub(known.len())).collect()
}

/// Losses of the known receivers and of a side; 0 if the toy hides one that is seen, for which
/// the place of the top counts alone. `None` if the picture contradicts the side.
fn losses(
    place: &Place<'_>,
    level: &Level,
    comparison: &Comparison,
    side: &Side,
    raster: &mut Rasterizer,
) -> Option<[f64; 2]> {
    let shown: HashSet<IVec2> = side.pixels.iter().copied().collect();
    let pixels: Vec<&Compared> = certain(comparison)
        .filter(|pixel| shown.contains(&pixel.at))
        .collect();
    match Search::new((place.shape, place.receivers), level, comparison, &pixels) {
        Some(search) if pixels.len() >= LEAST_COMPARED => {
            search.agreed_losses(raster, &side.plane, !side.is_seen)
        }
        _ => side.is_seen.then_some([0.0; 2]),
    }
}

/// The sides of a level top that are visible; `others` are the other receivers, of which the first
/// one is below it.
fn sides(level: &Level, grown: Option<&Grown>, top: &SeenReceiver, others: &[SeenReceiver]) -> Vec<Side> {
    let Some(height_m) = others.first().and_then(|table| height_m(top, table)) else {
        return Vec::new();
    };
    let sides = OUTWARD
        .into_iter()
        .map(|outward| (outward, side(top, outward, height_m)));
    let sides = sides.filter(|(_, (plane, _))| !others.iter().any(|other| is_along(plane, other)));
    let seen = sides.filter_map(|(outward, (plane, half_m))| {
        let all: Vec<SeenReceiver> = [&plane, top].into_iter().chain(others).cloned().collect();
        let is_seen =
            |at: &IVec2| receiver_at(&all, &level.intrinsics, *at).is_some_and(|(index, _)| index == 0);
        let pixels: Vec<IVec2> = places(level.frame.size_px).filter(is_seen).collect();
        let is_thing = |at: &&IVec2| grown.is_some_and(|grown| grown.of_pixel(**at).is_some());
        let n_thing = pixels.iter().filter(is_thing).count();
        let is_filled = n_thing as f64 >= FILLED * pixels.len() as f64;
        let edge = edge(top, outward, &others[GROUND]);
        (pixels.len() >= LEAST_PIXELS).then(|| Side {
            is_seen: is_filled || face_contrast(&edge, &top.plane_from_camera, level) > CLEAR,
            plane,
            half_m,
            pixels,
        })
    });
    seen.collect()
}

/// Whether a side lies along a receiver, such as a wall.
fn is_along(side: &SeenReceiver, receiver: &SeenReceiver) -> bool {
    let receiver_from_side = receiver.own_from_plane(&side.plane_from_camera);
    receiver_from_side.y_axis.y > LEVEL && receiver_from_side.w_axis.y.abs() < ALONG_M
}

/// Height of a level top above a receiver; `None` if it is tilted, or hardly above it.
fn height_m(top: &SeenReceiver, table: &SeenReceiver) -> Option<f64> {
    let table_from_top = table.own_from_plane(&top.plane_from_camera);
    let height_m = table_from_top.w_axis.y;
    (table_from_top.y_axis.y > LEVEL && height_m > LEAST_M).then_some(height_m)
}

/// The edge of a top above a side, in the top's own plane.
fn edge(top: &SeenReceiver, outward: DVec3, table: &SeenReceiver) -> edges::Side {
    let half_m = top.half_extent_m();
    let outward = outward.xz();
    edges::Side {
        middle: outward * half_m,
        outward,
        half_m: outward.perp().abs().dot(half_m),
        foot_from_plane: Some(table.own_from_plane(&top.plane_from_camera)),
    }
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
