//! CPU reference of `rim.wgsl`: the receiver's share in the toy's colours in a blurred picture.

use glam::{DVec2, DVec3, UVec2};

use super::grid::PlaneGrid;
use super::model::{Pictures, Region, Solution, centre_px, coarse_at};
use super::occlusion::{PointSpread, spread_position};
use super::raster::Raster;

/// Number of sampled places, in equal numbers of rows and columns.
const N_PLACES: u32 = 64;
/// Rows and columns from one place to the next.
const STEPS: [u32; 2] = [47, 53];

/// The toy's share of a texel, where depth 0 means no toy; `spread` is that of the picture's blur,
/// and places are shifted by `beside_px` to all four sides in turn.
#[must_use]
pub fn part_of_toy(depth: &Raster<f64>, (spread, beside_px): (PointSpread, f64), texel: UVec2) -> f64 {
    let places = (0..N_PLACES).map(|k| {
        let lattice = STEPS.map(|step| (f64::from(k * step % N_PLACES) + 0.5) / f64::from(N_PLACES));
        let side = [k, k / 2].map(|k| if k % 2 == 0 { -beside_px } else { beside_px });
        texel.as_dvec2() + spread_position(DVec2::from(lattice), spread) + DVec2::from(side)
    });
    let shows_toy = |place: &DVec2| {
        let is_inside = place.cmpge(DVec2::ZERO).all() && place.cmplt(depth.size().as_dvec2()).all();
        is_inside && depth.at(place.as_uvec2()) > 0.0
    };
    places.filter(shows_toy).count() as f64 / f64::from(N_PLACES)
}

/// Parameters learned about the receivers.
#[derive(Clone, Copy, Debug)]
pub struct Learned<'a> {
    /// The fits' result.
    pub solution: &'a Solution,
    /// Filled residuals on each receiver, in plates, and the positions of their cells.
    pub residuals: &'a [(PlaneGrid, Raster<DVec3>)],
}

/// The receiver's colour at a texel of the region in the real shadow, over the gain.
#[must_use]
pub fn shown_receiver(region: &Region, pictures: &Pictures, learned: &Learned<'_>, texel: UVec2) -> DVec3 {
    let (at, plate) = (centre_px(texel), pictures.plate.at(texel));
    let Some(point) = region.receiver_point(at) else {
        return plate;
    };
    let ambient = coarse_at(&pictures.ambient, region, at);
    let visibility = pictures.visibility.at(texel);
    let model = learned
        .solution
        .receiver_model(region, point, ambient, visibility);
    let (grid, residual) = &learned.residuals[point.receiver];
    let matt = plate * (model + grid.value_at(residual, point.in_plane)).max(DVec3::ZERO);
    matt + region.reflected(point, visibility)
}
