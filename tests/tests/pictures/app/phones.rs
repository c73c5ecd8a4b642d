//! Effects of phones on an app: no sequence of events ends in a dead end, the way back works, and
//! the governor reaches its end.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use app_core::Core;
use app_core::app::{
    AlignJob, App, ArSession, GraphicsState, Language, LaunchHistory, Notice, Permission, PlatformCommand,
    ShellCommand, ShellEvent, Step, Thermal, UserAction, WorkCommand,
};
use app_core::camera_frame::Tracking;
use app_core::core::as_shown;
use app_core::frame::Clock;
use app_core::gpu::fault_of_pipeline_caches;
use app_core::interface::Interface;
use app_core::live::Live;
use app_core::preset::Preset;
use app_core::toy::Toy;
use app_core::wgpu;
use glam::DVec2;

use crate::app::world;

/// An app that searches for a table.
fn looking() -> App {
    let mut app = world::app();
    for event in world::opening() {
        let _ = app.event(event);
    }
    app
}

fn buttons(app: &App) -> Vec<String> {
    let screen = world::screen(844, 390);
    let mut interface = Interface::default();
    interface.actions(app, &screen);
    interface.actions(app, &screen);
    let buttons = interface
        .widgets()
        .iter()
        .filter(|widget| widget.role == "Button");
    buttons.map(|widget| widget.label.clone()).collect()
}

/// A frame after this many tenths of a second.
fn frame_at(app: &mut App, id: u64, tenths: u32, tracking: Tracking) -> Vec<ShellCommand> {
    let frame = world::frame(id, 100_000_000 * i64::from(tenths), 0, tracking);
    app.event(ShellEvent::Frame(Box::new(frame)))
}

#[test]
fn every_sheet_has_a_way_out() {
    let troubles = [
        ShellEvent::ArTrouble(
            ArSession::Unsupported,
            ["This phone cannot run ARCore.", "Auf Deutsch."].into(),
        ),
        ShellEvent::ArTrouble(
            ArSession::Installing,
            ["It is being installed.", "Auf Deutsch."].into(),
        ),
        ShellEvent::ArTrouble(ArSession::Failed, ["ARCore failed.", "Auf Deutsch."].into()),
        ShellEvent::ArSession(ArSession::Interrupted),
        ShellEvent::Permission(Permission::Denied),
        ShellEvent::Permission(Permission::Barred),
        ShellEvent::Graphics(GraphicsState::Lost),
        ShellEvent::Thermal(Thermal::Critical),
    ];
    let mut apps: Vec<App> = troubles
        .into_iter()
        .map(|trouble| {
            let mut app = looking();
            let _ = app.event(trouble);
            app
        })
        .collect();
    for tracking in [
        Tracking::Starting,
        Tracking::TooFast,
        Tracking::TooPlain,
        Tracking::TooDark,
        Tracking::Relocalising,
    ] {
        let mut app = looking();
        let _ = frame_at(&mut app, 1, 0, tracking);
        apps.push(app);
    }
    for app in &apps {
        let what = format!("{:?} in {:?}", app.obstacle(), app.step());
        assert!(app.obstacle().is_some(), "{what}");
        assert!(!buttons(app).is_empty(), "no way out of {what}");
    }
    assert!(buttons(&apps[0]).contains(&"Try again".to_owned()));
}

#[test]
fn what_the_platform_says_of_ar_is_read_and_it_can_be_tried_again() {
    let mut app = looking();
    let words = "Google Play Services for AR is too old.";
    let german = "Google Play-Dienste für AR sind zu alt.";
    let _ = app.event(ShellEvent::ArTrouble(
        ArSession::Unsupported,
        [words, german].into(),
    ));
    let mut interface = Interface::default();
    interface.actions(&app, &world::screen(844, 390));
    interface.actions(&app, &world::screen(844, 390));
    assert!(interface.widgets().iter().any(|widget| widget.label == words));
    let _ = app.event(ShellEvent::Language(Language::German));
    interface.actions(&app, &world::screen(844, 390));
    assert!(interface.widgets().iter().any(|widget| widget.label == german));
    let commands = app.event(ShellEvent::User(UserAction::TryAgain));
    let runs = commands.iter().any(|command| {
        matches!(
            command,
            ShellCommand::Platform(PlatformCommand::RunTracking {
                is_new_world: true,
                ..
            })
        )
    });
    assert!(runs && app.ar_words().is_none(), "{commands:?}");
    // The app requests an AR service that is being installed all the same, so that it continues by
    // itself.
    let commands = app.event(ShellEvent::ArTrouble(ArSession::Installing, ["", ""].into()));
    assert!(commands.is_empty(), "{commands:?}");
    assert!(app.event(ShellEvent::ArSession(ArSession::Able)).is_empty());
}

#[test]
fn a_place_that_is_looked_for_in_vain_is_given_up_after_ten_seconds_and_only_before_it_was_chosen() {
    let starts_anew = |app: &mut App| {
        let mut id = 10;
        (0..120_u32).find(|tenth| {
            id += 1;
            let commands = frame_at(app, id, 10 + tenth, Tracking::Relocalising);
            let is_anew = |command: &ShellCommand| {
                matches!(
                    command,
                    ShellCommand::Platform(PlatformCommand::RunTracking {
                        is_new_world: true,
                        ..
                    })
                )
            };
            commands.iter().any(is_anew)
        })
    };
    let mut app = looking();
    let after = starts_anew(&mut app).expect("a new world");
    assert!((99..=101).contains(&after), "{after} tenths of a second");
    assert_eq!(app.step(), Step::FindTable);
    let mut placed = world::at_ghost();
    assert_eq!(
        starts_anew(&mut placed),
        None,
        "a place that was chosen is waited for"
    );
}

#[test]
fn the_card_is_looked_for_where_a_person_has_one() {
    let finds_card = |commands: &[ShellCommand]| {
        commands.iter().find_map(|command| match command {
            ShellCommand::Platform(PlatformCommand::RunTracking { finds_card, .. }) => Some(*finds_card),
            _ => None,
        })
    };
    let mut app = world::app();
    assert_eq!(finds_card(&world::begun(&mut app)), Some(false));
    let _ = frame_at(&mut app, 1, 0, Tracking::Normal);
    assert!(buttons(&app).contains(&"I have the card".to_owned()));
    assert_eq!(
        finds_card(&app.event(ShellEvent::User(UserAction::UseCard(true)))),
        Some(true)
    );
    assert!(!buttons(&app).contains(&"I have the card".to_owned()));
    assert!(buttons(&app).contains(&"I have no card".to_owned()));
    assert_eq!(
        finds_card(&app.event(ShellEvent::User(UserAction::UseCard(false)))),
        Some(false)
    );
    // It was requested, but the platform does not support it.
    let _ = app.event(ShellEvent::User(UserAction::UseCard(true)));
    assert_eq!(finds_card(&app.event(ShellEvent::CardRefused)), Some(false));
    assert!(!app.uses_card() && app.notice() == Some(&Notice::CardRefused));
    assert!(app.log().text().contains("CardRefused"));
}

#[test]
fn the_card_costs_nothing_once_the_toy_is_placed() {
    let mut app = world::at_ghost();
    let ran = |commands: Vec<ShellCommand>| format!("{commands:?}");
    let asked = ran(app.event(ShellEvent::User(UserAction::UseCard(true))));
    assert!(
        asked.contains("finds_card: true"),
        "the lens is taken there: {asked}"
    );
    let asked = ran(app.event(ShellEvent::User(UserAction::Placed)));
    assert!(asked.contains("finds_card: false"), "{asked}");
    let asked = ran(app.event(ShellEvent::User(UserAction::Replace)));
    assert!(asked.contains("finds_card: true"), "{asked}");
}

#[test]
fn back_leads_back_step_by_step() {
    let back = |app: &mut App| {
        let action = app.back();
        action.map(|action| {
            let _ = app.event(ShellEvent::User(action));
            app.step()
        })
    };
    assert_eq!(back(&mut world::app()), None, "the first screen");
    assert_eq!(back(&mut looking()), None, "there is nothing to lose");
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::Placed));
    assert_eq!(back(&mut app), Some(Step::PlaceToy));
    let _ = app.event(ShellEvent::ToyFiles(vec!["Llama".to_owned()]));
    assert_eq!(back(&mut app), Some(Step::PlaceToy), "closes what is open");
    assert!(app.toy_files().is_none());
    assert_eq!(back(&mut app), Some(Step::FindTable));
    let _ = app.event(ShellEvent::Thermal(Thermal::Critical));
    assert_eq!(back(&mut app), Some(Step::Welcome), "out of what is in the way");
}

#[test]
fn a_package_for_engineers_counts_nothing_tests_each_start_and_never_falls_back() {
    let mut history = LaunchHistory::read("unfinished 2\npassed one\nsimple\n").for_engineers();
    history.begin();
    assert_eq!(history.text(), "unfinished 0\npassed one\n");
    let mut app = world::app();
    let commands = app.event(ShellEvent::Started(history));
    assert!(
        !remembers(&commands) && app.wants_self_test("one"),
        "{commands:?}"
    );
    app.note_self_test("12.00 codes off");
    let _ = app.self_tested("one", Err("it is off".to_owned()));
    assert_eq!(app.preset(Preset::Balanced), Preset::Balanced);
    assert!(
        app.log().text().contains("12.00 codes off"),
        "{}",
        app.log().text()
    );
    for is_there in [false, true] {
        let commands = app.event(ShellEvent::Foreground(is_there));
        assert!(!remembers(&commands), "stopping it in front counts for nothing");
    }
}

fn remembers(commands: &[ShellCommand]) -> bool {
    let mut commands = commands.iter();
    commands.any(|command| matches!(command, ShellCommand::Work(WorkCommand::Remember(_))))
}

#[test]
fn a_surface_waits_for_the_display_whatever_is_offered_first() {
    use wgpu::PresentMode::{AutoNoVsync, AutoVsync, Fifo, FifoRelaxed, Immediate, Mailbox};
    for present_mode in [AutoNoVsync, AutoVsync, Fifo, FifoRelaxed, Immediate, Mailbox] {
        let offered = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format: wgpu::TextureFormat::Bgra8UnormSrgb,
            color_space: wgpu::SurfaceColorSpace::default(),
            width: 4,
            height: 2,
            present_mode,
            desired_maximum_frame_latency: 2,
            alpha_mode: wgpu::CompositeAlphaMode::Auto,
            view_formats: Vec::new(),
        };
        let shown = as_shown(offered);
        assert_eq!(
            (shown.present_mode, shown.format),
            (Fifo, wgpu::TextureFormat::Bgra8Unorm),
            "{present_mode:?}"
        );
    }
}

#[test]
fn one_maker_is_not_asked_to_keep_pipelines() {
    let info = |name: &str, vendor| wgpu::AdapterInfo {
        name: name.to_owned(),
        vendor,
        ..wgpu::AdapterInfo::new(wgpu::DeviceType::IntegratedGpu, wgpu::Backend::Vulkan)
    };
    assert!(fault_of_pipeline_caches(&info("PowerVR D-Series DXT-48-1536 MC1", 0x1010)).is_some());
    assert_eq!(fault_of_pipeline_caches(&info("Adreno 610", 0x5143)), None);
}

/// An app whose toy moves, on a core that draws nothing, and the clock for timing its pictures, in
/// milliseconds.
struct Moving {
    live: Live,
    now_ms: Arc<AtomicU64>,
    /// Milliseconds that pass with each reading of the clock, as while a picture is made.
    look_ms: Arc<AtomicU64>,
    n_frames: u64,
    /// Number of camera pictures for each drawn one.
    n_each: u64,
    jobs: Vec<AlignJob>,
}

impl Moving {
    fn new() -> Self {
        let mut live = Live::new(Core::counting(), world::toy(), Preset::Balanced);
        let now_ms = Arc::new(AtomicU64::new(0));
        let look_ms = Arc::new(AtomicU64::new(0));
        let (clock, look) = (Arc::clone(&now_ms), Arc::clone(&look_ms));
        live.set_clock(Clock::new(move || {
            clock.fetch_add(look.load(Ordering::SeqCst), Ordering::SeqCst) as f64
        }));
        live.set_target_fps(30);
        let mut moving = Self {
            live,
            now_ms,
            look_ms,
            n_frames: 0,
            n_each: 1,
            jobs: Vec::new(),
        };
        for event in world::opening() {
            moving.tell(event);
        }
        moving.picture();
        for action in [
            UserAction::Tap(DVec2::new(32.0, 24.0)),
            UserAction::SkipPlate,
            UserAction::Placed,
        ] {
            moving.tell(ShellEvent::User(action));
        }
        moving
    }

    fn tell(&mut self, event: ShellEvent) {
        for command in self.live.event(event) {
            if let ShellCommand::Work(WorkCommand::Align(job)) = command {
                self.jobs.push(*job);
            }
        }
    }

    /// An app whose toy moves.
    fn playing() -> Self {
        let mut moving = Self::new();
        while moving.live.app().step() != Step::Play {
            moving.picture();
        }
        assert_eq!(moving.live.preset(), Preset::Balanced);
        moving
    }

    /// Number of pictures until the preset is `fast`; `None` if it is not within `n`.
    fn pictures_to_fast(&mut self, n: u32) -> Option<u32> {
        (0..n).find(|_| {
            self.picture();
            self.live.preset() == Preset::Fast
        })
    }

    /// Delivers a picture of the camera and draws it.
    fn picture(&mut self) {
        self.n_frames += self.n_each;
        let time_ns = i64::try_from(self.n_frames).unwrap() * 33_000_000;
        self.tell(ShellEvent::Frame(Box::new(world::frame(
            self.n_frames,
            time_ns,
            0,
            Tracking::Normal,
        ))));
        if let Some(job) = self.jobs.pop() {
            let alignment = world::alignment(job.input(), Some(0.1));
            self.tell(ShellEvent::Aligned(Box::new(job.known(alignment))));
        }
        self.now_ms.fetch_add(33 * self.n_each, Ordering::SeqCst);
        let time_s = self.now_ms.load(Ordering::SeqCst) as f64 / 1e3;
        let commands = self.live.present(&world::screen(64, 48), time_s).unwrap();
        drop(commands);
    }
}

#[test]
fn heat_turns_everything_down_and_then_leads_to_the_fast_preset_and_back() {
    let mut moving = Moving::playing();
    moving.tell(ShellEvent::Thermal(Thermal::Serious));
    let n_pictures = moving.pictures_to_fast(2000).expect("the fast preset");
    assert!(n_pictures > 900, "steps come first: {n_pictures}");
    assert!(moving.live.app().log().text().contains("preset fast"));
    // After two minutes of low temperature its preset is restored.
    moving.tell(ShellEvent::Thermal(Thermal::Nominal));
    moving.now_ms.fetch_add(121_000, Ordering::SeqCst);
    moving.picture();
    moving.picture();
    assert_eq!(moving.live.preset(), Preset::Balanced);
}

#[test]
fn pictures_that_take_too_long_lead_to_the_fast_preset_until_there_is_another_toy() {
    let mut moving = Moving::playing();
    assert_eq!(moving.pictures_to_fast(1000), None, "quick ones do not");
    moving.look_ms.store(20, Ordering::SeqCst);
    let n_pictures = moving.pictures_to_fast(2000).expect("the fast preset");
    assert!(n_pictures > 90, "steps come first: {n_pictures}");
    assert!(moving.live.app().log().text().contains("preset fast"));
    moving.look_ms.store(0, Ordering::SeqCst);
    assert!(
        (0..200).all(|_| {
            moving.picture();
            moving.live.preset() == Preset::Fast
        }),
        "the same toy would be as slow again"
    );
    let another = Arc::new(Toy::from_glb("another.glb", &world::toy_file()).unwrap());
    moving.tell(ShellEvent::Toy(Ok(another)));
    moving.picture();
    assert_eq!(moving.live.preset(), Preset::Balanced);
}

#[test]
fn a_camera_whose_pictures_are_not_all_seen_counts_as_slow() {
    let mut moving = Moving::playing();
    moving.n_each = 2;
    assert!(moving.pictures_to_fast(2000).is_some());
}

#[test]
fn the_shells_own_part_of_a_picture_counts_for_it() {
    let mut moving = Moving::playing();
    let slow = |moving: &mut Moving| {
        // Time for reading the camera's picture, then for drawing.
        moving.live.begin_picture();
        moving.now_ms.fetch_add(60, Ordering::SeqCst);
        moving.picture();
        moving.live.preset() == Preset::Fast
    };
    assert!((0..2000).any(|_| slow(&mut moving)));
}

#[test]
fn a_package_for_engineers_keeps_its_preset_and_says_once_what_would_be_next() {
    let mut moving = Moving::new();
    let mut history = LaunchHistory::default().for_engineers();
    history.begin();
    moving.tell(ShellEvent::Started(history));
    while moving.live.app().step() != Step::Play {
        moving.picture();
    }
    moving.look_ms.store(20, Ordering::SeqCst);
    assert_eq!(moving.pictures_to_fast(600), None);
    let log = moving.live.app().log().text();
    assert_eq!(log.matches("preset fast would be next").count(), 1, "{log}");
}
