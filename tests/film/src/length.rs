//! Parses lengths.

/// Metres of a length such as `12cm`, `120 mm`, `0.12m` or `4.7in`.
///
/// # Errors
/// When it is invalid, or not above zero.
pub fn metres(text: &str) -> Result<f64, String> {
    const UNITS: [(&str, f64); 4] = [("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254), ("m", 1.0)];
    let wanted = || format!("{text:?} is no length such as 12cm, 120mm, 0.12m or 4.7in");
    let trimmed = text.trim();
    let (number, unit_m) = UNITS
        .iter()
        .find_map(|(unit, unit_m)| Some((trimmed.strip_suffix(unit)?, *unit_m)))
        .ok_or_else(wanted)?;
    let number: f64 = number.trim().parse().map_err(|_| wanted())?;
    let metres = number * unit_m;
    if metres.is_finite() && metres > 0.0 {
        Ok(metres)
    } else {
        Err(wanted())
    }
}
