//! Geman and McClure 1987: residuals count the less the farther they are beyond a scale, which may be infinite.

/// Weight of a residual whose square is `times` that of the scale: 1 for none.
pub(crate) fn weight(times: f64) -> f64 {
    (1.0 + times).powi(-2)
}

/// Loss of a residual by its square and that of the scale, which it never reaches.
pub(crate) fn loss(square: f64, scale_square: f64) -> f64 {
    square / (1.0 + square / scale_square)
}
