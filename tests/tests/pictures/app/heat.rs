//! Masks of people and depths: when they are asked for, which heat ends, and where they go.

use app_core::app::{
    App, PlatformCommand, ShellCommand, ShellEvent, Show, Step, Thermal, UserAction, WorkCommand,
};
use app_core::camera_frame::Tracking;
use app_core::depth::Depth;
use app_core::frame::FrameInput;
use app_core::people::People;

use crate::app::world;

/// Depths warm the phone and matter to alignment alone: they are measured from the step before it
/// on, and are the first thing that heat takes.
#[test]
fn depths_are_measured_from_the_plate_on_and_not_by_a_warm_phone() {
    let measures = |commands: &[ShellCommand]| {
        commands.iter().find_map(|command| match command {
            ShellCommand::Platform(PlatformCommand::RunTracking { measures_depth, .. }) => {
                Some(*measures_depth)
            }
            _ => None,
        })
    };
    let mut app = world::app();
    assert_eq!(measures(&world::begun(&mut app)), Some(false));
    let mut app = world::at_ghost();
    // It was asked for before, with the end of the search for a table.
    assert_eq!(
        measures(&app.event(ShellEvent::Thermal(Thermal::Fair))),
        Some(false)
    );
    // Each change runs the session anew: a phone at the limit does not go to and fro.
    for thermal in [
        Thermal::Serious,
        Thermal::Nominal,
        Thermal::Fair,
        Thermal::Nominal,
    ] {
        assert_eq!(measures(&app.event(ShellEvent::Thermal(thermal))), None);
    }
    let next = app.event(ShellEvent::User(UserAction::Placed));
    assert_eq!(app.step(), Step::Align);
    assert_eq!(measures(&next), Some(true), "a cool phone in the next step");
}

/// Masks of people matter to the shown picture alone, and warm the phone as depths do.
#[test]
fn people_are_masked_while_the_toy_moves_and_not_by_a_warm_phone() {
    let asked = |commands: &[ShellCommand]| {
        let runs = commands.iter().filter_map(|command| match command {
            ShellCommand::Platform(PlatformCommand::RunTracking {
                finds_people,
                measures_depth,
                ..
            }) => Some([*finds_people, *measures_depth]),
            _ => None,
        });
        runs.collect::<Vec<_>>()
    };
    let locks = |commands: &[ShellCommand]| {
        let lock = |command: &ShellCommand| {
            matches!(
                command,
                ShellCommand::Platform(PlatformCommand::LockExposure(true))
            )
        };
        commands.iter().any(lock)
    };
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::Placed));
    let third = world::frame(3, 100_000_000, 0, Tracking::Normal);
    let aligned = app
        .event(ShellEvent::Frame(Box::new(third)))
        .into_iter()
        .find_map(|command| match command {
            ShellCommand::Work(WorkCommand::Align(job)) => {
                let alignment = world::alignment(job.input(), Some(0.1));
                Some(job.known(alignment))
            }
            _ => None,
        });
    let commands = app.event(ShellEvent::Aligned(Box::new(aligned.unwrap())));
    assert_eq!(app.step(), Step::Play);
    assert_eq!(asked(&commands), [[true, true]]);
    // Plate and frames are compared, and a run may release the exposure.
    assert!(locks(&commands), "{commands:?}");
    // One run for both.
    let commands = app.event(ShellEvent::Thermal(Thermal::Fair));
    assert_eq!(asked(&commands), [[false, false]]);
    assert!(locks(&commands), "{commands:?}");
    for thermal in [Thermal::Nominal, Thermal::Fair, Thermal::Nominal] {
        assert_eq!(
            asked(&app.event(ShellEvent::Thermal(thermal))),
            [[false; 2]; 0],
            "no going to and fro"
        );
    }
}

#[test]
fn a_mask_and_depths_reach_the_picture_and_the_alignment_and_those_of_another_shape_do_not() {
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::Placed));
    let with = |id: u64, size_px: [u32; 2]| {
        let n_pixels = size_px.into_iter().product::<u32>() as usize;
        let mut frame = world::frame(id, 100_000_000 * i64::try_from(id).unwrap(), 0, Tracking::Normal);
        frame.people = People::new(size_px.into(), vec![255; n_pixels]);
        frame.depth = Depth::new(size_px.into(), vec![400; n_pixels]);
        frame
    };
    let has = |input: &FrameInput| [input.people.is_some(), input.depth.is_some()];
    let mut aligned = None;
    for command in app.event(ShellEvent::Frame(Box::new(with(3, [32, 24])))) {
        if let ShellCommand::Work(WorkCommand::Align(job)) = command {
            assert_eq!(has(job.input()), [true; 2]);
            let alignment = world::alignment(job.input(), Some(0.1));
            aligned = Some(Box::new(job.known(alignment)));
        }
    }
    let aligned = aligned.expect("an alignment was due");
    let _ = app.event(ShellEvent::Aligned(aligned));
    let shown = |app: &App| match app.show() {
        Show::Toy { input, .. } => has(&input),
        _ => panic!("{:?}", app.step()),
    };
    for (id, size_px, expected) in [
        (4, [32, 24], true),
        (5, [24, 32], false),
        (6, [64, 48], true),
        (7, [64, 64], false),
    ] {
        let _ = app.event(ShellEvent::Frame(Box::new(with(id, size_px))));
        assert_eq!(shown(&app), [expected; 2], "{size_px:?}");
    }
}
