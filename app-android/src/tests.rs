//! The shell over the fake of ARCore, with an app whose core counts and draws nothing.

use std::path::{Path, PathBuf};

use app_core::Core;
use app_core::app::{
    Notice, Permission, Saved, ShellCommand, ShellEvent, Step, Thermal, UserAction, WorkCommand,
};
use app_core::interface::{Insets, TouchPhase};
use app_core::live::Live;
use app_core::preset::Preset;
use app_shell::worker::Outcome;
use arcore::fake::{FUNCTIONS, FakePlane, world};
use arcore::feed::Feed;
use arcore::java::{Java, JavaHost};
use glam::DVec2;

use crate::input::{Finger, Motion, screen, touches};
use crate::phone::{Phone, permission, thermal};
use crate::shell::{Shell, bundled_toy};

/// A phone that grants the camera when it is asked for.
#[derive(Default)]
struct Desk {
    allows: bool,
    thermal_status: Option<i32>,
    /// Names of files that were shown in the gallery, and handed on.
    shown: Vec<String>,
    shared: Vec<String>,
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

    fn keep_awake(&mut self, _: bool) {}

    fn thermal_status(&mut self) -> Option<i32> {
        self.thermal_status
    }

    fn folder(&self) -> Option<PathBuf> {
        None
    }

    fn show_in_gallery(&mut self, file: PathBuf) {
        self.shown.push(name(&file));
    }

    fn share(&mut self, files: Vec<PathBuf>) {
        self.shared.extend(files.iter().map(|file| name(file)));
    }

    fn own_folder(&self) -> Option<PathBuf> {
        None
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
        // The camera looks straight down on a table half a metre below it.
        let half = std::f32::consts::FRAC_1_SQRT_2;
        world.pose = [-half, 0.0, 0.0, half, 0.0, 0.5, 0.0];
        world.planes = vec![FakePlane {
            state: 0,
            kind: 0,
            pose: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0],
            outline: vec![0.5, 0.5, -0.5, 0.5, -0.5, -0.5, 0.5, -0.5],
        }];
    });
    let mut shell = shell();
    shell.set_surface(Some([2400, 1080]));
    shell.set_foreground(true);
    shell.tick();
    assert_eq!(calls(), "", "nothing before the person begins");
    shell.tell(ShellEvent::User(UserAction::Begin));
    assert_eq!(shell.live().app().step(), Step::Welcome);
    // Android's question takes the front for a while.
    shell.set_foreground(false);
    shell.set_foreground(true);
    assert_eq!(shell.live().app().step(), Step::FindTable);
    assert!(calls().contains("display=1,2400,1080 resume"));
    shell.tick();
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
    let with_bars = screen([2400, 1080], Some(480), [100, 60, 2300, 1080], 1.5);
    assert_eq!(with_bars.text_scale.to_bits(), 1.5_f64.to_bits());
    assert_eq!(with_bars.pixels_per_point.to_bits(), 3.0_f64.to_bits());
    let insets = Insets {
        left_px: 100.0,
        top_px: 60.0,
        right_px: 100.0,
        bottom_px: 0.0,
    };
    assert_eq!(with_bars.insets, insets);
    let unknown = screen([2400, 1080], None, [0; 4], f32::NAN);
    assert_eq!(unknown.text_scale.to_bits(), 1.0_f64.to_bits());
    assert_eq!(unknown.insets, Insets::default());
    assert_eq!(unknown.pixels_per_point.to_bits(), 1.0_f64.to_bits());
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

/// Calls of functions that take a callback, without a guard right at its beginning.
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
