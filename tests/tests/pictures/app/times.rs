//! Times of the camera in an app's own profile.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use app_core::app::{ShellCommand, ShellEvent, Step, UserAction, WorkCommand};
use app_core::camera_frame::Tracking;
use app_core::frame::Clock;
use app_core::interface::Screen;
use app_core::live::Live;
use app_core::preset::Preset;
use app_core::profile::{FRAME, PROCESSOR};
use glam::DVec2;

use crate::app::world;

const SCREEN: Screen = world::screen(160, 120);

fn tell(live: &mut Live, event: ShellEvent) {
    for command in live.event(event) {
        if let ShellCommand::Work(WorkCommand::Align(job)) = command {
            let alignment = world::alignment(job.input(), Some(0.1));
            tell(live, ShellEvent::Aligned(Box::new(job.known(alignment))));
        }
    }
}

/// Delivers a camera frame of this age.
fn deliver(live: &mut Live, id: u64, age_ms: Option<f64>) {
    let time_ns = i64::try_from(id).unwrap() * 33_000_000;
    let mut frame = world::frame(id, time_ns, 0, Tracking::Normal);
    frame.age_ms = age_ms;
    tell(live, ShellEvent::Frame(Box::new(frame)));
}

/// An app whose toy moves, and its clock, in milliseconds.
fn playing() -> (Live, Arc<AtomicU64>) {
    let mut live = Live::new(harness::open_core(), world::toy(), Preset::Flat);
    let now_ms = Arc::new(AtomicU64::new(0));
    let clock = Arc::clone(&now_ms);
    live.set_clock(Clock::new(move || clock.load(Ordering::SeqCst) as f64));
    world::opening()
        .into_iter()
        .for_each(|event| tell(&mut live, event));
    place(&mut live, 1);
    (live, now_ms)
}

/// Makes three frames find the toy; `id` is the number of the first one.
fn place(live: &mut Live, id: u64) {
    deliver(live, id, None);
    tell(live, ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))));
    tell(live, ShellEvent::User(UserAction::SkipPlate));
    tell(live, ShellEvent::User(UserAction::Placed));
    deliver(live, id + 1, None);
    deliver(live, id + 2, None);
    assert_eq!(live.app().step(), Step::Play);
}

#[test]
fn a_frame_tells_how_old_its_picture_is_and_how_many_nobody_saw() {
    let (mut live, now_ms) = playing();
    let draw = |live: &mut Live, at_ms: u64| {
        now_ms.store(at_ms, Ordering::SeqCst);
        live.screenshot(&SCREEN, 0.0).unwrap();
        let frames = live.times().unwrap().scopes(PROCESSOR);
        let args = &frames.filter(|event| event.name == FRAME).last().unwrap().args;
        (args.camera_to_present_ms, args.dropped)
    };
    assert_eq!(draw(&mut live, 100), (None, Some(0)), "a camera without a clock");
    deliver(&mut live, 4, Some(40.0));
    assert_eq!(draw(&mut live, 105), (Some(45.0), Some(0)));
    assert_eq!(draw(&mut live, 120), (Some(60.0), Some(0)), "the same picture");
    deliver(&mut live, 5, Some(40.0));
    deliver(&mut live, 7, Some(30.0));
    assert_eq!(draw(&mut live, 121), (Some(31.0), Some(2)), "neither 5 nor 6");
    tell(&mut live, ShellEvent::User(UserAction::StartOver));
    deliver(&mut live, 8, Some(40.0));
    live.screenshot(&SCREEN, 0.0).unwrap();
    place(&mut live, 40);
    assert_eq!(
        draw(&mut live, 130).1,
        Some(0),
        "while the toy did not move nothing was kept from it"
    );
}
