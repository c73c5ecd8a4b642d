//! CPU reference of `box_filter.wgsl`: the box filter of the shadow term.
//!
//! The shader sums rows, then columns; here each square is summed directly.

use glam::{DVec3, DVec4, UVec2};

use super::raster::Raster;

/// Sum of the terms in the square around each texel, alpha their number. Texels without a term, and those outside, are
/// not counted.
#[must_use]
pub fn box_sums(terms: &Raster<Option<DVec3>>, radius_px: u32) -> Raster<DVec4> {
    let last = terms.size() - 1;
    Raster::from_fn(terms.size(), |texel| {
        let low = texel.saturating_sub(UVec2::splat(radius_px));
        let high = (texel + radius_px).min(last);
        let square = (low.y..=high.y).flat_map(|y| (low.x..=high.x).map(move |x| UVec2::new(x, y)));
        square
            .filter_map(|tap| terms.at(tap))
            .fold(DVec4::ZERO, |sum, term| sum + term.extend(1.0))
    })
}

/// The mean of a sum; `None` of an empty one.
#[must_use]
pub fn mean(sum: DVec4) -> Option<DVec3> {
    (sum.w > 0.0).then(|| sum.truncate() / sum.w)
}
