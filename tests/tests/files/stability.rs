//! The quick cases of `cargo xtask stability`; a fault planted in the measurement breaks a bound of
//! each group.

use std::collections::BTreeSet;

use measure::stability::{Bound, Case, Lab, Label, Measured, Row, Scope, cases, csv, run, table};

/// The cheapest case of each group in the quick subset, for planting a fault.
const PLANTED: &[&str] = &[
    "run-again",
    "uniform-scale",
    "light-radius-small",
    "long-clip",
    "visibility-bulb",
    "two-at-one-place",
    "one-plate",
];

fn lab(is_planted: bool) -> Lab {
    Lab::new(harness::open_core(), Scope::Quick, is_planted)
}

#[test]
fn quick_cases_keep_their_bounds() {
    let mut lab = lab(false);
    let mut rows: Vec<Row> = Vec::new();
    for case in cases().filter(|case| case.scope == Scope::Quick) {
        let found = run(&mut lab, case).unwrap().rows;
        assert!(!found.is_empty(), "{} measures nothing", case.label.case);
        rows.extend(found);
    }
    let broken: Vec<Row> = rows.into_iter().filter(Row::is_broken).collect();
    assert!(broken.is_empty(), "{}", table(&broken, &lab.adapter()));
}

#[test]
fn a_planted_fault_breaks_a_bound_of_each_group() {
    let mut lab = lab(true);
    for case in cases().filter(|case| PLANTED.contains(&case.label.case)) {
        let rows = run(&mut lab, case).unwrap().rows;
        assert!(
            rows.iter().any(Row::is_broken),
            "{}: {}",
            case.label.case,
            table(&rows, &lab.adapter())
        );
    }
}

#[test]
fn every_group_has_its_planted_fault() {
    let groups = |is_wanted: fn(&Case) -> bool| -> BTreeSet<&str> {
        cases()
            .filter(|case| is_wanted(case))
            .map(|case| case.label.group)
            .collect()
    };
    assert_eq!(
        groups(|case| case.scope == Scope::Quick),
        groups(|case| PLANTED.contains(&case.label.case))
    );
    let names: BTreeSet<&str> = cases().map(|case| case.label.case).collect();
    assert_eq!(names.len(), cases().count(), "two cases of one name");
}

#[test]
fn rows_tell_when_a_bound_is_broken() {
    let label = Label {
        group: "group",
        case: "case",
    };
    let bound = Bound {
        limit: 2.0,
        unit: "codes",
        meaning: "a difference",
    };
    let row = |number| label.row("a, \"b\"", bound, number);
    assert!(!row(2.0).is_broken());
    assert!(row(2.001).is_broken() && row(f64::NAN).is_broken());
    let refused = Row {
        measured: Measured::Refused("too far".to_owned()),
        ..row(0.0)
    };
    assert!(refused.is_broken());
    let text = csv(&[row(1.0), row(3.0), refused.clone()]);
    assert!(
        text.contains("\"a, \"\"b\"\"\",a difference,codes,2,1.0000,,,ok,"),
        "{text}"
    );
    assert!(text.contains("broken") && text.contains("refused"), "{text}");
    assert!(table(&[row(1.0), refused], "none").contains("1 of 2 bounds are broken"));
}
