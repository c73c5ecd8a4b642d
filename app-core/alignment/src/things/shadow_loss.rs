//! How far a photographed shadow is from a predicted one.

use crate::picture::Color;

/// Largest loss of a pixel: a squared difference in plates.
pub(super) const MOST_LOSS: f64 = 0.03;
/// Least and largest depth of the shadow over the expected one, and rounds of its estimate.
const DEPTHS: [f64; 2] = [0.6, 1.3];
const N_ROUNDS: usize = 3;

/// Depth of the shadow over the prediction, which is uncertain if the receiver shows little of it;
/// by the ratio and noise of each pixel.
pub(super) fn depth(seen: &[(Color, f32)], expected: &[Option<Color>]) -> f64 {
    let mut depth = 1.0;
    for _ in 0..N_ROUNDS {
        let pixels = expected.iter().zip(seen);
        let pixels = pixels.filter_map(|(expected, seen)| Some((seen, (*expected)?)));
        let like = pixels.filter(|(seen, expected)| square(seen, *expected, depth) < MOST_LOSS);
        let (mut product, mut own) = (0.0, 0.0);
        for ((ratio, _), expected) in like {
            for channel in 0..3 {
                let taken = f64::from(1.0 - expected[channel]);
                product += taken * f64::from(1.0 - ratio[channel]);
                own += taken * taken;
            }
        }
        if own > 0.0 {
            depth = (product / own).clamp(DEPTHS[0], DEPTHS[1]);
        }
    }
    depth
}

/// Squared difference between photograph and prediction, with a scaled shadow, less the squared
/// noise.
pub(super) fn square((ratio, noise): &(Color, f32), expected: Color, depth: f64) -> f64 {
    let squares = (0..3).map(|channel| {
        let expected = 1.0 - depth * f64::from(1.0 - expected[channel]);
        (f64::from(ratio[channel]) - expected).powi(2)
    });
    (squares.sum::<f64>() / 3.0 - f64::from(*noise).powi(2)).clamp(0.0, MOST_LOSS)
}
