//! Another toy: one from the list of available toys, and one that the platform recognises.

use std::sync::Arc;

use app_core::app::{Placing, ShellCommand, ShellEvent, Step, UserAction, WorkCommand};
use app_core::camera_frame::{Anchor, Tracking};
use app_core::interface::{Interface, Screen};
use glam::{DMat4, DVec2, DVec3};

use crate::app::world;

const SCREEN: Screen = world::screen(844, 390);

fn labels(app: &app_core::app::App) -> Vec<String> {
    let mut interface = Interface::default();
    for _ in 0..3 {
        interface.actions(app, &SCREEN);
    }
    interface
        .widgets()
        .iter()
        .map(|widget| widget.label.clone())
        .collect()
}

#[test]
fn a_toy_is_chosen_from_the_files_that_there_are() {
    let mut app = world::at_ghost();
    assert!(labels(&app).contains(&"Another toy".to_owned()));
    let asked = app.event(ShellEvent::User(UserAction::PickToy));
    assert!(
        matches!(asked[..], [ShellCommand::Work(WorkCommand::PickToy)]),
        "{asked:?}"
    );
    let files = || ShellEvent::ToyFiles(vec!["Llama".to_owned(), "fox.glb".to_owned()]);
    let _ = app.event(files());
    let listed = labels(&app);
    for label in ["Llama", "fox.glb", "Back"] {
        assert!(listed.contains(&label.to_owned()), "{listed:?}");
    }
    let read = app.event(ShellEvent::User(UserAction::ChooseToy(Some(1))));
    assert!(
        matches!(&read[..], [ShellCommand::Work(WorkCommand::ReadToy(name))] if name == "fox.glb"),
        "{read:?}"
    );
    assert_eq!(app.toy_files(), None);
    let _ = app.event(files());
    for action in [UserAction::ChooseToy(Some(2)), UserAction::ChooseToy(None)] {
        assert!(app.event(ShellEvent::User(action)).is_empty());
        assert_eq!(app.toy_files(), None);
    }
    // The ghost is that of the other toy, at the next tap.
    let _ = app.event(ShellEvent::Toy(Ok(world::toy())));
    assert_eq!(app.step(), Step::PlaceToy);
    assert!(app.ghost().is_none());
    let _ = app.event(ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))));
    assert!(app.ghost().is_some());
}

#[test]
fn a_toy_that_the_platform_recognises_is_asked_about_where_it_stands() {
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::ByHand));
    let mut see = |id: u64, x_m: f64| {
        let time_ns = i64::try_from(id).unwrap() * 33_000_000;
        let mut frame = world::frame(id, time_ns, 0, Tracking::Normal);
        frame.anchors = Arc::new([Anchor {
            id: Anchor::OF_TOY,
            world_from_anchor: DMat4::from_translation(DVec3::new(x_m, 0.0, 0.0)),
        }]);
        let _ = app.event(ShellEvent::Frame(Box::new(frame)));
        let placing = app.placing();
        let _ = app.event(ShellEvent::User(UserAction::ByHand));
        let (ring, _) = app.ring_px().unwrap();
        (placing, ring.iter().sum::<DVec2>() / ring.len() as f64)
    };
    let (placing, at) = see(3, 0.05);
    assert_eq!(placing, Placing::Asked { is_searching: true });
    // The frames' camera looks at the origin from .5 m, with 60 pixels a unit of slope.
    assert!((at.x - (32.0 + 60.0 * 0.05 / 0.5)).abs() < 1.0, "{at}");
    let (placing, _) = see(4, 0.051);
    assert_eq!(placing, Placing::ByHand, "it stands where it stood");
    let (placing, moved) = see(5, 0.1);
    assert_eq!(placing, Placing::Asked { is_searching: true });
    assert!(moved.x > at.x + 3.0, "{at} {moved}");
}
