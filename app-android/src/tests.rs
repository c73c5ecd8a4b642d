//! The shell over the fake of ARCore, with an app whose core counts the work and draws nothing.

use std::path::{Path, PathBuf};
use std::time::Duration;

use app_core::Core;
use app_core::app::{
    GraphicsState, Language, Notice, Permission, Saved, ShellCommand, ShellEvent, Step, Thermal, UserAction,
    WorkCommand,
};
use app_core::interface::{Insets, TouchPhase};
use app_core::live::Live;
use app_core::preset::Preset;
use app_shell::pace::Pace;
use app_shell::worker::Outcome;
use arcore::fake::{FUNCTIONS, FakePlane, world};
use arcore::feed::Feed;
use arcore::java::{Java, JavaHost};
use glam::DVec2;

use crate::input::{BackKey, Finger, Motion, screen, touches};
use crate::phone::{Phone, permission, thermal};
use crate::shell::{Shell, bundled_toy};

/// A phone that grants the camera on request.
#[derive(Default)]
struct Desk {
    allows: bool,
    thermal_status: Option<i32>,
    rotation: i32,
    own: Option<PathBuf>,
    /// Whether the activity was finished.
    is_left: bool,
    /// Names of files that were added to the gallery, and shared.
    shown: Vec<String>,
    shared: Vec<String>,
    /// Announcements to screen readers.
    said: Vec<String>,
    n_knocks: u32,
}

impl JavaHost for Desk {
    fn java(&mut self) -> Java {
        let somewhere = std::ptr::without_provenance_mut(8);
        Java {
            env: somewhere,
            activity: somewhere,
        }
    }
}

impl Phone for Desk {
    fn permission(&mut self) -> Permission {
        permission(self.allows, false, false)
    }

    fn ask_for_camera(&mut self) {
        self.allows = true;
    }

    fn open_settings(&mut self) {}

    fn leave(&mut self) {
        self.is_left = true;
    }

    fn language(&self) -> Language {
        Language::German
    }

    fn say(&mut self, words: String) {
        self.said.push(words);
    }

    fn knock(&mut self) {
        self.n_knocks += 1;
    }

    fn keep_awake(&mut self, _: bool) {}

    fn thermal_status(&mut self) -> Option<i32> {
        self.thermal_status
    }

    fn rotation(&mut self) -> i32 {
        self.rotation
    }

    fn folder(&self) -> Option<PathBuf> {
        None
    }

    fn show_in_gallery(&mut self, file: PathBuf) {
        self.shown.push(name(&file));
    }

    fn share(&mut self, files: Vec<PathBuf>, tell: impl FnOnce(bool) + Send + 'static) {
        self.shared.extend(files.iter().map(|file| name(file)));
        tell(false);
    }

    fn own_folder(&self) -> Option<PathBuf> {
        self.own.clone()
    }
}

fn name(file: &Path) -> String {
    file.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

fn shell() -> Shell<Desk> {
    shell_on(Desk::default())
}

fn shell_on(phone: Desk) -> Shell<Desk> {
    let toy = bundled_toy().expect("the bundled toy");
    let live = Live::new(Core::counting(), toy, Preset::Balanced);
    Shell::new(live, phone, Feed::new(Some(FUNCTIONS)))
}

fn calls() -> String {
    world(|world| std::mem::take(&mut world.calls))
}

#[test]
fn from_the_first_button_to_a_table() {
    world(|world| {
        // The camera looks straight down at a table half a metre below it.
        let half = std::f32::consts::FRAC_1_SQRT_2;
        world.pose = [-half, 0.0, 0.0, half, 0.0, 0.5, 0.0];
        world.planes = vec![FakePlane {
            state: 0,
            kind: 0,
            pose: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            outline: vec![0.5, 0.5, -0.5, 0.5, -0.5, -0.5, 0.5, -0.5],
        }];
    });
    let mut shell = shell_on(Desk {
        rotation: 3,
        ..Desk::default()
    });
    shell.set_surface(Some([2400, 1080]));
    shell.set_foreground(true);
    shell.tick();
    assert_eq!(calls(), "", "nothing before the person begins");
    shell.tell(ShellEvent::User(UserAction::Begin));
    assert_eq!(shell.live().app().step(), Step::Welcome);
    // Android's dialog covers the activity for a while.
    shell.set_foreground(false);
    shell.set_foreground(true);
    assert_eq!(shell.live().app().step(), Step::FindTable);
    assert!(calls().contains("display=3,2400,1080 resume"));
    let said = shell.phone().said.last().cloned().unwrap_or_default();
    assert!(said.starts_with("Zeig den Tisch. "), "{said}");
    assert_eq!(shell.phone().n_knocks, 0);
    shell.tick();
    assert_eq!(shell.phone().n_knocks, 1, "a table was found");
    // A touch counts when nothing is in its way, such as the preparation of graphics.
    shell.tell(ShellEvent::Graphics(GraphicsState::Ready));
    shell.tell(ShellEvent::User(UserAction::Tap(DVec2::new(2.0, 1.0))));
    assert_eq!(shell.live().app().step(), Step::TakePlate);
    assert!(calls().contains("planes=0"), "planes are looked for no longer");
    shell.set_foreground(false);
    assert_eq!(calls(), "pause ");
}

#[test]
fn what_the_worker_cannot_keep_is_told_with_the_next_picture() {
    let mut shell = shell();
    shell.obey(vec![ShellCommand::Work(WorkCommand::Video(true))]);
    shell.tick();
    assert_eq!(
        shell.live().app().notice(),
        Some(&Notice::Saved(Saved::NotAllowed))
    );
}

#[test]
fn files_go_to_the_gallery_or_to_whoever_they_are_shared_with() {
    let mut shell = shell();
    shell.settle(Outcome::Written("photo_1.png".into()));
    assert_eq!(shell.phone().shown, ["photo_1.png"]);
    shell.settle(Outcome::Share(vec!["log.txt".into(), "recording_2.mcap".into()]));
    assert_eq!(shell.phone().shared, ["log.txt", "recording_2.mcap"]);
}

#[test]
fn a_permission_is_what_android_says_of_it() {
    let cases = [
        ((true, false, false), Permission::Granted),
        ((true, true, true), Permission::Granted),
        ((false, false, false), Permission::Unknown),
        ((false, false, true), Permission::Denied),
        ((false, true, true), Permission::Denied),
        ((false, true, false), Permission::Barred),
    ];
    for ((is_granted, was_asked, may_explain), expected) in cases {
        assert_eq!(permission(is_granted, was_asked, may_explain), expected);
    }
}

#[test]
fn fingers_are_told_apart() {
    let fingers = [
        Finger {
            id: 0,
            at_px: [1.0, 2.0],
        },
        Finger {
            id: 3,
            at_px: [5.0, 6.0],
        },
    ];
    let told = |motion| {
        let touches = touches(motion, &fingers).into_iter();
        touches
            .map(|touch| (touch.id, touch.phase, touch.at_px[0]))
            .collect::<Vec<_>>()
    };
    assert_eq!(told(Motion::Down(1)), [(3, TouchPhase::Began, 5.0)]);
    assert_eq!(told(Motion::Up(0)), [(0, TouchPhase::Ended, 1.0)]);
    assert_eq!(told(Motion::Up(2)), []);
    let moved = [(0, TouchPhase::Moved, 1.0), (3, TouchPhase::Moved, 5.0)];
    assert_eq!(told(Motion::Moved), moved);
    let cancelled = [(0, TouchPhase::Cancelled, 1.0), (3, TouchPhase::Cancelled, 5.0)];
    assert_eq!(told(Motion::Cancelled), cancelled);
}

#[test]
fn a_screen_is_measured_in_points_without_what_bars_cover() {
    let with_bars = screen([2400, 1080], Some(480), None, [100, 60, 2300, 1080], 1.5);
    assert_eq!(with_bars.text_scale.to_bits(), 1.5_f64.to_bits());
    assert_eq!(with_bars.pixels_per_point.to_bits(), 3.0_f64.to_bits());
    let insets = Insets {
        left_px: 100.0,
        top_px: 60.0,
        right_px: 100.0,
        bottom_px: 0.0,
    };
    assert_eq!(with_bars.insets, insets);
    // A window that reaches below bars and a cut-out does not report their sizes itself.
    let edge_to_edge = screen(
        [2400, 1080],
        Some(480),
        Some([90, 0, 126, -3]),
        [0, 0, 2400, 1080],
        1.0,
    );
    let covered = Insets {
        left_px: 90.0,
        right_px: 126.0,
        top_px: 0.0,
        bottom_px: 0.0,
    };
    assert_eq!(edge_to_edge.insets, covered);
    let unknown = screen([2400, 1080], None, None, [0; 4], f32::NAN);
    assert_eq!(unknown.text_scale.to_bits(), 1.0_f64.to_bits());
    assert_eq!(unknown.insets, Insets::default());
    assert_eq!(unknown.pixels_per_point.to_bits(), 1.0_f64.to_bits());
}

/// Iterations of the loop and pictures in one second of a clock that advances only during sleep,
/// with drawing that takes no time: the worst case of a display.
fn turns_a_second(pace: &mut Pace, camera_hz: u32, touch_hz: u32) -> (u32, u32) {
    let (mut now, end) = (Duration::from_secs(5), Duration::from_secs(6));
    let (mut n_turns, mut n_pictures, mut n_camera, mut n_touches) = (0, 0, 0, 0);
    while now < end {
        n_turns += 1;
        let passed = (now - Duration::from_secs(5)).as_secs_f64();
        if passed * f64::from(camera_hz) >= f64::from(n_camera) && camera_hz > 0 {
            n_camera += 1;
            pace.camera_came(now);
        }
        if passed * f64::from(touch_hz) >= f64::from(n_touches) && touch_hz > 0 {
            n_touches += 1;
            pace.touched();
        }
        if pace.is_due(now) {
            n_pictures += 1;
            pace.draw(now);
        }
        let slept = pace.sleep(now);
        assert!(slept > Duration::from_millis(1), "it spins");
        // An event may wake the loop earlier.
        let wake = if touch_hz > 0 {
            Duration::from_secs_f64(1.0 / f64::from(touch_hz))
        } else {
            slept
        };
        now += slept.min(wake);
    }
    (n_turns, n_pictures)
}

#[test]
fn the_loop_waits_and_draws_a_picture_for_each_of_the_cameras() {
    let (n_turns, n_pictures) = turns_a_second(&mut Pace::default(), 0, 0);
    assert!(
        n_turns <= 85 && (60..=85).contains(&n_pictures),
        "no camera: {n_turns} turns, {n_pictures} pictures"
    );
    let (n_turns, n_pictures) = turns_a_second(&mut Pace::default(), 30, 0);
    assert!(
        n_turns <= 100 && (29..=31).contains(&n_pictures),
        "{n_turns} turns, {n_pictures} pictures"
    );
    let (_, n_pictures) = turns_a_second(&mut Pace::default(), 30, 240);
    assert!(
        (60..=85).contains(&n_pictures),
        "a finger is followed, no more often than the screen shows: {n_pictures}"
    );
    let mut slow = Pace::default();
    slow.set_rate(30);
    let (_, n_pictures) = turns_a_second(&mut slow, 60, 240);
    assert!((30..=42).contains(&n_pictures), "{n_pictures}");
}

#[test]
fn the_size_of_pictures_that_come_is_kept_for_the_next_start() {
    let own = std::env::temp_dir().join(format!("app-android-{}", std::process::id()));
    std::fs::create_dir_all(&own).expect("a folder");
    std::fs::write(own.join("camera.txt"), "640x480 3").expect("a file");
    let mut shell = shell_on(Desk {
        allows: true,
        own: Some(own.clone()),
        ..Desk::default()
    });
    shell.set_surface(Some([2400, 1080]));
    shell.set_foreground(true);
    shell.tell(ShellEvent::User(UserAction::Begin));
    shell.tick();
    assert!(
        calls().contains("mode=0"),
        "the one that came before, and not the largest"
    );
    std::fs::remove_dir_all(own).expect("a folder");
}

#[test]
fn back_leads_back_and_out_at_last() {
    world(|world| world.availability = vec![100]);
    let mut shell = shell();
    shell.set_foreground(true);
    shell.tell(ShellEvent::User(UserAction::Begin));
    shell.set_foreground(true);
    let words = shell.live().app().ar_words().unwrap_or_default().to_owned();
    // The phone's language is German.
    assert!(
        words.starts_with("Dieses Telefon kann ARCore nicht ausführen."),
        "{words}"
    );
    shell.back();
    assert_eq!(shell.live().app().step(), Step::Welcome);
    assert!(!shell.phone().is_left);
    shell.back();
    assert!(shell.phone().is_left, "the first screen is the last");
}

#[test]
fn a_press_of_back_counts_where_both_halves_of_it_are_seen() {
    let mut key = BackKey::default();
    assert!(!key.release(), "pressed in front of another window");
    key.press();
    assert!(key.release());
    assert!(!key.release(), "once");
    key.press();
    key.cancel();
    assert!(!key.release(), "the focus went meanwhile");
}

#[test]
fn heat_is_told() {
    let mut shell = shell_on(Desk {
        thermal_status: Some(3),
        ..Desk::default()
    });
    shell.tick();
    assert_eq!(shell.live().app().thermal(), Thermal::Serious);
}

#[test]
fn heat_has_four_steps_of_androids_seven() {
    use Thermal::{Critical, Fair, Nominal, Serious};
    let told = [-1, 0, 1, 2, 3, 4, 5, 6].map(thermal);
    assert_eq!(
        told,
        [
            Nominal, Nominal, Fair, Fair, Serious, Critical, Critical, Critical
        ]
    );
}

#[test]
fn the_manifest_names_the_library_that_cargo_builds() {
    let library_name = format!("android:value=\"{}\"", env!("CARGO_PKG_NAME").replace('-', "_"));
    assert!(include_str!("../AndroidManifest.xml").contains(&library_name));
}

/// Calls of functions that take a callback and do not begin with a guard.
fn unguarded(source: &str) -> Vec<&str> {
    let takers = [".poll_events(", ".run_on_java_main_thread(", ".spawn(", ".next(|"];
    let calls = takers.iter().flat_map(|taker| source.split(taker).skip(1));
    calls
        .map(|rest| rest.split_once("\n    }\n").map_or(rest, |(body, _)| body))
        .filter(|body| !body.contains("guarded(\""))
        .collect()
}

#[test]
fn whatever_android_calls_is_guarded() {
    let sources = [
        include_str!("lifecycle.rs"),
        include_str!("java.rs"),
        include_str!("stage.rs"),
    ];
    for source in sources {
        assert_eq!(unguarded(source), [""; 0]);
    }
    let planted = "fn a() {\n        app.poll_events(None, |event| handle(event));\n    }\n";
    assert_eq!(unguarded(planted).len(), 1);
}
