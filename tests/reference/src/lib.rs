//! CPU references of the passes: plain functions on the processor, in 64 bits, without the graphics
//! device. Rays also exist in 32 bits, to measure rounding errors: they are generic over
//! [`real::Real`].
//!
//! Each file is the CPU reference of the shader of its name. Here clarity comes first: a loop over
//! pixels rather than a blend mode, a ray against triangles rather than a flattened mesh,
//! elimination with pivots rather than without. Properties of a scene are arguments; constants of a
//! shader are repeated at the top of its reference: a reference with the shader's own constants
//! could not find a wrong one.

pub mod appearance;
pub mod behind_outline;
pub mod box_filter;
pub mod camera_paint;
pub mod camera_planes;
pub mod census;
pub mod composite;
pub mod detail;
pub mod eligible;
pub mod estimate;
pub mod fill;
pub mod fit;
pub mod gloss;
pub mod grain;
pub mod grid;
pub mod least_squares;
pub mod lit;
pub mod model;
pub mod occlusion;
pub mod on_things;
pub mod pcss;
pub mod plate;
pub mod raster;
pub mod real;
pub mod receiver_priors;
pub mod reflection;
pub mod residual;
pub mod retarget;
pub mod rim;
pub mod search;
pub mod self_shadow;
pub mod sets;
pub mod soften;
pub mod thing_rim;
pub mod things;
pub mod tint;
pub mod unmix;
pub mod validity;
pub mod visibility;
pub mod withhold;

/// Hermite step from 0 at `low` to 1 at `high`.
#[must_use]
pub fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
