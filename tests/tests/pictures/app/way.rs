//! A person's way through the bundled session: a table, a plate, a ghost with a small offset, and a
//! moving toy.

use std::sync::Arc;

use app_core::app::{
    App, Placing, PlatformCommand, ShellCommand, ShellEvent, Show, Step, UserAction, Verdict, WatchJob,
    WorkCommand,
};
use app_core::interface::announced;
use app_core::recording::RecordingJob;
use app_core::scene::{Camera, Image};
use app_core::session::{Capture, Session};
use desk::files::BUNDLED_SESSION;
use desk::stored::Stored;
use glam::{DMat4, DVec2, DVec3};
use view::feed::Feed;

use crate::app::world;

/// Offset of the ghost.
pub(crate) const OFF_M: DVec3 = DVec3::new(0.004, 0.0, -0.003);
const OFF_RAD: f64 = 0.1;

pub(crate) struct Person {
    pub(crate) app: App,
    pub(crate) feed: Feed,
    /// Recordings that are waiting to be written.
    pub(crate) recordings: Vec<RecordingJob>,
    /// Searches for things, which do not end; `None` if each ends at once.
    pub(crate) watches: Option<Vec<WatchJob>>,
    /// Haptic pulses so far.
    pub(crate) n_knocks: usize,
    /// The words that were announced last.
    pub(crate) announced: String,
    /// A grey card over the camera's picture: its left, top, right and bottom, in pixels.
    pub(crate) card_px: Option<[u32; 4]>,
    /// Change of the camera's picture.
    pub(crate) retouch: Option<Retouch>,
}

/// A change of a picture.
type Retouch = Box<dyn Fn(&Image) -> Image>;

impl Person {
    pub(crate) fn tell(&mut self, event: ShellEvent) {
        for command in self.app.event(event) {
            match command {
                ShellCommand::Work(WorkCommand::Plate(job)) => {
                    self.tell(ShellEvent::Plated(Some(Box::new(job.run()))));
                }
                ShellCommand::Work(WorkCommand::Search(job)) => {
                    self.tell(ShellEvent::Searched(Some(Box::new(job.run()))));
                }
                ShellCommand::Work(WorkCommand::Align(job)) => {
                    self.tell(ShellEvent::Aligned(Box::new(job.run())))
                }
                ShellCommand::Work(WorkCommand::Watch(job)) => match &mut self.watches {
                    Some(watches) => watches.push(*job),
                    None => self.tell(ShellEvent::Watched(Box::new(job.run()))),
                },
                ShellCommand::Work(WorkCommand::Record(job)) => self.recordings.extend(job.map(|job| *job)),
                ShellCommand::Platform(PlatformCommand::Knock) => self.n_knocks += 1,
                ShellCommand::Platform(PlatformCommand::Announce(_)) => self.announced = announced(&self.app),
                _ => {}
            }
        }
    }

    pub(crate) fn act(&mut self, action: UserAction) {
        self.tell(ShellEvent::User(action));
    }

    pub(crate) fn frames(&mut self, n: usize) {
        for _ in 0..n {
            let mut frame = self.feed.next(0.033);
            if let Some(card_px) = self.card_px {
                frame.image = covered(frame.image.rgba(), card_px).into();
            }
            if let Some(retouch) = &self.retouch {
                frame.image = retouch(frame.image.rgba()).into();
            }
            self.tell(ShellEvent::Frame(Box::new(frame)));
        }
    }

    /// Waits until the question about the toy's place is in such a state.
    pub(crate) fn wait_until(&mut self, is_so: impl Fn(Placing) -> bool) {
        for _ in 0..90 {
            if is_so(self.app.placing()) {
                return;
            }
            self.frames(1);
        }
        panic!("{:?}", self.app.placing());
    }

    pub(crate) fn pixel_of(&self, moved_m: DVec3) -> DVec2 {
        let (world_from_object, camera) = self.feed.toy();
        let at = world_from_object.w_axis.truncate() + moved_m;
        camera.pixel_of(at).unwrap()
    }
}

/// A picture with a grey card over it.
fn covered(image: &Image, [left, top, right, bottom]: [u32; 4]) -> Image {
    let mut image = image.clone();
    for y in top..bottom {
        for x in left..right {
            let at = 4 * (y * image.width_px + x) as usize;
            image.rgba8[at..at + 3].fill(60);
        }
    }
    image
}

fn yaw_rad(pose: &DMat4) -> f64 {
    pose.z_axis.x.atan2(pose.z_axis.z)
}

fn facing_rad(world_from_object: &DMat4, camera: &Camera) -> f64 {
    let to_camera = camera.world_from_camera.w_axis - world_from_object.w_axis;
    to_camera.x.atan2(to_camera.z)
}

/// A person who has photographed the empty place.
pub(crate) fn photographed() -> Person {
    let feed = Feed::of_stored(Stored::open(BUNDLED_SESSION).unwrap()).unwrap();
    let app = App::new(Arc::clone(&feed.scene().toy));
    let mut person = Person {
        app,
        feed,
        recordings: Vec::new(),
        watches: None,
        n_knocks: 0,
        announced: String::new(),
        card_px: None,
        retouch: None,
    };
    world::opening().into_iter().for_each(|event| person.tell(event));
    person.frames(2);
    let at = person.pixel_of(DVec3::ZERO);
    person.act(UserAction::Tap(at));
    assert_eq!(person.app.step(), Step::TakePlate);
    for _ in 0..60 {
        if person.app.step() == Step::TakePlate {
            person.frames(1);
        }
    }
    assert_eq!(person.app.step(), Step::PlaceToy);
    assert!(person.app.has_plate());
    person
}

/// A person who has placed the ghost with this offset, and waits.
pub(crate) fn placed(off_m: DVec3) -> Person {
    let mut person = photographed();
    person.feed.is_toy_there = true;
    person.frames(1);
    let (world_from_object, camera) = person.feed.toy();
    let turn_rad = yaw_rad(world_from_object) - facing_rad(world_from_object, camera) + OFF_RAD;
    let at = person.pixel_of(off_m);
    person.act(UserAction::Twist(turn_rad));
    person.act(UserAction::Tap(at));
    assert!(matches!(person.app.placing(), Placing::Asked { .. }));
    person.act(UserAction::Placed);
    assert_eq!(person.app.step(), Step::Align);
    person
}

#[test]
fn a_ghost_that_is_a_little_off_becomes_a_toy_that_moves() {
    let mut person = placed(OFF_M);
    person.frames(1);
    assert_eq!(person.app.step(), Step::Play, "{:?}", person.app.verdict());
    let Some(Verdict::Found {
        outline_px: Some(outline_px),
        no_light: None,
    }) = person.app.verdict()
    else {
        panic!("{:?}", person.app.verdict());
    };
    assert!(*outline_px < 0.5, "{outline_px}");
    person.frames(20);
    let Show::Toy { scene, input, .. } = person.app.show() else {
        panic!("{:?}", person.app.step());
    };
    assert!(input.effect == 1.0);
    assert_eq!(scene.plates.len(), 1);
    let (truth, _) = person.feed.toy();
    let off = input.world_from_object.w_axis.truncate() - truth.w_axis.truncate();
    assert!(off.length() < 5e-4, "{off} m");
    let turned_rad = (yaw_rad(&input.world_from_object) - yaw_rad(truth)).abs();
    assert!(turned_rad < 0.01, "{turned_rad}");
    assert_eq!(input.lights.as_ref().map(|lights| lights.len()), Some(1));
}

#[test]
fn the_toy_of_a_session_is_there_while_the_app_expects_it() {
    let mut feed = Feed::of_stored(Stored::open(BUNDLED_SESSION).unwrap()).unwrap();
    let mut there = |step| {
        feed.follow(step);
        feed.is_toy_there
    };
    assert_eq!(Step::ALL.map(&mut there), [false, false, false, true, true, true]);
    assert!(!there(Step::TakePlate), "it is taken off for another photograph");
}

#[test]
fn a_recording_that_is_too_long_to_be_kept_gives_the_same_frames() {
    let session = Arc::new(Capture::open(Stored::open(BUNDLED_SESSION).unwrap()).unwrap());
    let n_frames = session.n_frames();
    let [mut all, mut first] = [usize::MAX, 0].map(|most_bytes| {
        let mut feed = Feed::keeping(session.clone(), most_bytes).unwrap();
        feed.is_toy_there = true;
        feed
    });
    for _ in 0..=n_frames {
        let [all, first] = [&mut all, &mut first].map(|feed| feed.next(0.033));
        assert_eq!(all.image.rgba().rgba8, first.image.rgba().rgba8);
    }
}

#[test]
fn a_search_that_died_counts_for_its_own_place_alone() {
    let mut person = placed(OFF_M);
    person.watches = Some(Vec::new());
    let n_begun = |person: &mut Person| {
        person.frames(10);
        assert_eq!(person.app.step(), Step::Play, "{:?}", person.app.verdict());
        person.watches.as_ref().map_or(0, Vec::len)
    };
    assert_eq!(n_begun(&mut person), 1, "one at a time");
    person.act(UserAction::Replace);
    person.act(UserAction::Placed);
    assert_eq!(n_begun(&mut person), 2, "one of each place");
    let die = |person: &mut Person, index: usize| {
        let died = person
            .watches
            .as_ref()
            .map(|watches| watches[index].without_result());
        person.tell(ShellEvent::Watched(Box::new(died.expect("a search"))));
    };
    die(&mut person, 0);
    assert_eq!(n_begun(&mut person), 2, "that of the present place still runs");
    die(&mut person, 1);
    assert_eq!(n_begun(&mut person), 3, "another one begins");
}

#[test]
fn a_toy_that_is_put_down_is_found_without_a_touch() {
    let mut person = photographed();
    person.frames(30);
    assert_eq!(person.app.placing(), Placing::Waiting { is_long: false });
    assert!(person.app.ghost().is_none(), "nobody knows where the toy will be");
    person.feed.is_toy_there = true;
    person.n_knocks = 0;
    person.wait_until(|placing| placing == Placing::Asked { is_searching: true });
    assert_eq!(person.n_knocks, 0, "a guess is no toy");
    person.wait_until(|placing| placing == Placing::Asked { is_searching: false });
    assert_eq!(person.n_knocks, 1);
    assert!(
        person.announced.starts_with("Is it on your toy?"),
        "{}",
        person.announced
    );
    let silhouette = person.app.ghost().expect("a ghost");
    let [low, high] = silhouette.corners_px;
    let toy_px = person.pixel_of(DVec3::new(0.0, 0.02, 0.0));
    assert!(
        low.cmplt(toy_px).all() && toy_px.cmplt(high).all(),
        "{low} {high}"
    );
    person.act(UserAction::Placed);
    person.frames(1);
    assert_eq!(person.app.step(), Step::Play, "{:?}", person.app.verdict());
    assert_eq!(person.n_knocks, 1, "once for each toy");
    person.frames(20);
    let Show::Toy { input, .. } = person.app.show() else {
        panic!("{:?}", person.app.step());
    };
    let (truth, _) = person.feed.toy();
    let turned_rad = (yaw_rad(&input.world_from_object) - yaw_rad(truth)).abs();
    assert!(turned_rad < 0.01, "{turned_rad}");
    // The ghost returns to the estimated place.
    person.act(UserAction::Replace);
    assert_eq!(person.app.placing(), Placing::ByHand);
    assert!(person.app.ring_px().is_some());
}

#[test]
fn a_thumb_around_the_ring_turns_the_ghost_and_within_it_moves_it() {
    let mut person = placed(OFF_M);
    person.act(UserAction::Replace);
    let pose = |person: &Person| person.app.ring_px().expect("a ring");
    let (ring, knob) = pose(&person);
    let middle: DVec2 = ring.iter().sum::<DVec2>() / ring.len() as f64;
    // The drag goes from the ring's knob to the corner a quarter of the ring away.
    let at = ring.iter().enumerate();
    let (at, _) = at
        .min_by(|(_, a), (_, b)| a.distance(knob).total_cmp(&b.distance(knob)))
        .expect("corners");
    let to_px = ring[(at + ring.len() / 4) % ring.len()];
    person.act(UserAction::Drag {
        from_px: ring[at],
        to_px,
    });
    let (after, knob) = pose(&person);
    assert!(knob.distance(to_px) < 12.0, "{knob} follows the thumb to {to_px}");
    assert!(after[0].distance(ring[0]) < 1e-6, "the ring stays in its place");
    let to_px = middle + DVec2::new(30.0, 0.0);
    person.act(UserAction::Drag {
        from_px: middle,
        to_px,
    });
    let (moved, _) = pose(&person);
    assert!(moved[0].distance(ring[0]) > 15.0, "{} {}", moved[0], ring[0]);
}

#[test]
fn a_ghost_that_is_nowhere_near_is_said_to_be() {
    let mut person = placed(DVec3::new(0.25, 0.0, 0.1));
    person.frames(1);
    assert_eq!(person.app.step(), Step::PlaceToy, "{:?}", person.app.verdict());
    assert!(person.app.notice().is_some());
}
