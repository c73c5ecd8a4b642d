//! The card on the table: it defines the table, and the lens on it shows the lights.

use std::path::Path;
use std::sync::{Arc, LazyLock};

use app_core::app::{
    App, LensFailure, Notice, PlatformCommand, ShellCommand, ShellEvent, Step, UserAction, WorkCommand,
};
use app_core::camera_frame::CameraFrame;
use app_core::card::{card_from_lens, lens_shape};
use app_core::scene::Probe;
use app_core::session::Capture;
use desk::files::Folder;
use glam::{DMat4, DVec2, DVec3};
use measure::photographer::world::{camera, toward};
use measure::photographer::{Exposure, Lamp, Mirror, Quality, Shot, World, folder};
use view::feed::Feed;

use crate::app::world;

const SIZE_PX: [u32; 2] = [512, 288];
/// The lens's place, beside the toy.
const LENS: DVec3 = DVec3::new(-0.14, 0.0, 0.06);
/// A pixel of the frame that shows the table beside the toy.
const BESIDE_TOY_PX: DVec2 = DVec2::new(150.0, 200.0);

fn lamp() -> DVec3 {
    toward(50.0, 30.0)
}

/// A session with a picture of a lens on the card, under a sun; or without any lamp.
fn session(name: &str, is_lit: bool) -> Arc<Capture> {
    let lamps = if is_lit {
        vec![Lamp::sun(lamp(), 0.01, 1.0)]
    } else {
        Vec::new()
    };
    let mut world = World::boxes().resized(SIZE_PX).lit_by(lamps);
    world.quality = Quality {
        n_across: 1,
        n_light_rays: 8,
        n_sky_rays: 8,
    };
    let mut shot = Shot::of(&world).unwrap();
    let lens = Mirror {
        shape: lens_shape(),
        ..Mirror::lens(DMat4::from_translation(LENS))
    };
    let eye = DVec3::new(-0.3, 0.3, 0.2);
    let lights = (&world.lamps[..], world.sky);
    let picture = lens.photograph(
        lights,
        (&camera(SIZE_PX, eye, LENS), SIZE_PX),
        &Exposure::default(),
    );
    shot.scene.probe = Some(Probe {
        pictures: vec![picture],
        shape: lens.shape,
    });
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    folder::write(&path, &shot).unwrap();
    Arc::new(Capture::open(Folder::open(&path).unwrap()).unwrap())
}

static LIT: LazyLock<Arc<Capture>> = LazyLock::new(|| session("lens-lit", true));

/// A person with a phone.
struct Person {
    app: App,
    feed: Feed,
    commands: Vec<String>,
    /// Whether the camera follows the command.
    can_darken: bool,
}

impl Person {
    /// The step of the ghost, without a plate.
    fn at_ghost(session: &Arc<Capture>) -> Self {
        let session = Arc::clone(session);
        let feed = Feed::of(session).unwrap();
        let mut person = Self {
            app: App::new(Arc::clone(&feed.scene().toy)),
            feed,
            commands: Vec::new(),
            can_darken: true,
        };
        person.feed.hides_planes = true;
        world::opening().into_iter().for_each(|event| person.tell(event));
        person.frames(2);
        person.tell(ShellEvent::User(UserAction::Tap(BESIDE_TOY_PX)));
        person.tell(ShellEvent::User(UserAction::SkipPlate));
        person.feed.is_toy_there = true;
        person.frames(1);
        person.commands.clear();
        person
    }

    fn tell(&mut self, event: ShellEvent) {
        for command in self.app.event(event) {
            match command {
                ShellCommand::Platform(PlatformCommand::Underexpose(is_on)) => {
                    self.commands.push(format!("{command:?}"));
                    self.feed.is_dark = is_on && self.can_darken;
                }
                ShellCommand::Work(WorkCommand::Plate(job)) => {
                    self.tell(ShellEvent::Plated(Some(Box::new(job.run()))));
                }
                _ => {}
            }
        }
    }

    fn frame(&mut self) -> CameraFrame {
        self.feed.next(0.033)
    }

    fn frames(&mut self, n: usize) {
        for _ in 0..n {
            let frame = self.frame();
            self.tell(ShellEvent::Frame(Box::new(frame)));
        }
    }

    fn take_lens(&mut self) {
        self.tell(ShellEvent::User(UserAction::TakeLens));
        assert!(self.app.is_taking_lens());
    }
}

#[test]
fn the_card_is_the_table_where_no_plane_is_found() {
    let mut person = Person::at_ghost(&LIT);
    assert_eq!(person.app.step(), Step::PlaceToy);
    assert!(person.app.sees_card());
    // Without the card there is no table to tap on.
    person.tell(ShellEvent::User(UserAction::StartOver));
    let mut frame = person.frame();
    frame.world_from_card = None;
    person.tell(ShellEvent::Frame(Box::new(frame)));
    person.tell(ShellEvent::User(UserAction::Tap(BESIDE_TOY_PX)));
    assert_eq!(person.app.step(), Step::FindTable);
    assert_eq!(person.app.notice(), Some(&Notice::NoTableThere));
}

#[test]
fn a_dark_picture_of_the_lens_tells_the_light_and_the_camera_is_given_back() {
    let mut person = Person::at_ghost(&LIT);
    person.take_lens();
    // No toy is placed meanwhile: the picture is too dark to align it.
    person.tell(ShellEvent::User(UserAction::Placed));
    assert_eq!(person.app.step(), Step::PlaceToy);
    person.frames(1);
    assert_eq!(person.app.notice(), Some(&Notice::LensTaken(1)));
    assert_eq!(
        person.commands,
        ["Platform(Underexpose(true))", "Platform(Underexpose(false))"]
    );
    person.frames(1);
    let mut jobs = Vec::new();
    for event in [
        ShellEvent::User(UserAction::Placed),
        ShellEvent::Frame(Box::new(person.frame())),
    ] {
        let commands = person.app.event(event);
        jobs.extend(commands.into_iter().filter_map(|command| match command {
            ShellCommand::Work(WorkCommand::Align(job)) => Some(job),
            _ => None,
        }));
    }
    let probe = jobs[0].scene().probe.as_ref().unwrap();
    let report = app_core::probe::ProbeReport::of(probe).unwrap();
    let off_rad = report.lights[0].seen.direction_in_world.angle_between(lamp());
    assert!(off_rad.to_degrees() < 1.0, "{} degrees", off_rad.to_degrees());
}

#[test]
fn a_camera_that_stays_bright_is_not_waited_for() {
    let mut person = Person::at_ghost(&LIT);
    person.can_darken = false;
    person.take_lens();
    person.frames(59);
    assert!(person.app.is_taking_lens());
    person.frames(4);
    assert_eq!(
        person.app.notice(),
        Some(&Notice::LensFailed(LensFailure::NotDark))
    );
    assert_eq!(
        person.commands,
        ["Platform(Underexpose(true))", "Platform(Underexpose(false))"]
    );
}

#[test]
fn a_lens_that_shows_no_light_is_not_taken() {
    let mut person = Person::at_ghost(&session("lens-unlit", false));
    person.take_lens();
    person.frames(1);
    assert_eq!(
        person.app.notice(),
        Some(&Notice::LensFailed(LensFailure::NoLight))
    );
}

#[test]
fn a_card_that_is_not_seen_tells_no_lens() {
    let mut person = Person::at_ghost(&LIT);
    let mut frame = person.frame();
    frame.world_from_card = None;
    person.tell(ShellEvent::Frame(Box::new(frame)));
    person.tell(ShellEvent::User(UserAction::TakeLens));
    assert!(!person.app.is_taking_lens());
    assert_eq!(
        person.app.notice(),
        Some(&Notice::LensFailed(LensFailure::NotSeen))
    );
}

#[test]
fn the_lens_lies_where_the_page_says() {
    // The place is 29 mm left of the pattern's centre and 113 mm further down the page.
    let place = card_from_lens().w_axis.truncate();
    assert!(place.abs_diff_eq(DVec3::new(-0.029, 0.0, 0.113), 1e-9), "{place}");
}
