//! The interface without a device: its labels and touch targets, on every screen.

use std::collections::BTreeSet;

use app_core::app::{App, GraphicsState, Language, Permission, ShellEvent, Step, UserAction};
use app_core::camera_frame::Tracking;
use app_core::interface::accesskit::{Action, ActionRequest, Role, TreeId, TreeUpdate};
use app_core::interface::{Insets, Interface, Screen, Touch, TouchPhase, Widget, all_words};
use glam::DVec2;

use super::happenings::Happening;
use super::orders::{happen, straight};
use crate::app::world;

/// Smallest height of a touch target, in points.
const TOUCH_POINTS: f64 = 44.0;

const PORTRAIT: Screen = Screen {
    size_px: [1080, 2340],
    pixels_per_point: 3.0,
    insets: Insets {
        left_px: 0.0,
        top_px: 140.0,
        right_px: 0.0,
        bottom_px: 100.0,
    },
    text_scale: 1.0,
};

fn screens() -> [(&'static str, Screen); 3] {
    let landscape = Screen {
        size_px: [2340, 1080],
        insets: Insets {
            left_px: 140.0,
            right_px: 140.0,
            top_px: 0.0,
            bottom_px: 60.0,
        },
        ..PORTRAIT
    };
    let large = Screen {
        text_scale: 1.5,
        ..PORTRAIT
    };
    [
        ("portrait", PORTRAIT),
        ("landscape", landscape),
        ("large text", large),
    ]
}

fn widgets(app: &App, screen: &Screen) -> Vec<Widget> {
    let mut interface = Interface::default();
    // Sheets get their size with the first picture.
    for _ in 0..3 {
        interface.actions(app, screen);
    }
    interface.widgets().to_vec()
}

/// The events that lead from one screen to the next.
fn events() -> Vec<ShellEvent> {
    vec![
        ShellEvent::Foreground(true),
        ShellEvent::Permission(Permission::Barred),
        ShellEvent::Permission(Permission::Denied),
        ShellEvent::Permission(Permission::Granted),
        ShellEvent::User(UserAction::Begin),
        ShellEvent::Graphics(GraphicsState::Ready),
        ShellEvent::Frame(Box::new(world::frame(1, 0, 0, Tracking::TooDark))),
        ShellEvent::Frame(Box::new(world::frame(2, 33_000_000, 0, Tracking::Normal))),
        ShellEvent::User(UserAction::CheckPhone(true)),
        ShellEvent::User(UserAction::Answer(true)),
        ShellEvent::User(UserAction::Answer(true)),
        ShellEvent::User(UserAction::Answer(true)),
        ShellEvent::User(UserAction::CheckPhone(false)),
        // This pixel is beside the table.
        ShellEvent::User(UserAction::Tap(DVec2::new(32.0, -400.0))),
        ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))),
        ShellEvent::Frame(Box::new(world::frame(3, 66_000_000, 0, Tracking::Normal))),
        ShellEvent::User(UserAction::SkipPlate),
        ShellEvent::User(UserAction::ByHand),
        ShellEvent::User(UserAction::Placed),
    ]
}

/// The app on each of its screens except that of the last step, which needs a found toy.
fn apps(language: Language) -> Vec<App> {
    let apps = (1..=events().len()).map(|n| {
        let mut app = world::app();
        let _ = app.event(ShellEvent::Language(language));
        for event in events().into_iter().take(n) {
            let _ = app.event(event);
        }
        app
    });
    apps.collect()
}

#[test]
fn whatever_is_touched_is_large_enough_read_out_and_on_the_screen() {
    let apps: Vec<App> = Language::ALL.into_iter().flat_map(apps).collect();
    assert_eq!(apps.last().unwrap().step(), Step::Align);
    for app in &apps {
        for (name, screen) in screens() {
            let at = format!("{name}, {:?}, {:?}", app.step(), app.obstacle());
            let widgets = widgets(app, &screen);
            assert!(
                widgets.iter().any(|widget| widget.role == "Label"),
                "{at}: nothing is said"
            );
            for Widget {
                role,
                label,
                bounds_px,
            } in widgets
            {
                let [left, top, right, bottom] = bounds_px;
                let Insets {
                    left_px,
                    top_px,
                    right_px,
                    bottom_px,
                } = screen.insets;
                let [width, height] = screen.size_px.map(f64::from);
                let is_inside = left >= left_px
                    && top >= top_px
                    && right <= width - right_px
                    && bottom <= height - bottom_px;
                if role == "Button" {
                    let low_points = (bottom - top) / screen.pixels_per_point;
                    assert!(
                        low_points > TOUCH_POINTS - 0.5,
                        "{at}: «{label}» is {low_points} points high"
                    );
                }
                assert!(is_inside, "{at}: «{label}» lies at {bounds_px:?}");
                assert!(!label.trim().is_empty(), "{at}: a {role} without a word");
            }
        }
    }
}

#[test]
fn with_large_letters_the_next_step_needs_no_scrolling() {
    let low = Screen {
        text_scale: 1.6,
        ..world::screen(844, 390)
    };
    let mut found = BTreeSet::new();
    for app in &apps(Language::English) {
        for Widget { label, bounds_px, .. } in widgets(app, &low) {
            if ["Begin", "Here"].contains(&label.as_str()) {
                // A sheet has 12 points around it, and 16 within.
                let [_, top, _, bottom] = bounds_px;
                let margin_px = 28.0 * low.text_scale - 1.0;
                assert!(
                    top > margin_px && bottom < 390.0 - margin_px,
                    "{label}: {bounds_px:?}"
                );
                found.insert(label);
            }
        }
    }
    assert_eq!(found.len(), 2, "{found:?}");
}

#[test]
fn a_sheet_is_the_same_whichever_came_before() {
    for (name, screen) in screens() {
        let mut interface = Interface::default();
        for app in &apps(Language::English) {
            for _ in 0..3 {
                interface.actions(app, &screen);
            }
            let at = format!("{name}, {:?}, {:?}", app.step(), app.obstacle());
            assert_eq!(interface.widgets(), widgets(app, &screen), "{at}");
        }
    }
}

#[test]
fn a_finger_presses_the_button_below_it() {
    let mut app = world::app();
    let _ = app.event(ShellEvent::Foreground(true));
    let mut interface = Interface::default();
    interface.actions(&app, &PORTRAIT);
    interface.actions(&app, &PORTRAIT);
    let begin = interface
        .widgets()
        .iter()
        .find(|widget| widget.label == "Begin")
        .unwrap();
    let [left, top, right, bottom] = begin.bounds_px;
    let mut press = |at_px| {
        let mut actions = Vec::new();
        for phase in [TouchPhase::Began, TouchPhase::Ended] {
            interface.touch(Touch { id: 4, phase, at_px });
            actions.extend(interface.actions(&app, &PORTRAIT));
        }
        actions
    };
    assert_eq!(
        press([0.5 * (left + right), 0.5 * (top + bottom)]),
        [UserAction::Begin]
    );
    assert_eq!(press([5.0, 5.0]), []);
}

/// A screen reader's request for an action of the widget with this role.
fn requested(interface: &Interface, role: Role, action: Action) -> ActionRequest {
    let tree = interface.accessibility_tree().expect("a tree");
    let node = tree
        .nodes
        .iter()
        .find(|(_, node)| node.role() == role && node.supports_action(action));
    ActionRequest {
        action,
        target_tree: TreeId::ROOT,
        target_node: node.expect("a widget").0,
        data: None,
    }
}

#[test]
fn a_screen_reader_presses_buttons_and_moves_the_time() {
    let mut app = world::app();
    let _ = app.event(ShellEvent::Foreground(true));
    let mut interface = Interface::default();
    assert!(interface.accessibility_tree().is_none());
    interface.actions(&app, &PORTRAIT);
    interface.actions(&app, &PORTRAIT);
    let press = requested(&interface, Role::Button, Action::Click);
    interface.request(press);
    assert_eq!(interface.actions(&app, &PORTRAIT), [UserAction::Begin]);
    assert_eq!(interface.actions(&app, &PORTRAIT), [], "once");
    let app = happen(straight());
    let length_s = app.playback().length_s();
    assert!(length_s > 0.0);
    interface.actions(&app, &PORTRAIT);
    for (action, at) in [(Action::Increment, 0.05), (Action::Decrement, 0.0)] {
        let request = requested(&interface, Role::Slider, action);
        interface.request(request);
        let moved = interface.actions(&app, &PORTRAIT);
        let is_moved = |action: &UserAction| matches!(action, UserAction::Scrub(time_s) if (time_s - at * length_s).abs() < 0.1 * length_s);
        assert!(moved.iter().any(is_moved), "{action:?}: {moved:?}");
    }
}

/// The tree of a playing clip after a number of frames, and the clip's time.
fn playing(n_frames: u8) -> (TreeUpdate, f64) {
    let frames = Happening::Frames(n_frames, 33, Tracking::Normal);
    let app = happen(straight().into_iter().chain([frames]).collect());
    let mut interface = Interface::default();
    for _ in 0..3 {
        interface.actions(&app, &PORTRAIT);
    }
    let tree = interface.accessibility_tree().expect("a tree").clone();
    (tree, app.playback().time_s())
}

#[test]
fn a_playing_clip_does_not_disturb_a_screen_reader() {
    let [(early, early_s), (late, late_s)] = [2, 6].map(playing);
    assert!(late_s > early_s, "{early_s} {late_s}");
    assert_eq!(early, late);
}

/// The flaw of a text, given in each language.
fn flaw([english, german]: [&str; Language::ALL.len()]) -> Option<&'static str> {
    let n_filled = |text: &str| text.matches("{}").count();
    let length = |text: &str| text.chars().count() as f64;
    let is_of_font = |text: &str| text.chars().all(|sign| u32::from(sign) < 256);
    let is_long = |one: &str, other: &str| length(one) > 1.45 * length(other) + 12.0;
    #[rustfmt::skip] // Each flaw has a line of its own.
    let flaws = [
        (english.trim().is_empty() || german.trim().is_empty(), "a language lacks them"),
        (n_filled(english) != n_filled(german), "not the same is filled in"),
        (is_long(german, english) || is_long(english, german), "one is much longer"),
        (!is_of_font(english) || !is_of_font(german), "the font lacks a sign"),
    ];
    flaws
        .into_iter()
        .find(|(is_wrong, _)| *is_wrong)
        .map(|(_, flaw)| flaw)
}

#[test]
fn words_are_whole_in_each_language() {
    let words = all_words();
    assert!(words.len() > 100, "{}", words.len());
    for words in words {
        assert_eq!(flaw(words), None, "{words:?}");
    }
    assert_eq!(flaw(["Yes", ""]), Some("a language lacks them"));
    assert_eq!(flaw(["{} lights", "Lichter"]), Some("not the same is filled in"));
    assert_eq!(
        flaw(["Begin", "Hier geht es jetzt also endlich los"]),
        Some("one is much longer")
    );
    assert_eq!(flaw(["Yes", "\u{434}\u{430}"]), Some("the font lacks a sign"));
}

#[test]
fn a_language_is_that_of_its_tag() {
    for (tag, language) in [
        ("de-AT", Language::German),
        ("DE", Language::German),
        ("den", Language::English),
        ("fr-FR", Language::English),
        ("", Language::English),
    ] {
        assert_eq!(Language::of_tag(tag), language, "{tag}");
    }
    let mut app = world::app();
    let _ = app.event(ShellEvent::Language(Language::German));
    let labels: Vec<String> = widgets(&app, &PORTRAIT)
        .into_iter()
        .map(|widget| widget.label)
        .collect();
    assert!(labels.contains(&"Anfangen".to_owned()), "{labels:?}");
}
