//! Platforms that do not fulfil requests: refused configurations, cameras without pictures, an
//! installation in between, an interruption, a second start, in every combination.

use std::time::Duration;

use app_core::app::{ArSession, ShellEvent};

use super::super::fake::{FUNCTIONS, world};
use super::super::feed::Feed;
use super::super::status::Failure;
use super::{ANEW, Desk, LOOK, Step, assert_clean, calls, running, tracker, update};
use crate::frame::FrameError;
use crate::tracker::{Run, Tracker};

const WITH_CARD: Run = Run {
    finds_card: true,
    ..LOOK
};

/// Lets time pass, with a new frame each tenth of a second.
fn seconds(tracker: &mut Tracker, from_s: f64, n_s: f64) -> Vec<Result<bool, String>> {
    let steps = (0..)
        .take_while(|step| 0.1 * f64::from(*step) < n_s - 1e-9)
        .map(|step: u32| {
            world(|world| world.time_ns += 1);
            let now = Duration::from_secs_f64(from_s + 0.1 * f64::from(step));
            let frame = tracker.update(now);
            frame
                .map(|frame| frame.is_some())
                .map_err(|error| error.to_string())
        });
    steps.collect()
}

#[test]
fn what_is_refused_is_done_without_one_thing_at_a_time() {
    let cases: [(&[(&str, i32)], &str); 4] = [
        (&[], "focus=1 images configure"),
        (
            &[("images", 1)],
            "focus=1 images configure update=1 planes=1 texture=1 light=0 focus=1 configure",
        ),
        (
            &[("focus", 1)],
            "focus=1 configure update=1 planes=1 texture=1 light=0 focus=0 images configure",
        ),
        (
            &[("images", 1), ("focus", 1)],
            "focus=1 configure update=1 planes=1 texture=1 light=0 focus=0 images configure update=1 planes=1 texture=1 light=0 focus=0 configure",
        ),
    ];
    for (refuses, expected) in cases {
        world(|world| world.refuses = refuses.to_vec());
        let mut tracker = tracker();
        assert_eq!(tracker.run(&mut Desk, WITH_CARD), Step::Ready, "{refuses:?}");
        let said = calls();
        let configured = said
            .split(" display")
            .next()
            .unwrap_or_default()
            .trim_end_matches(" resume");
        assert!(configured.ends_with(expected), "{refuses:?}: {said}");
        // Refused parts are not requested again.
        let n_before = world(|world| world.calls.len());
        assert_eq!(
            tracker.run(
                &mut Desk,
                Run {
                    finds_planes: false,
                    ..WITH_CARD
                }
            ),
            Step::Ready
        );
        let again = calls();
        assert_eq!(again.matches(" configure").count(), 1, "{again}");
        assert_eq!(n_before, 0);
        drop(tracker);
        assert_clean();
    }
    // No smaller configuration is accepted either: only then AR is unavailable.
    world(|world| world.fails.insert("configure", -8));
    let mut tracker = tracker();
    assert_eq!(tracker.run(&mut Desk, WITH_CARD), Step::Refused(Failure(-8)));
    assert_eq!(calls().matches(" configure").count(), 4);
    drop(tracker);
    assert_clean();
}

#[test]
fn a_camera_without_pictures_is_set_to_smaller_ones_and_that_is_kept() {
    world(|world| {
        world.modes = vec![[1920, 1080, 30], [1280, 720, 30], [640, 480, 30]];
        world.silent = vec![0];
    });
    let mut feed = Feed::new(Some(FUNCTIONS));
    assert!(feed.run(&mut Desk, LOOK).is_none());
    calls();
    let poll = |feed: &mut Feed, s: f64| {
        world(|world| world.time_ns += 1);
        feed.poll(&mut Desk, Duration::from_secs_f64(s))
    };
    // A loop that stood still for long has polled too rarely for a verdict.
    assert!(poll(&mut feed, 10.0).is_none());
    assert!(poll(&mut feed, 20.0).is_none());
    assert!((0..5).all(|_| poll(&mut feed, 20.0).is_none()));
    assert_eq!(calls(), ["update"; 7].join(" "), "patience");
    assert!(poll(&mut feed, 20.0).is_none());
    assert_eq!(calls(), "update pause resume", "a slow start gets another");
    assert!((0..30).all(|tenth| poll(&mut feed, 20.1 + 0.1 * f64::from(tenth)).is_none()));
    assert!(!calls().contains("mode"), "patience");
    assert!(poll(&mut feed, 23.2).is_none());
    assert_eq!(calls(), "update pause mode=1 resume");
    assert_eq!(feed.take_kept(), None, "nothing has come yet");
    assert!(matches!(poll(&mut feed, 23.3), Some(ShellEvent::Frame(_))));
    assert_eq!(feed.take_kept().as_deref(), Some("1280x720 8"));
    assert_eq!(feed.take_kept(), None, "told once");
    drop(feed);
    assert_clean();
    // The next start does not try the mode that delivered nothing.
    let mut feed = Feed::new(Some(FUNCTIONS)).with_kept("1280x720 2\n");
    assert_eq!(feed.take_kept().as_deref(), Some("1280x720 1"));
    assert!(feed.run(&mut Desk, LOOK).is_none());
    assert!(calls().contains("mode=1"));
    assert!(matches!(poll(&mut feed, 0.0), Some(ShellEvent::Frame(_))));
    assert_eq!(feed.take_kept(), None);
    // After some starts larger modes are tried again: they may have been slow only once.
    world(|world| world.silent.clear());
    let mut feed = Feed::new(Some(FUNCTIONS)).with_kept("1280x720 1");
    assert_eq!(feed.take_kept().as_deref(), Some("1280x720 0"));
    let mut feed = Feed::new(Some(FUNCTIONS)).with_kept("1280x720 0");
    assert!(feed.run(&mut Desk, LOOK).is_none());
    assert!(calls().contains("mode=0"));
    drop(feed);
    for nonsense in ["", "x", "-3x4 5", "1280 1", "1280x720", "1x2x3 4", "1280x720 -1"] {
        let mut feed = Feed::new(Some(FUNCTIONS)).with_kept(nonsense);
        assert_eq!(feed.take_kept(), None, "{nonsense}");
    }
}

#[test]
fn a_start_that_is_slow_once_makes_no_picture_small() {
    world(|world| {
        world.modes = vec![[1920, 1080, 30], [640, 480, 30]];
        world.silent = vec![0];
    });
    let mut tracker = running();
    seconds(&mut tracker, 0.0, 3.5);
    world(|world| world.silent.clear());
    assert!(
        seconds(&mut tracker, 3.5, 2.0)
            .iter()
            .all(|step| step == &Ok(true))
    );
    assert_eq!(tracker.limited_to(), None);
    assert!(!calls().contains("mode=1"));
    drop(tracker);
    assert_clean();
}

#[test]
fn a_camera_that_stops_is_begun_anew_and_one_that_never_comes_is_said() {
    world(|world| world.modes = vec![[1920, 1080, 30], [640, 480, 30]]);
    let mut tracker = running();
    assert!(
        seconds(&mut tracker, 0.0, 1.0)
            .iter()
            .all(|step| step == &Ok(true))
    );
    calls();
    world(|world| world.silent = vec![0]);
    seconds(&mut tracker, 1.0, 3.2);
    assert!(calls().ends_with("pause resume update update"), "as it was");
    seconds(&mut tracker, 4.2, 3.0);
    assert!(calls().contains("pause mode=1 resume"));
    world(|world| world.silent = vec![0, 1]);
    let steps = seconds(&mut tracker, 8.0, 7.0);
    let errors: Vec<_> = steps.iter().filter_map(|step| step.as_ref().err()).collect();
    assert_eq!(errors, ["the camera delivers no picture in any size"]);
    assert_eq!(tracker.limited_to(), None, "a later start tries all again");
    world(|world| world.silent.clear());
    assert_eq!(tracker.run(&mut Desk, ANEW), Step::Ready);
    assert_eq!(seconds(&mut tracker, 20.0, 0.1), [Ok(true)]);
    drop(tracker);
    assert_clean();
}

#[test]
fn a_camera_whose_focus_is_stuck_is_paused_and_resumed_once() {
    for (stuck_focus, n_pauses) in [(0, 0), (1, 1), (5, 1)] {
        world(|world| world.stuck_focus = stuck_focus);
        let mut tracker = running();
        calls();
        seconds(&mut tracker, 0.0, 4.0);
        assert_eq!(calls().matches("pause resume").count(), n_pauses, "{stuck_focus}");
        drop(tracker);
    }
    // If autofocus was refused, there is nothing to wait for.
    world(|world| {
        world.stuck_focus = 1;
        world.refuses = vec![("focus", 1)];
    });
    let mut tracker = running();
    calls();
    seconds(&mut tracker, 0.0, 4.0);
    assert!(!calls().contains("pause"));
    drop(tracker);
    assert_clean();
}

#[test]
fn a_filter_that_finds_nothing_is_done_without_and_nobody_is_filmed() {
    world(|world| {
        world.modes = vec![[1920, 1080, 30], [1920, 1080, 30]];
        world.fronts = vec![1];
    });
    drop(running());
    assert!(calls().contains("facing=0 fps=1 depth=2 mode=0"));
    world(|world| world.filters_all = true);
    drop(running());
    assert!(
        calls().contains("mode=0"),
        "the one that faces away, without a filter"
    );
    world(|world| world.modes.clear());
    let mut tracker = running();
    assert!(!calls().contains("mode="), "as ARCore has it");
    assert!(update(&mut tracker).expect("no error").is_some());
    drop(tracker);
    assert_clean();
}

#[test]
fn the_camera_of_another_app_is_asked_for_again_until_it_is_free() {
    let mut feed = Feed::new(Some(FUNCTIONS));
    assert!(feed.run(&mut Desk, LOOK).is_none());
    world(|world| world.fails.insert("update", -13));
    let poll = |feed: &mut Feed, s: u64| {
        world(|world| world.time_ns += 1);
        feed.poll(&mut Desk, Duration::from_secs(s))
    };
    let told = poll(&mut feed, 0);
    assert!(
        matches!(told, Some(ShellEvent::ArTrouble(ArSession::Interrupted, _))),
        "{told:?}"
    );
    // The app pauses a camera that it does not have.
    feed.pause();
    world(|world| world.fails.insert("resume", -13));
    calls();
    feed.set_wanted(false);
    assert!((1..=6).all(|s| poll(&mut feed, s).is_none()));
    assert_eq!(calls(), "", "nobody waits for it");
    feed.set_wanted(true);
    assert!((11..=16).all(|s| poll(&mut feed, s).is_none()));
    let said = calls();
    assert_eq!(said.matches("resume").count(), 2, "every other second: {said}");
    world(|world| world.fails.clear());
    assert!(poll(&mut feed, 18).is_some_and(|told| matches!(told, ShellEvent::ArSession(ArSession::Able))));
    assert!(feed.run(&mut Desk, LOOK).is_none());
    assert!(matches!(poll(&mut feed, 9), Some(ShellEvent::Frame(_))));
    drop(feed);
    assert_clean();
}

#[test]
fn a_card_that_is_refused_is_said_each_time_that_it_is_asked_for() {
    world(|world| world.refuses = vec![("images", 1)]);
    let mut feed = Feed::new(Some(FUNCTIONS));
    let mut said = |run: Run| {
        assert!(feed.run(&mut Desk, run).is_none());
        let mut told = (0..3).map(|_| {
            world(|world| world.time_ns += 1);
            feed.poll(&mut Desk, Duration::ZERO)
        });
        told.by_ref()
            .filter(|told| matches!(told, Some(ShellEvent::CardRefused)))
            .count()
    };
    assert_eq!([LOOK, WITH_CARD, LOOK, WITH_CARD].map(&mut said), [0, 1, 0, 1]);
    world(|world| world.refuses.clear());
    assert_eq!(said(ANEW), 0);
    assert_eq!(said(WITH_CARD), 0, "another session takes it");
    drop(feed);
    assert_clean();
}

#[test]
fn a_package_without_arcore_says_so() {
    let mut feed = Feed::new(None);
    for told in [
        feed.come_back(),
        feed.run(&mut Desk, LOOK),
        feed.run(&mut Desk, ANEW),
    ] {
        assert!(
            matches!(&told, Some(ShellEvent::ArTrouble(ArSession::Unsupported, words)) if words.0[0].contains("without ARCore")),
            "{told:?}"
        );
    }
    // The other app may have released the camera while the app was away.
    let mut feed = Feed::new(Some(FUNCTIONS));
    world(|world| world.fails.insert("resume", -13));
    let told = feed.run(&mut Desk, LOOK);
    assert!(
        matches!(told, Some(ShellEvent::ArTrouble(ArSession::Interrupted, _))),
        "{told:?}"
    );
    assert!(matches!(
        feed.come_back(),
        Some(ShellEvent::ArSession(ArSession::Able))
    ));
    assert!(feed.come_back().is_none(), "once");
}

#[test]
fn an_install_in_the_middle_is_told_and_waited_for() {
    world(|world| {
        world.availability = vec![1, 1, 201];
        world.install = (0, 1);
    });
    let mut feed = Feed::new(Some(FUNCTIONS));
    let said = |told: Option<ShellEvent>| match told {
        Some(ShellEvent::ArTrouble(ArSession::Installing, words)) => words.0[0].clone(),
        Some(ShellEvent::ArSession(ArSession::Able)) => "able".to_owned(),
        None => String::new(),
        other => panic!("{other:?}"),
    };
    let now = Duration::ZERO;
    assert_eq!(
        said(feed.run(&mut Desk, LOOK)),
        "Looking for Google Play Services for AR."
    );
    assert_eq!(said(feed.poll(&mut Desk, now)), "", "once");
    assert_eq!(
        said(feed.poll(&mut Desk, now)),
        "Google Play Services for AR is being installed."
    );
    assert_eq!(
        said(feed.poll(&mut Desk, now)),
        "",
        "and not asked for again while its screen is in front"
    );
    assert_eq!(calls(), "availability availability availability install=1");
    feed.pause();
    world(|world| world.availability = vec![203]);
    assert_eq!(said(feed.run(&mut Desk, LOOK)), "able");
    assert!(matches!(feed.poll(&mut Desk, now), Some(ShellEvent::Frame(_))));
    drop(feed);
    assert_clean();
}

/// Number of variants of each possible fault.
const N_KINDS: [u64; 7] = [5, 4, 4, 4, 3, 3, 2];

/// Makes the world as faulty as the number `index` encodes.
fn spoil(index: u64) {
    let mut left = index;
    let kinds = N_KINDS.map(|n| {
        let kind = left % n;
        left /= n;
        kind
    });
    let pick = |kind: u64, of: &[i32]| of[usize::try_from(kind).expect("a kind")];
    world(|world| {
        world.availability = [vec![203], vec![1, 203], vec![201], vec![0], vec![100]]
            [usize::try_from(kinds[0]).expect("a kind")]
        .clone();
        world.install = [(0, 0), (0, 1), (-105, 0), (-2, 0)][usize::try_from(kinds[1]).expect("a kind")];
        for (name, status) in [
            ("create", pick(kinds[2], &[0, -9, -104, -2])),
            ("resume", pick(kinds[3], &[0, -13, -9, -1])),
            ("update", pick(kinds[4], &[0, -13, -2])),
        ] {
            world.fails.insert(name, status);
        }
        world.modes = vec![[1920, 1080, 30], [1280, 720, 30]];
        world.silent = [vec![], vec![0], vec![0, 1]][usize::try_from(kinds[5]).expect("a kind")].clone();
        world.refuses =
            [vec![], vec![("focus", 1), ("images", 1)]][usize::try_from(kinds[6]).expect("a kind")].clone();
    });
}

/// Runs a feed as an app does, for this many seconds; returns whether a frame came, and the last
/// reported state.
fn live(feed: &mut Feed, from_s: u64, n_s: u64) -> (bool, Option<ArSession>) {
    let (mut has_frame, mut state) = (false, None);
    let mut told = vec![feed.run(&mut Desk, LOOK)];
    for quarter in 0..4 * n_s {
        world(|world| world.time_ns += 1);
        told.push(feed.poll(&mut Desk, Duration::from_millis(1000 * from_s + 250 * quarter)));
        while let Some(event) = told.pop() {
            let Some(event) = event else { continue };
            match event {
                ShellEvent::Frame(_) => {
                    has_frame = true;
                    state = None;
                }
                ShellEvent::ArTrouble(ar_session, words) => {
                    assert!(words.0.iter().all(|text| text.ends_with('.')), "{words:?}");
                    state = Some(ar_session);
                    if ar_session != ArSession::Installing {
                        // The app pauses a camera that does not continue.
                        feed.pause();
                    }
                }
                ShellEvent::ArSession(ArSession::Able) if state == Some(ArSession::Interrupted) => {
                    state = None;
                    told.push(feed.run(&mut Desk, LOOK));
                }
                ShellEvent::ArSession(ArSession::Able) => state = None,
                ShellEvent::Permission(_) => {
                    state = Some(ArSession::Failed);
                    feed.pause();
                }
                other => panic!("{other:?}"),
            }
        }
    }
    (has_frame, state)
}

#[test]
fn in_every_combination_frames_come_or_it_is_said_why_not_and_a_healed_phone_goes_on() {
    let n_all: u64 = N_KINDS.iter().product();
    let (mut n_good, mut n_told) = (0, 0);
    for index in 0..n_all {
        calls();
        spoil(index);
        let mut feed = Feed::new(Some(FUNCTIONS));
        feed.come_back();
        let (has_frame, state) = live(&mut feed, 0, 11);
        assert!(
            has_frame || state.is_some(),
            "{index}: nothing comes, and nothing is said"
        );
        if has_frame {
            n_good += 1;
        } else {
            n_told += 1;
        }
        // The app is left and restarted after the fault was removed: also as a second start in one
        // process.
        feed.pause();
        spoil(0);
        let mut second = Feed::new(Some(FUNCTIONS));
        for feed in [&mut feed, &mut second] {
            let back = feed.come_back();
            assert!(back.is_none_or(|event| matches!(event, ShellEvent::ArSession(ArSession::Able))));
            let (has_frame, state) = live(feed, 100, 1);
            assert!(has_frame && state.is_none(), "{index}: {state:?}");
            feed.pause();
        }
        drop((feed, second));
        assert_clean();
    }
    assert!(n_good > 30 && n_told > 1000, "{n_good} and {n_told} of {n_all}");
}

#[test]
fn no_error_of_a_frame_is_silent() {
    let words = FrameError::NoPictures.to_string();
    world(|world| {
        world.modes = vec![[640, 480, 30]];
        world.silent = vec![0];
    });
    let mut feed = Feed::new(Some(FUNCTIONS));
    let (has_frame, state) = live(&mut feed, 0, 7);
    assert!(!has_frame && state == Some(ArSession::Failed), "{words}");
    drop(feed);
    assert_clean();
}
