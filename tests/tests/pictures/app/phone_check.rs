//! The questions for a new phone: their drawings are at the correct places, and the answers are
//! kept.

use app_core::app::{
    App, CheckInk, Notice, PhoneQuestion, PlatformCommand, ShellCommand, ShellEvent, Step, UserAction,
};
use app_core::camera_frame::Tracking;
use glam::{DVec2, DVec3};

use crate::app::world;

/// An app that searches for a table, at its first question, and with a frame.
fn asked() -> App {
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::StartOver));
    let _ = app.event(ShellEvent::User(UserAction::CheckPhone(true)));
    see(&mut app, 3);
    app
}

fn see(app: &mut App, id: u64) -> Vec<ShellCommand> {
    let time_ns = i64::try_from(id).unwrap() * 33_000_000;
    app.event(ShellEvent::Frame(Box::new(world::frame(
        id,
        time_ns,
        0,
        Tracking::Normal,
    ))))
}

fn answer(app: &mut App, is_yes: bool) -> Vec<ShellCommand> {
    app.event(ShellEvent::User(UserAction::Answer(is_yes)))
}

/// Position of a point of the world in the frames' camera, by the pinhole's own formula.
fn pixel(point: DVec3) -> DVec2 {
    let eye = DVec3::new(0.0, 0.4, 0.3);
    let (back, right) = (eye.normalize(), DVec3::X);
    let up = back.cross(right);
    let ray = point - eye;
    let depth = -ray.dot(back);
    DVec2::new(
        32.0 + 60.0 * ray.dot(right) / depth,
        24.0 - 60.0 * ray.dot(up) / depth,
    )
}

/// Position of arrows and ruler: the table at .35 of the picture's width and .55 of its height.
fn place() -> DVec3 {
    let eye = DVec3::new(0.0, 0.4, 0.3);
    let (back, right) = (eye.normalize(), DVec3::X);
    let (x, y) = ((0.35 * 64.0 - 32.0) / 60.0, (24.0 - 0.55 * 48.0) / 60.0);
    let ray = x * right + y * back.cross(right) - back;
    eye - eye.y / ray.y * ray
}

/// Ends of the lines with an ink, each pair in its order.
fn lines(app: &App, ink: CheckInk) -> Vec<[DVec2; 2]> {
    let lines = app.check_lines_px().into_iter();
    lines.filter(|(of, _)| *of == ink).map(|(_, ends)| ends).collect()
}

fn assert_line([from, to]: [DVec2; 2], expected: [DVec3; 2]) {
    let expected = expected.map(pixel);
    let off = from.distance(expected[0]).max(to.distance(expected[1]));
    assert!(off < 1e-9, "{from} {to}, not {expected:?}");
}

#[test]
fn arrows_stand_on_the_table() {
    let app = asked();
    assert_eq!(app.phone_question(), Some((PhoneQuestion::Axes, 1)));
    let place = place();
    for (ink, axis) in [
        (CheckInk::X, DVec3::X),
        (CheckInk::Y, DVec3::Y),
        (CheckInk::Z, DVec3::Z),
    ] {
        let arrow = lines(&app, ink);
        assert_eq!(arrow.len(), 3, "a shaft and two barbs");
        assert_line(arrow[0], [place, place + 0.1 * axis]);
        assert!(
            arrow[1..]
                .iter()
                .all(|[_, to]| to.distance(pixel(place + 0.1 * axis)) < 1e-9)
        );
    }
}

#[test]
fn lengths_are_those_of_the_world() {
    let mut app = asked();
    for _ in 0..2 {
        answer(&mut app, true);
    }
    assert_eq!(app.phone_question(), Some((PhoneQuestion::Square, 3)));
    let square = lines(&app, CheckInk::Measure);
    assert_eq!(square.len(), 4);
    // Fifteen centimetres, as the card is printed.
    assert_line(
        square[0],
        [DVec3::new(-0.075, 0.0, -0.075), DVec3::new(0.075, 0.0, -0.075)],
    );
    for _ in 0..4 {
        answer(&mut app, true);
    }
    assert_eq!(app.phone_question(), Some((PhoneQuestion::Ruler, 7)));
    let ruler = lines(&app, CheckInk::Measure);
    assert_eq!(ruler.len(), 12, "a line and eleven marks");
    assert_line(
        ruler[0],
        [
            place() + DVec3::new(-0.05, 0.0, 0.0),
            place() + DVec3::new(0.05, 0.0, 0.0),
        ],
    );
    assert_line(
        ruler[4],
        [
            place() + DVec3::new(-0.02, 0.0, -0.002),
            place() + DVec3::new(-0.02, 0.0, 0.002),
        ],
    );
}

#[test]
fn nothing_is_drawn_without_a_pose_or_a_table() {
    let mut app = world::at_ghost();
    let _ = app.event(ShellEvent::User(UserAction::StartOver));
    let _ = app.event(ShellEvent::User(UserAction::CheckPhone(true)));
    let mut bare = world::frame(3, 99_000_000, 0, Tracking::Normal);
    (bare.planes, bare.world_from_card) = (std::sync::Arc::new([]), None);
    let _ = app.event(ShellEvent::Frame(Box::new(bare)));
    assert_eq!(app.check_lines_px(), []);
    see(&mut app, 4);
    assert_eq!(app.check_lines_px().len(), 9);
    let lost = world::frame(5, 165_000_000, 0, Tracking::Relocalising);
    let _ = app.event(ShellEvent::Frame(Box::new(lost)));
    assert_eq!(app.check_lines_px(), []);
}

#[test]
fn answers_are_kept_and_touches_of_the_picture_mean_nothing_meanwhile() {
    let mut app = asked();
    let _ = app.event(ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))));
    assert_eq!(app.step(), Step::FindTable);
    let mut locks = Vec::new();
    for question in PhoneQuestion::ALL {
        assert_eq!(app.phone_question().map(|(asked, _)| asked), Some(question));
        for command in answer(&mut app, question != PhoneQuestion::Delay) {
            if let ShellCommand::Platform(PlatformCommand::LockExposure(is_held)) = command {
                locks.push((question, is_held));
            }
        }
    }
    // Held for the question after «Delay», and released after it.
    assert_eq!(
        locks,
        [(PhoneQuestion::Delay, true), (PhoneQuestion::Held, false)]
    );
    assert_eq!(app.phone_question(), None);
    assert_eq!(app.notice(), Some(&Notice::PhoneChecked { n_yes: 9 }));
    let log = app.log().text();
    assert!(
        log.contains("(Delay, false)") && log.contains("(Axes, true)"),
        "{log}"
    );
    assert!(answer(&mut app, true).is_empty(), "nothing is asked any more");
    let _ = app.event(ShellEvent::User(UserAction::Tap(DVec2::new(32.0, 24.0))));
    assert_eq!(app.step(), Step::TakePlate);
}
