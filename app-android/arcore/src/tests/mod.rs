//! The life cycle of the session, with the fake.

mod frames;
mod nasty;

use std::time::Duration;

use app_core::app::{ArSession, Permission, ShellEvent};
use app_core::camera_frame::CameraFrame;
use glam::{DMat4, DVec3};

use super::fake::{FUNCTIONS, alive, world};
use super::ffi::{Functions, SIGNATURES};
use super::frame::FrameError;
use super::modes::{CameraMode, order_of};
use super::status::{Failure, Remedy, STATUSES, event_of};
use super::tracker::{Geometry, Run, Step, Tracker, Wait};
use crate::java::{Java, JavaHost};

/// A provider of two pointers that are never dereferenced.
struct Desk;

impl JavaHost for Desk {
    fn java(&mut self) -> Java {
        let somewhere = std::ptr::without_provenance_mut(8);
        Java {
            env: somewhere,
            activity: somewhere,
        }
    }
}

const LOOK: Run = Run {
    finds_planes: true,
    finds_card: false,
    is_new_world: false,
};
const FOLLOW: Run = Run {
    finds_planes: false,
    finds_card: false,
    is_new_world: false,
};
const ANEW: Run = Run {
    finds_planes: true,
    finds_card: false,
    is_new_world: true,
};

fn tracker() -> Tracker {
    Tracker::new(FUNCTIONS)
}

fn look(tracker: &mut Tracker) -> Step {
    tracker.run(&mut Desk, LOOK)
}

/// Updates at a time at which nothing is late.
fn update(tracker: &mut Tracker) -> Result<Option<CameraFrame>, FrameError> {
    tracker.update(Duration::ZERO)
}

fn running() -> Tracker {
    let mut tracker = tracker();
    assert_eq!(look(&mut tracker), Step::Ready);
    tracker
}

/// Nothing is left, and nothing was released twice or used after its release.
fn assert_clean() {
    assert_eq!(alive(), Vec::<&str>::new());
    assert_eq!(world(|world| world.wrong.clone()), Vec::<String>::new());
}

fn calls() -> String {
    world(|world| std::mem::take(&mut world.calls))
        .trim_end()
        .to_owned()
}

#[test]
fn a_session_begins_pauses_resumes_and_ends() {
    let mut tracker = tracker();
    let size_px = [2400, 1080];
    tracker.set_display(Geometry {
        quarter_turns: 1,
        size_px,
    });
    assert_eq!(look(&mut tracker), Step::Ready);
    assert_eq!(
        calls(),
        "availability create facing=0 fps=1 depth=2 mode=2 update=1 planes=1 texture=1 light=0 focus=1 configure display=1,2400,1080 resume"
    );
    assert_eq!(look(&mut tracker), Step::Ready, "twice");
    tracker.pause();
    tracker.pause();
    assert!(update(&mut tracker).expect("no frame").is_none());
    assert_eq!(look(&mut tracker), Step::Ready);
    tracker.set_display(Geometry {
        quarter_turns: 3,
        size_px,
    });
    tracker.set_display(Geometry {
        quarter_turns: 3,
        size_px,
    });
    assert_eq!(calls(), "pause resume display=3,2400,1080");
    drop(tracker);
    assert_clean();
}

#[test]
fn arcore_is_installed_on_the_way() {
    world(|world| {
        world.availability = vec![1, 201];
        world.install = (0, 1);
    });
    let mut tracker = tracker();
    assert_eq!(look(&mut tracker), Step::Waiting(Wait::Answer));
    assert_eq!(look(&mut tracker), Step::Waiting(Wait::Install));
    assert_eq!(calls(), "availability availability install=1");
    tracker.pause();
    world(|world| world.install = (-105, 0));
    assert_eq!(look(&mut tracker), Step::Refused(Failure(-105)), "declined");
    assert_eq!(calls(), "availability install=0");
    world(|world| world.install = (0, 0));
    assert_eq!(tracker.run(&mut Desk, ANEW), Step::Ready);
    assert!(
        calls().starts_with("availability install=1 create"),
        "starting over asks again"
    );
    drop(tracker);
    assert_clean();
}

#[test]
fn a_phone_that_cannot_is_told_so_and_asked_for_nothing() {
    world(|world| world.availability = vec![100]);
    let mut tracker = tracker();
    let step = look(&mut tracker);
    assert_eq!(calls(), "availability");
    let Step::Refused(failure) = step else {
        panic!("{step:?}");
    };
    assert_eq!(failure.remedy(), Remedy::None);
    let message = failure.to_string();
    assert!(message.starts_with("This phone cannot run ARCore."), "{message}");
    drop(tracker);
}

#[test]
fn whatever_step_of_a_beginning_fails_leaves_nothing_and_may_be_tried_again() {
    for (step, status) in [
        ("create", -104),
        ("mode", -1),
        ("configure", -15),
        ("resume", -13),
    ] {
        world(|world| world.fails.insert(step, status));
        let mut tracker = tracker();
        assert_eq!(look(&mut tracker), Step::Refused(Failure(status)), "{step}");
        world(|world| world.fails.clear());
        assert_eq!(look(&mut tracker), Step::Ready, "{step}");
        drop(tracker);
        assert_clean();
    }
}

#[test]
fn after_a_fatal_failure_a_new_session_begins() {
    let mut tracker = running();
    world(|world| world.fails.insert("update", -2));
    assert!(matches!(
        update(&mut tracker),
        Err(FrameError::Failed(Failure(-2)))
    ));
    assert_clean();
    world(|world| world.fails.clear());
    calls();
    assert_eq!(look(&mut tracker), Step::Ready);
    assert!(calls().starts_with("availability create"));
    drop(tracker);
    assert_clean();
}

#[test]
fn a_session_that_cannot_be_paused_is_given_up() {
    let mut tracker = running();
    world(|world| world.fails.insert("pause", -2));
    tracker.pause();
    assert_clean();
}

#[test]
fn the_camera_is_set_to_the_largest_picture_that_is_not_too_large_and_then_to_smaller_ones() {
    let mode = |width, height, hz| CameraMode {
        size_px: [width, height],
        hz,
        faces_away: true,
    };
    assert_eq!(order_of(&[], None), [0; 0]);
    let mut modes = vec![
        mode(640, 480, 30),
        mode(1920, 1080, 60),
        mode(1920, 1080, 30),
        mode(2560, 1440, 30),
        mode(1280, 720, 30),
    ];
    assert_eq!(order_of(&modes, None), [2, 4, 0, 3]);
    assert_eq!(order_of(&modes, Some([1280, 720])), [4, 0]);
    assert_eq!(
        order_of(&modes, Some([1, 1])),
        [2, 4, 0, 3],
        "a limit that leaves none is none"
    );
    modes[2].faces_away = false;
    assert_eq!(
        order_of(&modes, None),
        [1, 4, 0, 3],
        "among equals never the one that faces the person"
    );
    assert_eq!(
        order_of(&[mode(4000, 3000, 30), mode(2560, 1440, 30)], None),
        [1, 0]
    );
}

#[test]
fn every_status_has_a_message_of_its_own() {
    for (index, (number, name, message, _)) in STATUSES.iter().enumerate() {
        let [english, german] = message;
        for text in message {
            assert!(text.ends_with('.') && text.len() > 15, "{name}");
        }
        assert!(english != german, "{name}");
        assert!(Failure(*number).to_string().starts_with(english));
        for (other, other_name, other_message, _) in &STATUSES[..index] {
            assert!(
                number != other && name != other_name && message != other_message,
                "{name}"
            );
        }
    }
    let unknown = Failure(-77);
    assert!(unknown.to_string().contains("-77"));
    assert_eq!(unknown.remedy(), Remedy::Report);
}

#[test]
fn a_library_that_lacks_a_function_is_named() {
    let missing = SIGNATURES[SIGNATURES.len() / 2].name;
    let look_up = |without: &str| {
        // SAFETY: the functions are looked up and never called.
        unsafe {
            Functions::look_up(|name| {
                let is_there = name.to_bytes() != without.as_bytes();
                std::ptr::without_provenance(usize::from(is_there) * 16)
            })
        }
    };
    assert_eq!(look_up(missing).err().map(|error| error.name), Some(missing));
    assert!(look_up("").is_ok());
}

#[test]
fn planes_are_looked_for_only_while_asked_and_another_world_is_another_session() {
    let mut tracker = running();
    calls();
    assert_eq!(tracker.run(&mut Desk, FOLLOW), Step::Ready);
    assert_eq!(
        calls(),
        "update=1 planes=0 texture=1 light=0 focus=1 configure",
        "while it runs"
    );
    assert_eq!(tracker.run(&mut Desk, FOLLOW), Step::Ready);
    assert_eq!(calls(), "", "nothing new");
    let epoch = |tracker: &mut Tracker| {
        world(|world| world.time_ns += 1);
        let frame = update(tracker).expect("no error").expect("a frame");
        frame.stamp.world_epoch
    };
    assert_eq!(epoch(&mut tracker), 1);
    assert_eq!(tracker.run(&mut Desk, ANEW), Step::Ready);
    assert!(calls().starts_with("update pause availability create"));
    assert_eq!(epoch(&mut tracker), 2);
    drop(tracker);
    assert_clean();
}

#[test]
fn one_place_is_held_at_a_time() {
    let mut tracker = running();
    let held = |tracker: &mut Tracker, id, at: DVec3| {
        let _ = tracker.hold(id, &DMat4::from_translation(at));
        world(|world| world.time_ns += 1);
        let frame = update(tracker).expect("no error").expect("a frame");
        let anchors = frame.anchors.iter();
        anchors
            .map(|anchor| (anchor.id, anchor.world_from_anchor.transform_point3(DVec3::ZERO)))
            .collect::<Vec<_>>()
    };
    assert_eq!(held(&mut tracker, 7, DVec3::X), [(7, DVec3::X)]);
    calls();
    assert_eq!(held(&mut tracker, 8, DVec3::Z), [(8, DVec3::Z)]);
    assert_eq!(calls(), "detach anchor update");
    world(|world| world.anchor_state = 1);
    assert_eq!(held(&mut tracker, 9, DVec3::Z), [], "not tracked");
    world(|world| {
        world.anchor_state = 0;
        world.fails.insert("anchor", -5);
    });
    assert_eq!(held(&mut tracker, 10, DVec3::Z), [], "refused");
    drop(tracker);
    assert_clean();
}

#[test]
fn what_ends_tracking_is_told_by_what_helps() {
    for (number, expected, words) in [
        (-13, ArSession::Interrupted, "Another app uses the camera."),
        (
            -101,
            ArSession::Unsupported,
            "This phone cannot run ARCore. Another phone is needed.",
        ),
        (-104, ArSession::Unsupported, "Update this app."),
        (
            -105,
            ArSession::Failed,
            "Without Google Play Services for AR the app cannot see the table. Install",
        ),
        (-2, ArSession::Failed, "ARCore failed and cannot go on."),
    ] {
        let ShellEvent::ArTrouble(told, said) = event_of(Failure(number)) else {
            panic!("{number}");
        };
        assert_eq!(told, expected, "{number}");
        let [english, german] = &said.0;
        assert!(english.contains(words), "{english}");
        assert!(german != english && german.ends_with('.'), "{german}");
    }
    let denied = event_of(Failure(-9));
    assert!(
        matches!(denied, ShellEvent::Permission(Permission::Denied)),
        "{denied:?}"
    );
}
