//! Values of pixels, and connected pixels.

use glam::IVec2;

use crate::lights::Compared;
use crate::picture::{index_in, square};

/// Neighbours of a pixel.
pub(super) const STEPS: [IVec2; 4] = [IVec2::X, IVec2::NEG_X, IVec2::Y, IVec2::NEG_Y];

/// A value of each pixel of a level that was compared, and another one elsewhere.
pub(super) fn in_level<T: Clone>(
    size_px: IVec2,
    compared: &[Compared],
    elsewhere: T,
    of: impl Fn(&Compared) -> T,
) -> Vec<T> {
    let mut values = vec![elsewhere; (size_px.x * size_px.y) as usize];
    for pixel in compared {
        if let Some(index) = index_in(size_px, pixel.at) {
            values[index] = of(pixel);
        }
    }
    values
}

/// Indices of connected pixels.
pub(crate) fn groups(size_px: IVec2, is_in: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
    let n_pixels = (size_px.x * size_px.y) as usize;
    let mut is_known = vec![false; n_pixels];
    let mut groups = Vec::new();
    for first in 0..n_pixels {
        if is_known[first] || !is_in(first) {
            continue;
        }
        is_known[first] = true;
        let mut group = vec![first];
        let mut next = 0;
        while let Some(index) = group.get(next).copied() {
            next += 1;
            let at = place_of(index, size_px);
            for step in STEPS {
                let Some(other) = index_in(size_px, at + step) else {
                    continue;
                };
                if !is_known[other] && is_in(other) {
                    is_known[other] = true;
                    group.push(other);
                }
            }
        }
        groups.push(group);
    }
    groups
}

/// A pixel and four others, at a distance along the axes.
pub(super) fn cross(at: IVec2, reach_px: i32) -> impl Iterator<Item = IVec2> {
    let others = STEPS.map(|step| at + reach_px * step);
    std::iter::once(at).chain(others)
}

/// Whether most of the nine pixels around one, including itself, have a property.
pub(super) fn most_around(at: IVec2, is_so: impl Fn(IVec2) -> bool) -> bool {
    square(at, 1).filter(|at| is_so(*at)).count() >= 5
}

/// The position of a pixel with an index.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    reason = "a place in a picture"
)]
pub(crate) fn place_of(index: usize, size_px: IVec2) -> IVec2 {
    IVec2::new(index as i32 % size_px.x, index as i32 / size_px.x)
}
