//! Pixels of a rectangle, stored row by row.

use glam::IVec2;

/// Index of a place within a rectangle of a size; none outside it.
pub(super) fn index_in(size_px: IVec2, place: IVec2) -> Option<usize> {
    let is_inside = place.cmpge(IVec2::ZERO).all() && place.cmplt(size_px).all();
    is_inside.then_some((place.y * size_px.x + place.x) as usize)
}

/// All places of a rectangle, in the order of their indices.
pub(super) fn places(size_px: IVec2) -> impl Iterator<Item = IVec2> + Clone + use<> {
    (0..size_px.y).flat_map(move |y| (0..size_px.x).map(move |x| IVec2::new(x, y)))
}
