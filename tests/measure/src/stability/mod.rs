//! Numerical stability on hard cases: each case varies a parameter and compares a measurement with
//! a bound.

mod bounded;
mod budgets;
mod case;
mod continuous;
mod endurance;
mod exact;
mod gap;
mod ill_posed;
mod lab;
mod plot;
mod row;
mod table;
mod truth;
mod visibility;

pub use case::{Case, Run, Scope};
pub use gap::Gap;
pub use lab::{Lab, Label, Made};
pub use plot::draw;
pub use row::{Bound, Findings, Measured, Row, Sweep};
pub use table::{csv, table};

/// All cases, in the order of the table.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    let groups = [
        exact::CASES,
        bounded::CASES,
        continuous::CASES,
        truth::CASES,
        visibility::CASES,
        ill_posed::CASES,
        endurance::CASES,
        budgets::CASES,
    ];
    groups.into_iter().flatten()
}

/// Runs one case.
///
/// # Errors
/// When the core fails, except by refusing an input.
pub fn run(lab: &mut Lab, case: &Case) -> anyhow::Result<Findings> {
    lab.begin();
    (case.run)(lab, case.label)
}
