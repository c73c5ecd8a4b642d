//! A card that is printed and laid on the table: a patterned image that platforms track, with a
//! place for the lens of a light probe.
//!
//! Card space is in metres, right-handed, with its origin in the centre of the pattern: +X to the
//! right of the printed page, +Y out of it, +Z down the page. ARKit and ARCore both use this space
//! for a tracked image.

mod pattern;
mod split_mix;

use glam::{DMat4, DVec2, DVec3};

use crate::scene::{FacetSlope, ProbeShape};

pub use pattern::{Gray, PATTERN_M, REFERENCE_PX, SEED, leaves, reference};
pub use split_mix::SplitMix;

/// Place for a lens of the size of a bank card, with some room: its corner and its size, from the pattern's corner.
pub const LENS_M: [DVec2; 2] = [DVec2::new(0.0, 0.158), DVec2::new(0.092, 0.060)];
/// Radius of the largest disc that fits on such a lens.
const LENS_RADIUS_M: f64 = 0.027;

/// The lens in its place: its facets have the paper's slopes, since it is not calibrated.
#[must_use]
pub fn lens_shape() -> ProbeShape {
    ProbeShape::FresnelLens {
        radius_m: LENS_RADIUS_M,
        slope: FacetSlope::Hemisphere,
    }
}

/// Pose of that lens, rigid.
#[must_use]
pub fn card_from_lens() -> DMat4 {
    let [corner, size] = LENS_M;
    let middle = corner + 0.5 * size - 0.5 * PATTERN_M;
    DMat4::from_translation(DVec3::new(middle.x, 0.0, middle.y))
}
