//! The table of steps in the documentation.

use app_core::app::{Cause, Step};

const DOCUMENT: &str = include_str!("../../../../app-core/doc/app.md");

/// The step after each cause in each step, from the table's text.
fn documented(document: &str) -> Vec<(Step, Cause, Step)> {
    let step = |name: &str| Step::ALL.into_iter().find(|step| format!("{step:?}") == name);
    let rows = document.lines().filter(|line| line.starts_with('|'));
    let cells = rows.map(|row| {
        let cells = row.trim_matches('|').split('|').map(str::trim);
        cells.collect::<Vec<_>>()
    });
    let mut rows = cells.take_while(|cells| cells.len() == 1 + Step::ALL.len());
    let steps: Vec<Step> = rows.next().unwrap()[1..]
        .iter()
        .map(|name| step(name).unwrap())
        .collect();
    let mut found = Vec::new();
    for cells in rows.skip(1) {
        let cause = Cause::ALL
            .into_iter()
            .find(|cause| format!("{cause:?}") == cells[0]);
        let cause = cause.unwrap_or_else(|| panic!("no cause is called {}", cells[0]));
        for (from, to) in steps.iter().zip(&cells[1..]) {
            let to = if to.is_empty() { *from } else { step(to).unwrap() };
            found.push((*from, cause, to));
        }
    }
    found
}

fn differing(document: &str) -> Vec<(Step, Cause, Step)> {
    let mut rows = documented(document);
    assert_eq!(
        rows.len(),
        Step::ALL.len() * Cause::ALL.len(),
        "a row or a column is missing"
    );
    rows.retain(|(from, cause, to)| from.after(*cause) != *to);
    rows
}

#[test]
fn the_steps_are_those_of_the_documented_table() {
    assert_eq!(differing(DOCUMENT), []);
    // Control: a wrong cell is detected.
    let planted = DOCUMENT.replacen(
        "| ToyFound | | | | | Play | |",
        "| ToyFound | | | | | PlaceToy | |",
        1,
    );
    assert_eq!(
        differing(&planted),
        [(Step::Align, Cause::ToyFound, Step::PlaceToy)]
    );
}
