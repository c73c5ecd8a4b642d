//! The commands to the shell are consistent for every order of events.

use app_core::app::{
    AlignJob, AlignedJob, App, GraphicsState, Notice, Permission, Placing, PlateJob, PlatformCommand,
    SearchJob, ShellCommand, ShellEvent, Show, Step, ToyRefusal, UserAction, WatchJob, WorkCommand,
};
use app_core::camera_frame::{Exposure, Tracking};
use app_core::frame::FrameInput;
use app_core::recording::{Ending, RecordingJob};
use glam::DVec2;
use proptest::prelude::*;

use super::happenings::{Happening, happening};
use crate::app::world;

/// A platform that follows commands, and reports inconsistent ones.
#[derive(Default)]
struct Platform {
    permission: Permission,
    is_foreground: bool,
    runs: bool,
    is_locked: bool,
    n_runs: u32,
    is_dark: bool,
    is_awake: bool,
    makes_video: bool,
    records: bool,
    n_frames: u64,
    time_ns: i64,
    world_epoch: u32,
    jobs: Vec<AlignJob>,
    plates: Vec<PlateJob>,
    searches: Vec<SearchJob>,
    watches: Vec<WatchJob>,
    recordings: Vec<RecordingJob>,
}

impl Platform {
    fn events(&mut self, happening: Happening) -> Vec<ShellEvent> {
        match happening {
            Happening::Permission(permission) => {
                self.permission = permission;
                vec![ShellEvent::Permission(permission)]
            }
            Happening::Foreground(is_foreground) => {
                self.is_foreground = is_foreground;
                vec![ShellEvent::Foreground(is_foreground)]
            }
            Happening::Surface(is_there) => vec![ShellEvent::Surface(is_there.then_some([640, 360]))],
            Happening::Graphics(device) => vec![ShellEvent::Graphics(device)],
            Happening::ArSession(ar_session) => vec![ShellEvent::ArSession(ar_session)],
            Happening::Frames(n, elapsed_ms, tracking) => {
                let frames = (0..n).map(|_| {
                    self.n_frames += 1;
                    self.time_ns += 1_000_000 * elapsed_ms;
                    self.frame(tracking)
                });
                frames.collect()
            }
            Happening::StaleFrame(is_older) => {
                let time_ns = self.time_ns - if is_older { 1_000_000_000 } else { 0 };
                let frame = world::frame(self.n_frames, time_ns, self.world_epoch, Tracking::Normal);
                vec![ShellEvent::Frame(Box::new(frame))]
            }
            Happening::NewWorld => {
                self.world_epoch += 1;
                Vec::new()
            }
            Happening::Thermal(thermal) => vec![ShellEvent::Thermal(thermal)],
            Happening::MemoryLow => vec![ShellEvent::MemoryLow],
            Happening::Restarted => vec![ShellEvent::Restarted],
            Happening::AlignmentEnds(outline_px) => self.end(|job| {
                let alignment = world::alignment(job.input(), outline_px);
                job.known(alignment)
            }),
            Happening::AlignmentRuns => self.end(AlignJob::run),
            Happening::AlignmentDies => self.end(|job| job.without_result()),
            Happening::WorkEnds(is_whole) => self.end_work(is_whole),
            Happening::OtherToy(is_toy) => {
                let read = if is_toy {
                    Ok(world::toy())
                } else {
                    Err(ToyRefusal::too_large("toy.glb", 64))
                };
                vec![ShellEvent::Toy(read)]
            }
            Happening::Saved(saved) => vec![ShellEvent::Saved(saved)],
            Happening::Filmed(filmed) => vec![ShellEvent::Filmed(filmed)],
            Happening::PictureFails => vec![ShellEvent::PictureFailed("planted".to_owned())],
            Happening::RecordingEnds(is_last) => {
                let place = if is_last {
                    self.recordings.len().checked_sub(1)
                } else {
                    Some(0)
                };
                let place = place.filter(|place| *place < self.recordings.len());
                let ended = place.map(|place| self.recordings.remove(place));
                ended
                    .map(|job| ShellEvent::Recorded(world::full(job)))
                    .into_iter()
                    .collect()
            }
            Happening::FreeSpace(free_bytes) => vec![ShellEvent::FreeSpace(free_bytes)],
            Happening::User(action) => vec![ShellEvent::User(action)],
        }
    }

    /// Ends the work of all threads but alignments, with or without a result.
    fn end_work(&mut self, is_whole: bool) -> Vec<ShellEvent> {
        let plates = self.plates.drain(..);
        let plates = plates.map(|job| is_whole.then(|| Box::new(job.run())));
        let searches = self.searches.drain(..);
        let searches = searches.map(|job| is_whole.then(|| Box::new(job.run())));
        let watches = self
            .watches
            .drain(..)
            .map(|job| if is_whole { job.run() } else { job.without_result() });
        let plates = plates.map(ShellEvent::Plated);
        let watches = watches.map(|done| ShellEvent::Watched(Box::new(done)));
        plates
            .chain(searches.map(ShellEvent::Searched))
            .chain(watches)
            .collect()
    }

    /// Ends the latest alignment, if there is one.
    fn end(&mut self, end: impl FnOnce(AlignJob) -> AlignedJob) -> Vec<ShellEvent> {
        let ended = self.jobs.pop().map(end);
        ended
            .map(|done| ShellEvent::Aligned(Box::new(done)))
            .into_iter()
            .collect()
    }

    fn frame(&self, tracking: Tracking) -> ShellEvent {
        let mut frame = world::frame(self.n_frames, self.time_ns, self.world_epoch, tracking);
        // A camera takes some frames to darken, and may fail.
        let is_dark = self.is_dark && self.n_frames.is_multiple_of(7);
        frame.exposure = Some(Exposure {
            duration_s: if is_dark { 0.01 / 64.0 } else { 0.01 },
            iso: 100.0,
        });
        ShellEvent::Frame(Box::new(frame))
    }

    /// Executes a command, or describes its inconsistency.
    fn obey(&mut self, command: ShellCommand) -> Result<(), String> {
        let is_wrong = match &command {
            ShellCommand::Platform(PlatformCommand::PauseTracking) => !self.runs,
            ShellCommand::Platform(PlatformCommand::LockExposure(_)) => !self.runs,
            // Only a locked exposure can be darkened.
            ShellCommand::Platform(PlatformCommand::Underexpose(is_on)) => {
                !self.runs || !self.is_locked || *is_on == self.is_dark
            }
            ShellCommand::Platform(PlatformCommand::KeepAwake(is_on)) => *is_on == self.is_awake,
            ShellCommand::Work(WorkCommand::Video(is_on)) => *is_on == self.makes_video,
            ShellCommand::Work(WorkCommand::Record(job)) => job.is_some() == self.records,
            // One thread searches at a time.
            ShellCommand::Work(WorkCommand::Search(_)) => !self.searches.is_empty(),
            _ => false,
        };
        if is_wrong {
            return Err(format!("{command:?}"));
        }
        match command {
            ShellCommand::Platform(PlatformCommand::RunTracking { .. }) => {
                // A running camera may keep its exposure, and may not.
                let is_kept = self.runs && self.n_runs.is_multiple_of(2);
                self.is_locked &= is_kept;
                self.is_dark &= is_kept;
                self.runs = true;
                self.n_runs += 1;
            }
            ShellCommand::Platform(PlatformCommand::PauseTracking) => self.runs = false,
            ShellCommand::Platform(PlatformCommand::LockExposure(is_on)) => self.is_locked = is_on,
            ShellCommand::Platform(PlatformCommand::Underexpose(is_on)) => self.is_dark = is_on,
            ShellCommand::Platform(PlatformCommand::KeepAwake(is_on)) => self.is_awake = is_on,
            ShellCommand::Work(WorkCommand::Video(is_on)) => self.makes_video = is_on,
            ShellCommand::Work(WorkCommand::Record(job)) => {
                self.records = job.is_some();
                // Jobs run one after the other, each with its own number.
                if let Some(job) = job {
                    if self
                        .recordings
                        .last()
                        .is_some_and(|last| last.number() >= job.number())
                    {
                        return Err("a recording's number comes again".to_owned());
                    }
                    self.recordings.push(*job);
                }
            }
            ShellCommand::Work(WorkCommand::Align(job)) => self.jobs.push(*job),
            ShellCommand::Work(WorkCommand::Plate(job)) => self.plates.push(*job),
            ShellCommand::Work(WorkCommand::Search(job)) => self.searches.push(*job),
            ShellCommand::Work(WorkCommand::Watch(job)) => self.watches.push(*job),
            _ => {}
        }
        Ok(())
    }

    /// Conditions that hold between two events.
    fn check(&self, app: &App) -> Result<(), String> {
        let step = app.step();
        let (effect, is_toy) = match app.show() {
            Show::Toy { input, .. } => (input.effect, true),
            _ => (0.0, false),
        };
        #[rustfmt::skip] // Each rule has a line of its own.
        let rules = [
            (self.runs && !(self.is_foreground && self.permission == Permission::Granted), "the camera runs where it may not"),
            (self.runs && step == Step::Welcome, "the camera runs before it is needed"),
            (self.runs && self.is_locked != (step >= Step::PlaceToy), "exposure is held or free at the wrong time"),
            (self.runs && self.is_dark != app.is_taking_lens(), "the camera is dark at the wrong time"),
            (self.is_awake && step == Step::Welcome, "the screen is kept on for nothing"),
            (self.makes_video && !(self.runs && step == Step::Play), "a video of nothing"),
            (self.records && !(self.runs && step == Step::Play), "a recording of nothing"),
            (self.records != app.is_recording(), "the app is wrong about its recording"),
            (app.ghost().is_some() && !matches!(step, Step::PlaceToy | Step::Align), "a ghost of nothing"),
            (is_toy && step != Step::Play, "the effect is shown before the toy was found"),
            (!(0.0..=1.0).contains(&effect), "an effect that cannot be"),
            (self.makes_video != app.is_making_video(), "the app is wrong about its video"),
        ];
        let broken = rules.into_iter().find(|(is_broken, _)| *is_broken);
        broken.map_or(Ok(()), |(_, rule)| Err(format!("{rule}, in {step:?}")))
    }
}

/// The answer that a person owes about the toy's place.
fn asked(app: &App) -> Option<Placing> {
    let placing = Some(app.placing()).filter(|_| app.step() == Step::PlaceToy);
    placing.filter(|placing| matches!(placing, Placing::Asked { is_searching: false } | Placing::ByHand))
}

/// Applies all events; the first inconsistency is an error.
fn live_through(happenings: Vec<Happening>) -> Result<(App, Platform), String> {
    let (mut app, mut platform) = (world::app(), Platform::default());
    for happening in happenings {
        for event in platform.events(happening) {
            let (step, asked) = (app.step(), asked(&app));
            let commands = app.event(event);
            let said = commands.iter().find_map(|command| match command {
                ShellCommand::Platform(PlatformCommand::Announce(step)) => Some(*step),
                _ => None,
            });
            let is_new = self::asked(&app).is_some() && self::asked(&app) != asked;
            if said != (app.step() != step || is_new).then_some(app.step()) {
                return Err(format!(
                    "from {step:?} to {:?}, but {said:?} is announced",
                    app.step()
                ));
            }
            for command in commands {
                platform.obey(command)?;
            }
            platform.check(&app)?;
        }
    }
    Ok((app, platform))
}

/// The app after all events.
pub(crate) fn happen(happenings: Vec<Happening>) -> App {
    live_through(happenings).unwrap().0
}

/// Events that lead to a moving toy.
pub(crate) fn straight() -> Vec<Happening> {
    vec![
        Happening::Foreground(true),
        Happening::Graphics(GraphicsState::Ready),
        Happening::Permission(Permission::Granted),
        Happening::User(UserAction::Begin),
        Happening::Frames(3, 33, Tracking::Normal),
        Happening::User(UserAction::Tap(DVec2::new(32.0, 24.0))),
        Happening::User(UserAction::SkipPlate),
        Happening::User(UserAction::Placed),
        Happening::Frames(2, 33, Tracking::Normal),
        Happening::AlignmentEnds(Some(0.1)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_order_of_events_asks_for_nonsense(
        is_straight in any::<bool>(),
        rest in prop::collection::vec(happening(), 1..80),
    ) {
        let mut happenings = if is_straight { straight() } else { Vec::new() };
        happenings.extend(rest);
        prop_assert_eq!(live_through(happenings).err(), None);
    }
}

#[test]
fn a_platform_that_is_asked_for_nonsense_says_so() {
    let mut platform = Platform::default();
    assert!(
        platform
            .obey(ShellCommand::Platform(PlatformCommand::PauseTracking))
            .is_err()
    );
    assert!(
        platform
            .obey(ShellCommand::Work(WorkCommand::Video(false)))
            .is_err()
    );
    platform.runs = true;
    assert_eq!(
        platform.check(&world::app()).err().as_deref(),
        Some("the camera runs where it may not, in Welcome")
    );
}

#[test]
fn an_alignment_that_died_counts_for_its_own_place_alone() {
    let (mut app, mut platform) = live_through(straight()).unwrap();
    let mut happen = |app: &mut App, happening| {
        for event in platform.events(happening) {
            for command in app.event(event) {
                platform.obey(command).unwrap();
            }
        }
        platform.jobs.len()
    };
    assert_eq!(
        happen(&mut app, Happening::Frames(40, 33, Tracking::Normal)),
        1,
        "a second later"
    );
    happen(&mut app, Happening::User(UserAction::Replace));
    happen(&mut app, Happening::User(UserAction::Placed));
    let second = Happening::Frames(2, 33, Tracking::Normal);
    assert_eq!(happen(&mut app, second), 2, "one of each place");
    let [former, present] = [0, 1].map(|index| platform.jobs[index].without_result());
    let mut n_after = |app: &mut App, done| {
        let _ = app.event(ShellEvent::Aligned(Box::new(done)));
        for event in platform.events(Happening::Frames(40, 33, Tracking::Normal)) {
            for command in app.event(event) {
                platform.obey(command).unwrap();
            }
        }
        platform.jobs.len()
    };
    assert_eq!(
        n_after(&mut app, former),
        2,
        "that of the present place still runs"
    );
    assert_eq!(n_after(&mut app, present), 3, "another one begins");
}

fn effect(app: &App) -> f64 {
    let input: Option<Box<FrameInput>> = match app.show() {
        Show::Toy { input, .. } => Some(input),
        _ => None,
    };
    input.map_or(0.0, |input| input.effect)
}

#[test]
fn the_effect_comes_and_goes_with_the_pose() {
    let (mut app, mut platform) = live_through(straight()).unwrap();
    let mut frames = |app: &mut App, n, tracking| {
        for event in platform.events(Happening::Frames(n, 33, tracking)) {
            let _ = app.event(event);
        }
        effect(app)
    };
    assert_eq!(app.step(), Step::Play);
    let coming = frames(&mut app, 4, Tracking::Normal);
    assert!(coming > 0.0 && coming < 1.0, "{coming}");
    assert!(frames(&mut app, 12, Tracking::Normal) == 1.0);
    let going = frames(&mut app, 2, Tracking::TooFast);
    assert!(going > 0.0 && going < 1.0, "{going}");
    assert!(frames(&mut app, 4, Tracking::TooFast) == 0.0);
    // After a short loss the toy is shown again without any action.
    assert!(frames(&mut app, 20, Tracking::Normal) == 1.0);
}

#[test]
fn a_recording_that_ended_late_leaves_the_next_one_alone() {
    let (mut app, mut platform) = live_through(straight()).unwrap();
    let action = |app: &mut App, platform: &mut Platform, is_on| {
        for command in app.event(ShellEvent::User(UserAction::Record(is_on))) {
            platform.obey(command).unwrap();
        }
    };
    for is_on in [true, false, true] {
        action(&mut app, &mut platform, is_on);
    }
    let mut recordings = std::mem::take(&mut platform.recordings);
    assert_eq!(recordings.len(), 2);
    let first = ShellEvent::Recorded(world::full(recordings.remove(0)));
    assert!(app.event(first).is_empty() && app.is_recording());
    let second = ShellEvent::Recorded(world::full(recordings.remove(0)));
    let names: Vec<String> = app
        .event(second)
        .iter()
        .map(|command| format!("{command:?}"))
        .collect();
    assert_eq!(names, ["Work(Record(None))"]);
    assert!(!app.is_recording());
    assert!(
        matches!(app.notice(), Some(Notice::Recorded(recorded)) if recorded.outcome.ending == Ending::NoRoom)
    );
    // With hardly any free space no recording begins.
    let _ = app.event(ShellEvent::FreeSpace(1 << 20));
    action(&mut app, &mut platform, true);
    assert!(!app.is_recording() && app.notice() == Some(&Notice::NoRoomToRecord));
}

#[test]
fn a_recording_and_a_video_are_saved_before_the_camera_goes() {
    let (mut app, _) = live_through(straight()).unwrap();
    for action in [UserAction::Video(true), UserAction::Record(true)] {
        let _ = app.event(ShellEvent::User(action));
    }
    let commands = app.event(ShellEvent::Foreground(false));
    let names: Vec<String> = commands.iter().map(|command| format!("{command:?}")).collect();
    assert_eq!(
        names,
        [
            "Work(Video(false))",
            "Work(Record(None))",
            "Platform(PauseTracking)",
            "Platform(KeepAwake(false))"
        ]
    );
}
