//! The table of steps, as the documentation has it.

use app_core::app::{Cause, Step};

const DOCUMENT: &str = include_str!("../../../../app-core/doc/app.md");

/// The step after each cause in each step: by the table's words.
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
    // A wrong cell would be found.
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

#[test]
fn a_toy_that_the_platform_recognises_is_asked_about_where_it_stands() {
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::ByHand));
    let mut see = |id: u64, x_m: f64| {
        let time_ns = i64::try_from(id).unwrap() * 33_000_000;
        let mut frame = world::frame(id, time_ns, 0, Tracking::Normal);
        frame.anchors = Arc::new([Anchor {
            id: Anchor::OF_TOY,
            world_from_anchor: DMat4::from_translation(DVec3::new(x_m, 0.0, 0.0)),
        }]);
        let _ = app.event(ShellEvent::Frame(Box::new(frame)));
        let placing = app.placing();
        let _ = app.event(ShellEvent::User(UserAction::ByHand));
        let (ring, _) = app.ring_px().unwrap();
        (placing, ring.iter().sum::<DVec2>() / ring.len() as f64)
    };
    let (placing, at) = see(3, 0.05);
    assert_eq!(placing, Placing::Asked { is_searching: true });
    // The frames' camera looks at the origin from .5 m, with 60 pixels a unit of slope.
    assert!((at.x - (32.0 + 60.0 * 0.05 / 0.5)).abs() < 1.0, "{at}");
    let (placing, _) = see(4, 0.051);
    assert_eq!(placing, Placing::ByHand, "it stands where it stood");
    let (placing, moved) = see(5, 0.1);
    assert_eq!(placing, Placing::Asked { is_searching: true });
    assert!(moved.x > at.x + 3.0, "{at} {moved}");
}
