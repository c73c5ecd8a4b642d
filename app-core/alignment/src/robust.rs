//! Geman and McClure 1987: residuals far beyond a scale have little weight; the scale may be
//! infinite.

/// Weight of a residual whose square is `times` that of the scale: 1 at 0.
pub(crate) fn weight(times: f64) -> f64 {
    (1.0 + times).powi(-2)
}

/// Loss of a residual from its square and that of the scale, which is the supremum.
pub(crate) fn loss(square: f64, scale_square: f64) -> f64 {
    square / (1.0 + square / scale_square)
}
