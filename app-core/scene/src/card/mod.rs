//! A card that is printed and laid on the table: something patterned that platforms follow, with a place for the lens of a light
//! probe.
//!
//! Card space is in metres, right-handed, with its origin in the middle of the pattern: +X to the right of the printed page, +Y out of
//! it, +Z down the page. That is how ARKit and ARCore both place an image that they follow.

mod pattern;
mod split_mix;

use glam::{DMat4, DVec2, DVec3};

use crate::scene::{FacetSlope, ProbeShape};

pub use pattern::{Gray, PATTERN_M, REFERENCE_PX, SEED, leaves, reference};
pub use split_mix::SplitMix;

/// Place for a lens of the size of a bank card, with some room: its corner and its size, from the pattern's corner.
pub const LENS_M: [DVec2; 2] = [DVec2::new(0.0, 0.158), DVec2::new(0.092, 0.060)];
/// Of the disc that a lens of that size has room for.
const LENS_RADIUS_M: f64 = 0.027;

/// The lens that lies in its place: its facets as steep as the paper takes them, since nobody has calibrated it.
#[must_use]
pub fn lens_shape() -> ProbeShape {
    ProbeShape::FresnelLens {
        radius_m: LENS_RADIUS_M,
        slope: FacetSlope::Hemisphere,
    }
}

/// Where that lens is, rigid.
#[must_use]
pub fn card_from_lens() -> DMat4 {
    let [corner, size] = LENS_M;
    let middle = corner + 0.5 * size - 0.5 * PATTERN_M;
    DMat4::from_translation(DVec3::new(middle.x, 0.0, middle.y))
}
