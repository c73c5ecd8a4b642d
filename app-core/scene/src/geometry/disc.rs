//! Points spread over a disc, and directions over the hemisphere above it.

use glam::{DVec2, DVec4, Vec4};

/// `n_directions` directions over the hemisphere, cosine-weighted: each represents an equal fraction of ambient
/// light.
///
/// Source: Malley's method, points on a disc lifted to the hemisphere.
#[must_use]
pub fn ambient_directions(n_directions: usize) -> Vec<Vec4> {
    vogel_disc(n_directions)
        .map(|at| DVec4::new(at.x, (1.0 - at.length_squared()).max(0.0).sqrt(), at.y, 0.0).as_vec4())
        .collect()
}

/// `n_points` points over the unit disc, each representing an equal area.
///
/// Source: Vogel 1979 (sunflower spiral).
pub fn vogel_disc(n_points: usize) -> impl Iterator<Item = DVec2> {
    let golden_angle_rad = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..n_points).map(move |i| {
        let radius = ((i as f64 + 0.5) / n_points as f64).sqrt();
        radius * DVec2::from_angle(i as f64 * golden_angle_rad)
    })
}
