//! The rows as a table for people, and as CSV.

use super::row::{Measured, Row};
use crate::bench::{aligned, quoted};

const HEADS: [&str; 11] = [
    "group",
    "case",
    "parameter",
    "meaning",
    "unit",
    "bound",
    "measured",
    "cpu_f32",
    "cpu_f64",
    "state",
    "note",
];

/// One line per row under a header. Missing measurements are empty.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let lines = rows.iter().map(|row| {
        let fields = cells(row).map(|cell| quoted(&cell));
        fields.join(",") + "\n"
    });
    std::iter::once(HEADS.join(",") + "\n").chain(lines).collect()
}

/// The rows in columns, and the number of broken bounds.
#[must_use]
pub fn table(rows: &[Row], adapter: &str) -> String {
    let lines = rows.iter().map(|row| cells(row).to_vec());
    let all: Vec<_> = std::iter::once(HEADS.map(str::to_owned).to_vec())
        .chain(lines)
        .collect();
    let n_broken = rows.iter().filter(|row| row.is_broken()).count();
    format!(
        "{}{n_broken} of {} bounds are broken on {adapter}.\n",
        aligned(&all),
        rows.len()
    )
}

fn cells(row: &Row) -> [String; 11] {
    let number = |value: f64| format!("{value:.4}");
    let optional = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.3e}"));
    let (measured, state, note) = match &row.measured {
        Measured::Number(value) => (
            number(*value),
            if row.is_broken() { "broken" } else { "ok" },
            &row.note,
        ),
        Measured::Refused(reason) => (String::new(), "refused", reason),
    };
    [
        row.group.to_owned(),
        row.case.to_owned(),
        row.parameter.clone(),
        row.bound.meaning.to_owned(),
        row.bound.unit.to_owned(),
        row.bound.limit.to_string(),
        measured,
        optional(row.cpu_f32),
        optional(row.cpu_f64),
        state.to_owned(),
        note.clone(),
    ]
}
