//! Finds the upper sides of things, by measured points, by the bounds to which a thing grows, or by the
//! shadow.

use super::by_shadow;
use super::extent::{Extent, Outline, is_exact};
use super::grown::Grown;
use super::inner::{most_on, pixels};
use super::measured::Measured;
use super::planes::{Candidate, FoundPlane, GROUND, Place, Search};
use super::seeds::Colored;
use crate::lights::Comparison;
use crate::picture::Level;
use crate::raster::Rasterizer;
use app_scene::scene::MAX_RECEIVERS;

/// Maximum number of things whose planes are searched: more receivers are not moved.
const MOST_SEARCHED: usize = MAX_RECEIVERS - 1;

/// Finds the planes of a level's things: their upper sides.
pub(super) fn find(
    place: &Place<'_>,
    level: &Level,
    comparison: &Comparison,
    (grown, colored): (&Grown, Colored),
) -> Vec<FoundPlane> {
    let (shape, receivers) = (place.shape, place.receivers);
    // Each search takes a second: only the largest things are searched.
    let mut things: Vec<usize> = (0..grown.n_things()).collect();
    things.sort_by_key(|thing| std::cmp::Reverse(grown.n_seeds(*thing)));
    things.truncate(MOST_SEARCHED);
    let planes = things.into_iter().filter_map(|thing| {
        let pixels = pixels(comparison, grown, thing);
        let on = most_on(&pixels)?;
        let search = || Search::new((shape, receivers), level, comparison, &pixels);
        let outline = Outline {
            level,
            table: receivers.get(GROUND)?,
            grown,
            thing,
            colored,
            points: None,
            is_bounded_by_points: place.are_things_of_points,
        };
        let by_points = |points| {
            let outline = Outline {
                points: Some(points),
                ..outline
            };
            let mut about = search()?;
            about.measured = Some(Measured::of(&outline, about.middle)?);
            Some((found(about, &outline)?, points))
        };
        // Points with noise are one start of two: on a ramp, 5 mm of noise ended 1.5 degrees too flat.
        let found = match place.points.iter().find_map(by_points) {
            Some((measured, points)) if is_exact(points) => measured,
            Some((measured, _)) => [found(search()?, &outline), Some(measured)]
                .into_iter()
                .flatten()
                .min_by(|a, b| a.report.losses[1].total_cmp(&b.report.losses[1]))?,
            None => in_pictures(&search()?, &outline)?,
        };
        Some(FoundPlane {
            instead_of: (on != GROUND && found.is_near(&receivers[on])).then_some(on),
            ..found
        })
    });
    planes.collect()
}

/// The plane by what the pictures show: by the thing's pixels, or else by all that are in a shadow. A level one
/// by these is refused: a block's top came out some millimetres too low, in place of the points of its side.
fn in_pictures(search: &Search<'_>, outline: &Outline<'_>) -> Option<FoundPlane> {
    let raster = &mut Rasterizer::default();
    let by_own = search.best_plane(raster);
    let found = by_own.and_then(|first| clearer(search, first, outline));
    found.or_else(|| {
        let (about, first) = search.best_among_shadows(raster)?;
        clearer(&about, first, outline).filter(|found| found.report.tilt_rad > 0.0)
    })
}

/// The plane within the bounds to which the thing grows, or within those by the shadow if only they are
/// known or the plate shows them more clearly.
fn clearer(search: &Search<'_>, first: Candidate, outline: &Outline<'_>) -> Option<FoundPlane> {
    let grown = found_from(search.clone(), &first, outline);
    let by_shadow = by_shadow::found(search.clone(), first, outline);
    match (grown, by_shadow) {
        (Some(grown), Some(by_shadow)) if by_shadow.contrast < grown.contrast => Some(grown),
        (grown, by_shadow) => by_shadow.or(grown),
    }
}

/// Searches for a thing's plane, first with all of its pixels, then with those of its upper side.
fn found(search: Search<'_>, outline: &Outline<'_>) -> Option<FoundPlane> {
    let first = search.best_plane(&mut Rasterizer::default())?;
    found_from(search, &first, outline)
}

/// The same after a first search.
fn found_from(search: Search<'_>, first: &Candidate, outline: &Outline<'_>) -> Option<FoundPlane> {
    let raster = &mut Rasterizer::default();
    let endless = search.plane(&first.heights).plane_from_camera;
    let extent = Extent::of(outline, &endless, first.is_level)?;
    let search = search.within(&extent.plane(&endless));
    let heights = first.heights;
    let plane = search.refined(raster, &[[heights[0], 0.0, 0.0]], &[heights])?;
    let losses = search.significant_losses(raster, &plane, outline.colored)?;
    let endless = search.plane(&plane.heights).plane_from_camera;
    let extent = Extent::of(outline, &endless, plane.is_level)?;
    Some(search.reported(&extent, (&endless, &plane), outline.level, losses))
}
