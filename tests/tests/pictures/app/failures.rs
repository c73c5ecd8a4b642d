//! Pictures, threads and videos that fail: nothing is lost, and nothing is repeated for ever.

use app_core::app::{
    AlignJob, App, Filmed, GraphicsState, Notice, PlatformCommand, Saved, ShellCommand, ShellEvent, Show,
    Step, UserAction, Verdict, VideoEnding, WorkCommand,
};
use app_core::camera_frame::Tracking;
use app_core::interface::{Screen, Touch, TouchPhase};
use app_core::live::Live;
use app_core::preset::Preset;
use app_core::wgpu;
use glam::DVec2;

use super::happenings::Happening;
use super::orders::{happen, straight};
use crate::app::world;

const SCREEN: Screen = world::screen(160, 120);

/// A target on which the device cannot draw.
fn no_target(live: &Live) -> wgpu::Texture {
    let device = live.core().device().expect("a device");
    device.raw().create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: 160,
            height: 120,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

#[test]
fn commands_of_a_picture_that_fails_come_with_the_next_call() {
    let mut live = Live::new(harness::open_core(), world::toy(), Preset::Flat);
    for event in world::opening() {
        let _ = live.event(event);
    }
    deliver(&mut live, 1, 60.0);
    let screen = world::screen(800, 600);
    for _ in 0..2 {
        live.screenshot(&screen, 0.0).unwrap();
    }
    let here = live.widgets().iter().find(|widget| widget.label == "Here");
    let [left, top, right, bottom] = here.expect("a button").bounds_px;
    let touch = |phase| Touch {
        id: 1,
        phase,
        at_px: [0.5 * (left + right), 0.5 * (top + bottom)],
    };
    let (began, ended) = (touch(TouchPhase::Began), touch(TouchPhase::Ended));
    live.touch(began);
    live.screenshot(&screen, 0.1).unwrap();
    live.touch(ended);
    let target = no_target(&live);
    assert!(live.draw_on(&target, &screen, 0.2).is_err());
    assert_eq!(live.app().step(), Step::TakePlate, "the touch counts");
    let (_, commands) = live.screenshot(&screen, 0.3).unwrap();
    let runs = |command: &ShellCommand| {
        matches!(
            command,
            ShellCommand::Platform(PlatformCommand::RunTracking { .. })
        )
    };
    assert!(commands.iter().any(runs), "{commands:?}");
    let (_, commands) = live.screenshot(&screen, 0.4).unwrap();
    assert!(commands.is_empty(), "once: {commands:?}");
}

fn tell(live: &mut Live, event: ShellEvent) {
    for command in live.event(event) {
        if let ShellCommand::Work(WorkCommand::Align(job)) = command {
            let alignment = world::alignment(job.input(), Some(0.1));
            tell(live, ShellEvent::Aligned(Box::new(job.known(alignment))));
        }
    }
}

/// Delivers a frame; `fx_px` is the camera's focal length.
fn deliver(live: &mut Live, id: u64, fx_px: f64) {
    let time_ns = i64::try_from(id).unwrap() * 33_000_000;
    let mut frame = world::frame(id, time_ns, 0, Tracking::Normal);
    frame.intrinsics.fx_px = fx_px;
    tell(live, ShellEvent::Frame(Box::new(frame)));
}

#[test]
fn a_toy_whose_pictures_fail_is_given_up_on_the_same_device() {
    let mut live = Live::new(harness::open_core(), world::toy(), Preset::Flat);
    for event in world::opening() {
        tell(&mut live, event);
    }
    deliver(&mut live, 1, 60.0);
    for action in [
        UserAction::Tap(DVec2::new(32.0, 24.0)),
        UserAction::SkipPlate,
        UserAction::Placed,
    ] {
        tell(&mut live, ShellEvent::User(action));
    }
    for id in 2..12 {
        deliver(&mut live, id, 60.0);
    }
    assert!(matches!(live.app().show(), Show::Toy { .. }));
    live.screenshot(&SCREEN, 0.0).unwrap();
    // One frame that makes no sense changes nothing.
    deliver(&mut live, 12, 0.0);
    live.screenshot(&SCREEN, 0.1).expect("the camera's picture");
    deliver(&mut live, 13, 60.0);
    live.screenshot(&SCREEN, 0.2).unwrap();
    assert_eq!((live.app().step(), live.app().notice()), (Step::Play, None));
    for id in 14..17 {
        deliver(&mut live, id, 0.0);
        live.screenshot(&SCREEN, 0.1 * id as f64)
            .expect("the camera's picture");
    }
    assert_eq!(live.app().step(), Step::PlaceToy);
    assert_eq!(live.app().notice(), Some(&Notice::PictureFailed));
    assert!(
        live.app().log().text().contains("fx_px"),
        "the log has the reason"
    );
}

#[test]
fn a_device_that_is_lost_with_the_toy_again_and_again_is_not_opened_for_ever() {
    let mut app = happen(straight());
    let lose = |app: &mut App| {
        let _ = app.event(ShellEvent::Graphics(GraphicsState::Lost));
        let _ = app.event(ShellEvent::Graphics(GraphicsState::Ready));
    };
    lose(&mut app);
    assert_eq!(
        (app.step(), app.notice()),
        (Step::Play, Some(&Notice::DeviceRestarted))
    );
    lose(&mut app);
    assert_eq!(
        (app.step(), app.notice()),
        (Step::PlaceToy, Some(&Notice::PictureFailed))
    );
}

#[test]
fn a_video_that_ends_by_itself_ends_for_the_app() {
    let filmed = |saved, ending| {
        let mut app = happen(straight());
        let _ = app.event(ShellEvent::User(UserAction::Video(true)));
        let _ = app.event(ShellEvent::Saved(Saved::Failed));
        assert!(app.is_making_video(), "a photo is no video");
        let commands = app.event(ShellEvent::Filmed(Filmed { saved, ending }));
        let ends = |command: &ShellCommand| matches!(command, ShellCommand::Work(WorkCommand::Video(false)));
        assert_eq!(commands.iter().any(ends), !app.is_making_video());
        (app.is_making_video(), app.notice().cloned())
    };
    assert_eq!(
        filmed(Saved::Done, VideoEnding::TooLarge),
        (false, Some(Notice::VideoTooLarge))
    );
    assert_eq!(
        filmed(Saved::NoRoom, VideoEnding::Broken),
        (false, Some(Notice::Saved(Saved::NoRoom)))
    );
    // This is the end of an earlier one, which the person has ended.
    assert_eq!(
        filmed(Saved::Done, VideoEnding::Asked),
        (true, Some(Notice::Saved(Saved::Done)))
    );
}

/// The alignments that an app wants for a frame.
fn jobs(app: &mut App, id: u64) -> Vec<AlignJob> {
    let time_ns = i64::try_from(id).unwrap() * 33_000_000;
    let frame = world::frame(id, time_ns, 0, Tracking::Normal);
    let commands = app.event(ShellEvent::Frame(Box::new(frame)));
    let jobs = commands.into_iter().filter_map(|command| match command {
        ShellCommand::Work(WorkCommand::Align(job)) => Some(*job),
        _ => None,
    });
    jobs.collect()
}

#[test]
fn alignments_that_die_one_after_the_other_are_one_that_failed() {
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::Placed));
    for (id, step) in [(3, Step::Align), (4, Step::PlaceToy)] {
        let died = jobs(&mut app, id)[0].without_result();
        let _ = app.event(ShellEvent::Aligned(Box::new(died)));
        assert_eq!(app.step(), step);
    }
    let notice = app.notice();
    assert!(
        matches!(notice, Some(Notice::ToyMissed(Verdict::Failed(_)))),
        "{notice:?}"
    );
}

#[test]
fn a_toy_of_which_too_little_is_seen_is_not_called_misplaced() {
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::Placed));
    let job = jobs(&mut app, 3).remove(0);
    let alignment = world::alignment(job.input(), None);
    let _ = app.event(ShellEvent::Aligned(Box::new(job.known(alignment))));
    let notice = app.notice();
    assert!(
        matches!(
            notice,
            Some(Notice::ToyMissed(Verdict::Found { outline_px: None, .. }))
        ),
        "{notice:?}"
    );
}

#[test]
fn plates_that_die_one_after_the_other_are_given_up() {
    let mut app = world::app();
    let _ = world::begun(&mut app);
    let frame = world::frame(1, 0, 0, Tracking::Normal);
    let _ = app.event(ShellEvent::Frame(Box::new(frame)));
    let _ = app.event(ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))));
    for step in [Step::TakePlate, Step::PlaceToy] {
        let _ = app.event(ShellEvent::Plated(None));
        assert_eq!(app.step(), step);
    }
    assert_eq!(app.notice(), Some(&Notice::NoPlate));
}

#[test]
fn a_touch_on_the_picture_counts_only_while_its_camera_is_known() {
    let mut app = world::app();
    let _ = world::begun(&mut app);
    let tapped = |app: &mut App, id: u64, tracking| {
        let time_ns = i64::try_from(id).unwrap() * 33_000_000;
        let mut frame = world::frame(id, time_ns, 0, Tracking::Normal);
        frame.tracking = tracking;
        let _ = app.event(ShellEvent::Frame(Box::new(frame)));
        let _ = app.event(ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))));
        app.step()
    };
    let _ = app.event(ShellEvent::Frame(Box::new(world::frame(
        1,
        0,
        0,
        Tracking::Normal,
    ))));
    assert_eq!(tapped(&mut app, 2, Tracking::TooFast), Step::FindTable);
    assert_eq!(tapped(&mut app, 3, Tracking::Normal), Step::TakePlate);
}

/// A window whose pictures take longer than the longest gap has no other frames.
#[test]
fn time_goes_on_if_every_frame_comes_after_a_gap() {
    let mut happenings = straight();
    happenings.push(Happening::Frames(3, 300, Tracking::Normal));
    let app = happen(happenings);
    let Show::Toy { input, .. } = app.show() else {
        panic!("{:?}", app.step());
    };
    assert!(input.effect == 1.0, "{}", input.effect);
    assert!(app.playback().time_s() > 0.5, "{}", app.playback().time_s());
}
