//! Another toy: the list of those that there are, one of which is read.

use app_core::app::{ShellCommand, ShellEvent, Step, UserAction, WorkCommand};
use app_core::interface::{Interface, Screen};
use glam::DVec2;

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
    // The ghost is the other toy's, where the person taps next.
    let _ = app.event(ShellEvent::Toy(Ok(world::toy())));
    assert_eq!(app.step(), Step::PlaceToy);
    assert!(app.ghost().is_none());
    let _ = app.event(ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))));
    assert!(app.ghost().is_some());
}
