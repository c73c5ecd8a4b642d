//! Upright sides of things with a level top, as receivers.

use std::collections::HashSet;

use glam::IVec2;

use super::grown::Grown;
use super::planes::{FoundPlane, GROUND, NOISE, NOISIEST, Search};
use super::sides::{Side, sides};
use crate::lights::{Compared, Comparison};
use crate::picture::Level;
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;
use crate::report::PlaneAlignment;
use crate::shape::Shape;
use app_scene::scene::MAX_RECEIVERS;

/// Least pixels of an upright side beside the toy for a comparison of losses.
const LEAST_OF_SIDE: usize = 60;

/// The upright sides of level planes, as many as there may be receivers, the largest in the picture
/// first.
pub(super) fn sides_of(
    (shape, receivers): (&Shape, &[SeenReceiver]),
    (level, grown): (&Level, &Grown),
    comparison: &Comparison,
    planes: &[FoundPlane],
) -> Vec<FoundPlane> {
    let mut known = receivers.to_vec();
    for found in planes {
        match found.instead_of {
            Some(index) => known[index] = found.plane.clone(),
            None => known.push(found.plane.clone()),
        }
    }
    let mut all: Vec<Side> = (GROUND + 1..known.len())
        .flat_map(|top| {
            let others: Vec<SeenReceiver> = known
                .iter()
                .enumerate()
                .filter(|(index, _)| *index != top)
                .map(|(_, other)| other.clone())
                .collect();
            sides(level, grown, &known[top], &others)
        })
        .collect();
    all.sort_by_key(|side| std::cmp::Reverse(side.pixels.len()));
    let raster = &mut Rasterizer::default();
    let taken = all.into_iter().filter_map(|side| {
        let shown: HashSet<IVec2> = side.pixels.iter().copied().collect();
        let pixels: Vec<&Compared> = comparison
            .pixels
            .iter()
            .filter(|pixel| pixel.noise < NOISIEST && shown.contains(&pixel.at))
            .collect();
        // The toy may hide it: then only the place of the top counts.
        let losses = match Search::new((shape, receivers), level, comparison, &pixels) {
            Some(search) if pixels.len() >= LEAST_OF_SIDE => agreed_losses(&search, raster, &side.plane)?,
            _ => [0.0; 2],
        };
        Some(FoundPlane {
            report: PlaneAlignment {
                height_m: side.half_m.y,
                tilt_rad: std::f64::consts::FRAC_PI_2,
                half_extent_m: side.half_m.to_array(),
                losses,
            },
            plane: side.plane,
            instead_of: None,
        })
    });
    taken.take(MAX_RECEIVERS.saturating_sub(known.len())).collect()
}

/// Losses of the known receivers and of an upright side; `None` if those, or no shadow at all,
/// explain the pixels better.
fn agreed_losses(search: &Search<'_>, raster: &mut Rasterizer, plane: &SeenReceiver) -> Option<[f64; 2]> {
    let loss = search.loss_of(&search.ratios(raster, plane));
    let (of_receiver, of_others) = search.known_losses();
    (loss < of_others + NOISE).then_some([of_receiver, loss])
}
