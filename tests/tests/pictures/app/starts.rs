//! Unfinished starts lead to the simplest preset, and back from there.

use app_core::app::{
    App, LaunchHistory, MAX_FAILED_LAUNCHES, N_GOOD_FRAMES, Notice, Panics, ShellCommand, ShellEvent,
    Simplified, UserAction, WorkCommand,
};
use app_core::interface::Screen;
use app_core::live::Live;
use app_core::preset::Preset;

use crate::app::world;

/// The stored values, and the apps of successive starts.
#[derive(Default)]
struct Phone {
    kept: String,
}

impl Phone {
    fn start(&mut self) -> App {
        let mut history = LaunchHistory::read(&self.kept);
        history.begin();
        self.kept = history.text();
        let mut app = world::app();
        self.tell(&mut app, ShellEvent::Started(history));
        self.tell(&mut app, ShellEvent::Foreground(true));
        app
    }

    fn tell(&mut self, app: &mut App, event: ShellEvent) {
        for command in app.event(event) {
            if let ShellCommand::Work(command) = command {
                self.obey(command);
            }
        }
    }

    fn obey(&mut self, command: WorkCommand) {
        if let WorkCommand::Remember(text) = command {
            self.kept = text;
        }
    }

    fn test(&mut self, app: &mut App, device: &str, outcome: Result<(), String>) {
        app.self_tested(device, outcome)
            .into_iter()
            .for_each(|command| self.obey(command));
    }

    fn draw(&mut self, app: &mut App, n_frames: u32) {
        for _ in 0..n_frames {
            app.drawn().into_iter().for_each(|command| self.obey(command));
        }
    }
}

#[test]
fn after_starts_that_fail_in_a_row_the_simplest_preset_is_used_and_said() {
    let mut phone = Phone::default();
    for n in 0..MAX_FAILED_LAUNCHES {
        let mut app = phone.start();
        assert_eq!(app.preset(Preset::Best), Preset::Best, "start {n}");
        assert_eq!(app.notice(), None);
        // The app ends before the start counts as good.
        phone.draw(&mut app, N_GOOD_FRAMES - 1);
    }
    let mut app = phone.start();
    assert_eq!(app.preset(Preset::Best), Preset::Flat);
    assert_eq!(
        app.notice(),
        Some(&Notice::Simplified(Simplified::FailedLaunches))
    );
    // It stays simple, however good it is, until the person wants it otherwise.
    phone.draw(&mut app, N_GOOD_FRAMES);
    let mut app = phone.start();
    assert_eq!(app.preset(Preset::Best), Preset::Flat);
    phone.tell(&mut app, ShellEvent::User(UserAction::RestorePreset));
    assert_eq!((app.preset(Preset::Best), app.simplified()), (Preset::Best, None));
    // The start that restored it is one of those that count.
    for _ in 1..MAX_FAILED_LAUNCHES {
        assert_eq!(phone.start().simplified(), None);
    }
    assert_eq!(phone.start().simplified(), Some(Simplified::FailedLaunches));
}

#[test]
fn a_good_start_clears_those_that_failed() {
    let mut phone = Phone::default();
    for _ in 0..5 {
        for _ in 1..MAX_FAILED_LAUNCHES {
            let _ = phone.start();
        }
        let mut app = phone.start();
        assert_eq!(app.simplified(), None);
        phone.draw(&mut app, N_GOOD_FRAMES);
    }
    // A crash long afterwards is the first of a series.
    let _ = phone.start();
    assert_eq!(phone.start().simplified(), None);
}

#[test]
fn an_app_that_is_left_has_not_failed() {
    let mut phone = Phone::default();
    for _ in 0..10 {
        let mut app = phone.start();
        assert_eq!(app.simplified(), None);
        // To the background and back, and finally away: the system may end it there.
        for is_foreground in [false, false, true, true, false] {
            phone.tell(&mut app, ShellEvent::Foreground(is_foreground));
        }
    }
    // An app that has come back to the foreground can fail as well.
    for _ in 0..MAX_FAILED_LAUNCHES {
        let mut app = phone.start();
        assert_eq!(app.simplified(), None);
        phone.tell(&mut app, ShellEvent::Foreground(false));
        phone.tell(&mut app, ShellEvent::Foreground(true));
    }
    assert_eq!(phone.start().simplified(), Some(Simplified::FailedLaunches));
}

#[test]
fn a_device_is_tested_once_and_each_time_while_it_fails() {
    let mut phone = Phone::default();
    let fault = || Err("red is blue".to_owned());
    for _ in 0..3 {
        let mut app = phone.start();
        assert!(app.wants_self_test("Adreno\n(1)"));
        phone.test(&mut app, "Adreno\n(1)", fault());
        assert_eq!(app.preset(Preset::Balanced), Preset::Flat);
        let simplified = Simplified::SelfTest("red is blue".to_owned());
        assert_eq!(app.notice(), Some(&Notice::Simplified(simplified)));
        phone.draw(&mut app, N_GOOD_FRAMES);
    }
    let mut app = phone.start();
    phone.test(&mut app, "Adreno\n(1)", Ok(()));
    assert_eq!(app.preset(Preset::Balanced), Preset::Balanced);
    phone.draw(&mut app, N_GOOD_FRAMES);
    let mut app = phone.start();
    assert!(!app.wants_self_test("Adreno\n(1)"));
    // Another driver, which the person trusts in spite of the test.
    assert!(app.wants_self_test("Adreno (2)"));
    phone.test(&mut app, "Adreno (2)", fault());
    phone.tell(&mut app, ShellEvent::User(UserAction::RestorePreset));
    assert_eq!(app.preset(Preset::Balanced), Preset::Balanced);
    assert!(!phone.start().wants_self_test("Adreno (2)"));
}

#[test]
fn whatever_is_kept_is_read() {
    let mut starts = LaunchHistory::read("passed one (a b)\nunfinished 1\nsimple\n");
    assert_eq!(starts, LaunchHistory::read(&starts.text()));
    assert_eq!(starts.text(), "unfinished 1\nsimple\npassed one (a b)\n");
    for text in [
        "",
        "unfinished -7",
        "unfinished 99999999999999999999",
        "\0\0",
        "simple as that",
    ] {
        assert_eq!(LaunchHistory::read(text), LaunchHistory::default(), "{text:?}");
    }
    starts = LaunchHistory::read("unfinished 4294967295");
    starts.begin();
    assert_eq!(starts.text(), "unfinished 1\nsimple\n");
}

const SCREEN: Screen = world::screen(320, 480);

fn open_live() -> Live {
    Live::new(harness::open_core(), world::toy(), Preset::Balanced)
}

/// The stored values once an app has compiled its preset.
fn kept_after_compiling(mut live: Live, text: &str) -> (Live, Vec<String>) {
    let mut commands = live.event(ShellEvent::Started(LaunchHistory::read(text)));
    for n in 0..100 {
        commands.extend(live.screenshot(&SCREEN, f64::from(n) / 30.0).unwrap().1);
    }
    let kept = commands.into_iter().filter_map(|command| match command {
        ShellCommand::Work(WorkCommand::Remember(text)) => Some(text),
        _ => None,
    });
    (live, kept.collect())
}

#[test]
fn a_device_that_passes_is_remembered_and_not_tested_again() {
    let (live, kept) = kept_after_compiling(open_live(), "unfinished 1");
    let [kept] = &kept[..] else {
        panic!("kept: {kept:?}");
    };
    assert!(
        kept.contains("\npassed ") && live.app().simplified().is_none(),
        "{kept}"
    );
    let tested = live.app().log().text();
    assert!(tested.contains("self-test"), "{tested}");
    let (live, kept) = kept_after_compiling(open_live(), kept);
    assert_eq!(kept, [""; 0]);
    assert!(!live.app().log().text().contains("self-test"));
}

/// The test would fail, and the app would draw with the simplest preset.
#[test]
fn a_device_with_other_shaders_draws_no_test_picture() {
    let mut live = open_live();
    let unused = ("common/unused".to_owned(), String::new());
    live.replace_shaders([unused].into_iter().collect()).unwrap();
    let (live, kept) = kept_after_compiling(live, "unfinished 1");
    assert_eq!(kept, [""; 0]);
    assert!(!live.app().log().text().contains("self-test"));
}

#[test]
fn after_a_panic_the_app_begins_anew_and_says_so_but_not_for_ever() {
    let mut panics = Panics::default();
    let anew: Vec<bool> = [0.0, 1.0, 2.0].map(|time_s| panics.begins_anew(time_s)).into();
    // The last of them begins with the simplest preset.
    assert_eq!(anew, [true, true, false]);
    assert!(panics.begins_anew(3600.0), "the others are long past");

    let mut app = world::app();
    let _ = app.event(ShellEvent::Restarted);
    assert_eq!(app.notice(), Some(&Notice::Restarted));
    assert!(app.log().text().contains("Restarted"), "{}", app.log().text());
}
