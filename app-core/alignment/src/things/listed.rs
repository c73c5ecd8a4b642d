//! Corrects listed planes of things, such as the top of a book that a tracker gave some millimetres
//! off or larger than it is: height and tilt by the toy's shadow, extents by edges of the plate.

use glam::{DMat4, DVec2, DVec3, DVec4, IVec2};

use super::extent::{Extent, LEVEL};
use super::inner::certain;
use super::planes::{FoundPlane, GROUND, Nearer, Place, Search};
use crate::lights::{Compared, Comparison};
use crate::picture::{Level, places};
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;
use crate::report::PlaneAlignment;
use app_scene::scene::Intrinsics;
use app_scene::things::Mark;

/// Least cosine between the normals of a plane that is corrected and of the receiver: steeper ones
/// also hide light and have shadows, but stay as they are listed.
const LEAST_COSINE: f64 = 0.85;
/// Least height in metres above the receiver: of a listed plane's centre, and of a level top with
/// sides.
pub(super) const LEAST_M: f64 = 0.004;
/// Width in metres of the border that may not show the plane: listed ones are up to a centimetre too
/// large.
const BORDER_M: f64 = 0.01;
/// Least pixels for a search of height and tilt: with fewer, the least shadow of a tilted plane
/// would be nearly all of them.
const LEAST_PIXELS: usize = 300;
/// Largest distance in metres between a listed plane and the true one, at its centre: further away
/// it is another plane.
const MOST_M: f64 = 0.006;

/// Marks of a level's pixels that may show the listed planes of things, or the sides below them;
/// `None` if there are no such planes.
pub(crate) fn marks_of_listed(receivers: &[SeenReceiver], level: &Level) -> Option<Vec<Mark>> {
    let is_shown = solids(receivers, level, BORDER_M)?;
    let mark = |at| if is_shown(at) { Mark::Thing } else { Mark::None };
    Some(places(level.frame.size_px).map(mark).collect())
}

/// Whether a pixel of a level shows the planes of things, which are a border larger, or the sides below
/// them; `None` if there are no such planes.
pub(super) fn solids(
    receivers: &[SeenReceiver],
    level: &Level,
    border_m: f64,
) -> Option<impl Fn(IVec2) -> bool + use<>> {
    let table = receivers.get(GROUND)?;
    let tops = receivers.iter().skip(GROUND + 1);
    let solids: Vec<Solid> = tops
        .filter(|top| height_m(top, table).is_some())
        .map(|top| Solid::new(slices(top, table, border_m).collect(), level))
        .collect();
    let (has_tops, intrinsics) = (!solids.is_empty(), level.intrinsics);
    let is_shown = move |at| solids.iter().any(|solid| solid.is_shown(&intrinsics, at));
    Some(is_shown).filter(|_| has_tops)
}

/// What is below a top, in slices.
struct Solid {
    slices: Vec<SeenReceiver>,
    /// The rectangle of pixels beyond which none of them is seen.
    first_px: IVec2,
    last_px: IVec2,
}

impl Solid {
    fn new(slices: Vec<SeenReceiver>, level: &Level) -> Self {
        let corners = slices.iter().flat_map(SeenReceiver::corners);
        let corners: Option<Vec<DVec2>> = corners.map(|corner| level.intrinsics.pixel_of(corner)).collect();
        let size_px = level.frame.size_px.as_dvec2();
        // A corner behind the camera has no pixel.
        let corners = corners.unwrap_or_else(|| vec![DVec2::ZERO, size_px]);
        let of = |extreme: fn(DVec2, DVec2) -> DVec2, from: DVec2| {
            let px = corners.iter().copied().fold(from, extreme);
            px.clamp(DVec2::ZERO, size_px).floor().as_ivec2()
        };
        Self {
            first_px: of(DVec2::min, size_px),
            last_px: of(DVec2::max, DVec2::ZERO),
            slices,
        }
    }

    fn is_shown(&self, intrinsics: &Intrinsics, at: IVec2) -> bool {
        let is_near = at.cmpge(self.first_px).all() && at.cmple(self.last_px).all();
        is_near
            && self
                .slices
                .iter()
                .any(|slice| slice.point_at(intrinsics, at).is_some())
    }
}

/// The solid below a top, a border larger, from the largest height at which that may be down to the table: the
/// top lowered towards the table, in as many steps as the border hides the gaps of.
fn slices(top: &SeenReceiver, table: &SeenReceiver, border_m: f64) -> impl Iterator<Item = SeenReceiver> {
    let table_from_top = table.own_from_plane(&top.plane_from_camera);
    let half_m = top.half_extent_m();
    let DMat4 {
        x_axis,
        z_axis,
        w_axis,
        ..
    } = table_from_top;
    let highest_m = w_axis.y + half_m.x * x_axis.y.abs() + half_m.y * z_axis.y.abs();
    let reach_m = highest_m + MOST_M;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a hundred at most"
    )]
    let n = (reach_m / (0.5 * border_m)).ceil().clamp(1.0, 100.0) as u32;
    let camera_from_table = table.plane_from_camera.inverse();
    (0..=n).map(move |index| {
        let at_m = reach_m * f64::from(index) / f64::from(n);
        let (part, above_m) = ((at_m / highest_m).min(1.0), (at_m - highest_m).max(0.0));
        let lowered = |axis: DVec4| DVec4::new(axis.x, part * axis.y, axis.z, axis.w);
        let origin = lowered(w_axis) + above_m * DVec4::Y;
        let table_from_slice = DMat4::from_cols(lowered(x_axis), DVec4::Y, lowered(z_axis), origin);
        let camera_from_slice = camera_from_table * table_from_slice;
        SeenReceiver::of_size(camera_from_slice.inverse(), half_m + border_m)
    })
}

/// Height of a listed plane's centre above the table; `None` if it is no top of a thing.
fn height_m(listed: &SeenReceiver, table: &SeenReceiver) -> Option<f64> {
    let table_from_listed = table.own_from_plane(&listed.plane_from_camera);
    let height_m = table_from_listed.w_axis.y;
    (table_from_listed.y_axis.y >= LEAST_COSINE && height_m >= LEAST_M).then_some(height_m)
}

/// The listed planes that are off, corrected.
pub(super) fn corrected(place: &Place<'_>, level: &Level, comparison: &Comparison) -> Vec<FoundPlane> {
    (GROUND + 1..place.receivers.len())
        .filter_map(|index| corrected_plane(place, (level, comparison), index))
        .collect()
}

fn corrected_plane(
    place: &Place<'_>,
    (level, comparison): (&Level, &Comparison),
    index: usize,
) -> Option<FoundPlane> {
    let (table, listed) = (&place.receivers[GROUND], &place.receivers[index]);
    height_m(listed, table)?;
    let by_shadow = by_shadow(place, (level, comparison), listed);
    let plane_from_camera = by_shadow
        .as_ref()
        .map_or(listed.plane_from_camera, |nearer| nearer.plane_from_camera);
    let as_listed = Extent::of_plane(listed, &plane_from_camera);
    let height_m = as_listed.height_m(&plane_from_camera, table);
    let tilt = table.own_from_plane(&plane_from_camera).y_axis.y;
    let foot = (tilt > LEVEL).then_some(table);
    let by_edges = as_listed
        .clearer(level, &plane_from_camera, foot)
        .filter(|extent| {
            let larger = extent.plane(&plane_from_camera);
            is_agreed(place, (level, comparison), &larger, listed)
        });
    if by_shadow.is_none() && by_edges.is_none() {
        return None;
    }
    let extent = by_edges.unwrap_or(as_listed);
    Some(FoundPlane {
        plane: extent.plane(&plane_from_camera),
        instead_of: Some(index),
        contrast: 0.0,
        report: PlaneAlignment {
            height_m,
            tilt_rad: tilt.clamp(-1.0, 1.0).acos(),
            half_extent_m: extent.half_m.to_array(),
            losses: by_shadow.map_or([0.0; 2], |nearer| nearer.losses),
        },
    })
}

/// Whether the toy's shadow agrees with a plane where it reaches beyond the listed one: its edge may be a line
/// of the table's pattern.
fn is_agreed(
    place: &Place<'_>,
    (level, comparison): (&Level, &Comparison),
    larger: &SeenReceiver,
    listed: &SeenReceiver,
) -> bool {
    let has = |plane: &SeenReceiver, at| plane.point_at(&level.intrinsics, at).is_some();
    let pixels: Vec<&Compared> = certain(comparison)
        .filter(|pixel| has(larger, pixel.at) && !has(listed, pixel.at))
        .collect();
    let search = Search::new((place.shape, place.receivers), level, comparison, &pixels);
    search.is_none_or(|search| {
        let losses = search.agreed_losses(&mut Rasterizer::default(), larger, false);
        losses.is_some()
    })
}

/// The plane by the toy's shadow on it; `None` if the listed one explains it.
fn by_shadow(
    place: &Place<'_>,
    (level, comparison): (&Level, &Comparison),
    listed: &SeenReceiver,
) -> Option<Nearer> {
    let half_m = listed.half_extent_m();
    let inner = SeenReceiver::of_size(listed.plane_from_camera, (half_m - BORDER_M).max(0.5 * half_m));
    let pixels: Vec<&Compared> = certain(comparison)
        .filter(|pixel| inner.point_at(&level.intrinsics, pixel.at).is_some())
        .collect();
    if pixels.len() < LEAST_PIXELS {
        return None;
    }
    let search = Search::new((place.shape, place.receivers), level, comparison, &pixels)?;
    let nearer = search.nearer(&mut Rasterizer::default(), listed)?;
    let centre = listed.plane_from_camera.inverse().transform_point3(DVec3::ZERO);
    let off_m = nearer.plane_from_camera.transform_point3(centre).y.abs();
    (off_m < MOST_M).then_some(nearer)
}
