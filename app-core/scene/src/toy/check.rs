//! Checks that apply to every part of a file.

use std::ops::RangeInclusive;

use super::error::{Flaw, ToyProblem};

/// Refuses a count above its limit; `what` names the counted things.
pub(super) fn check_limit(
    what: &'static str,
    found: usize,
    limit: usize,
    field: &str,
) -> Result<usize, Flaw> {
    if found > limit {
        let (found, limit) = (found as u64, limit as u64);
        return Err(ToyProblem::TooMany { what, found, limit }.at(field));
    }
    Ok(found)
}

/// Refuses a wrong count; `what` names the counted things.
pub(super) fn check_count(
    what: &'static str,
    found: usize,
    expected: usize,
    field: &str,
) -> Result<(), Flaw> {
    if found == expected {
        Ok(())
    } else {
        Err(ToyProblem::Count {
            what,
            found,
            expected,
        }
        .at(field))
    }
}

/// Refuses NaN and infinity. `width` numbers make one element.
pub(super) fn check_finite(field: &str, values: &[f32], width: usize) -> Result<(), Flaw> {
    let Some(first) = values.iter().position(|value| !value.is_finite()) else {
        return Ok(());
    };
    let n_bad = values.iter().filter(|value| !value.is_finite()).count();
    Err(ToyProblem::NotFinite {
        n_bad,
        n: values.len(),
        first: first / width,
    }
    .at(field))
}

/// Refuses NaN, and numbers outside a range. `width` numbers make one element.
pub(super) fn check_range(
    field: &str,
    values: &[f32],
    width: usize,
    range: &RangeInclusive<f32>,
) -> Result<(), Flaw> {
    check_finite(field, values, width)?;
    let Some(first) = values.iter().position(|value| !range.contains(value)) else {
        return Ok(());
    };
    Err(ToyProblem::Range {
        element: first / width,
        value: values[first],
        min: *range.start(),
        max: *range.end(),
    }
    .at(field))
}
