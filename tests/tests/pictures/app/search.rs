//! The search for a toy that was put down: where it begins, how many threads run, and how it goes on
//! after a false alarm.

use app_core::app::{App, Placing, SearchJob, ShellCommand, ShellEvent, Step, UserAction, WorkCommand};
use app_core::camera_frame::Tracking;
use glam::{DVec2, DVec3};

use super::way::{Person, photographed};
use crate::app::world;

/// A card that is larger than the toy with its shadow, beside both.
const BESIDE_PX: [u32; 4] = [506, 30, 620, 300];
/// Another one, of the toy's size at the toy's place.
const ALONE_PX: [u32; 4] = [200, 60, 330, 240];
/// A small one, far from the toy and its shadow.
const SMALL_PX: [u32; 4] = [540, 60, 600, 100];

/// Whether the ghost covers a pixel, or is little beside it.
fn is_at(person: &Person, pixel: DVec2) -> bool {
    let [low, high] = person.app.ghost().expect("a ghost").corners_px;
    let reach_px = 0.3 * (high - low);
    pixel.cmpge(low - reach_px).all() && pixel.cmple(high + reach_px).all()
}

/// A person with a card and a toy on the table, who taps on one of them.
fn tapped(pixel: DVec2) -> Person {
    let mut person = photographed();
    person.feed.is_toy_there = true;
    person.card_px = Some(BESIDE_PX);
    person.frames(1);
    person.act(UserAction::Tap(pixel));
    // The first step of the search.
    person.frames(1);
    assert!(
        is_at(&person, pixel),
        "{pixel}: {:?}",
        person.app.ghost().map(|ghost| ghost.corners_px)
    );
    person
}

#[test]
fn a_tap_decides_where_the_toy_is_searched() {
    let mut person = photographed();
    let toy_px = person.pixel_of(DVec3::new(0.0, 0.06, 0.0));
    person = tapped(toy_px);
    person.wait_until(|placing| placing == Placing::Asked { is_searching: false });
    assert!(is_at(&person, toy_px));
    person.act(UserAction::Placed);
    person.frames(1);
    assert_eq!(person.app.step(), Step::Play, "{:?}", person.app.verdict());
    let [left, top, right, bottom] = BESIDE_PX.map(f64::from);
    let card_px = 0.5 * DVec2::new(left + right, top + bottom);
    let person = tapped(card_px);
    assert!(!is_at(&person, toy_px), "the tap is at the card");
}

#[test]
fn after_a_false_alarm_the_app_waits_for_the_toy_as_before() {
    let mut person = photographed();
    person.card_px = Some(ALONE_PX);
    // Its outline may match by chance.
    let is_settled = |placing| matches!(placing, Placing::ByHand | Placing::Asked { is_searching: false });
    person.wait_until(is_settled);
    let placing = person.app.placing();
    person.frames(40);
    assert_eq!(person.app.placing(), placing, "the card is still there");
    person.card_px = None;
    person.wait_until(|placing| placing == Placing::Waiting { is_long: false });
    assert!(person.app.ghost().is_none());
    finds_toy(&mut person);
    person.act(UserAction::Placed);
    person.frames(1);
    assert_eq!(person.app.step(), Step::Play, "{:?}", person.app.verdict());
}

#[test]
fn a_thing_that_is_no_toy_may_stay() {
    let mut person = photographed();
    person.card_px = Some(SMALL_PX);
    let mut is_noticed = false;
    for _ in 0..60 {
        person.frames(1);
        is_noticed |= person.app.placing() == Placing::Looking;
        assert!(person.app.ghost().is_none() && person.app.ring_px().is_none());
    }
    assert!(is_noticed);
    assert_eq!(person.app.placing(), Placing::Waiting { is_long: false });
    finds_toy(&mut person);
    let toy_px = person.pixel_of(DVec3::new(0.0, 0.06, 0.0));
    assert!(is_at(&person, toy_px));
}

/// The toy is put down and found, and the phone knocks once.
fn finds_toy(person: &mut Person) {
    person.n_knocks = 0;
    person.feed.is_toy_there = true;
    person.wait_until(|placing| placing == Placing::Asked { is_searching: false });
    assert_eq!(person.n_knocks, 1);
}

/// The searches that a frame begins.
fn searches(app: &mut App, id: u64) -> Vec<SearchJob> {
    let time_ns = 33_000_000 * i64::try_from(id).unwrap();
    let frame = world::frame(id, time_ns, 0, Tracking::Normal);
    let commands = app.event(ShellEvent::Frame(Box::new(frame)));
    let searches = commands.into_iter().filter_map(|command| match command {
        ShellCommand::Work(WorkCommand::Search(job)) => Some(*job),
        _ => None,
    });
    searches.collect()
}

#[test]
fn at_most_one_thread_searches_and_an_old_one_changes_nothing() {
    let mut app = world::app();
    for event in world::opening() {
        let _ = app.event(event);
    }
    assert!(searches(&mut app, 1).is_empty());
    let tap = |app: &mut App, x_px: f64| {
        let _ = app.event(ShellEvent::User(UserAction::Tap(DVec2::new(x_px, 24.0))));
    };
    tap(&mut app, 32.0);
    let _ = app.event(ShellEvent::User(UserAction::SkipPlate));
    let mut jobs = searches(&mut app, 2);
    assert_eq!(jobs.len(), 1);
    for id in 3..9 {
        tap(&mut app, 20.0 + id as f64);
        jobs.extend(searches(&mut app, id));
    }
    assert_eq!(jobs.len(), 1, "a thread is still at work");
    let before = app.ghost();
    let _ = app.event(ShellEvent::Searched(jobs.pop().map(|job| Box::new(job.run()))));
    assert_eq!(app.ghost(), before, "its place is no longer asked for");
    assert_eq!(app.placing(), Placing::Asked { is_searching: true });
    assert_eq!(searches(&mut app, 9).len(), 1);
    // The same if the old thread ends without a result.
    tap(&mut app, 32.0);
    let _ = app.event(ShellEvent::Searched(None));
    assert_eq!(app.placing(), Placing::Asked { is_searching: true });
    assert_eq!(searches(&mut app, 10).len(), 1);
    let _ = app.event(ShellEvent::Searched(None));
    assert_eq!(app.placing(), Placing::ByHand);
}
