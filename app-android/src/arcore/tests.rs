//! The session's life and its frames, against the fake.

use app_core::camera_frame::CameraImage;
use glam::{DVec2, DVec3};

use super::fake::{FakePlane, alive, functions, world};
use super::ffi::{Functions, SIGNATURES};
use super::frame::{FrameError, Lie};
use super::session::{CameraMode, Java, best_mode};
use super::status::{Failure, Remedy, STATUSES};
use super::tracker::{Geometry, Phone, Step, Tracker, Wait};

/// A phone whose person answers as told.
#[derive(Default)]
struct Desk {
    allows: bool,
    n_asked: usize,
}

impl Phone for &mut Desk {
    fn java(&mut self) -> Java {
        let somewhere = std::ptr::without_provenance_mut(8);
        Java {
            env: somewhere,
            activity: somewhere,
        }
    }

    fn has_camera_permission(&mut self) -> bool {
        self.allows
    }

    fn ask_for_camera(&mut self) {
        self.n_asked += 1;
    }
}

fn allowing() -> Desk {
    Desk {
        allows: true,
        n_asked: 0,
    }
}

/// Nothing is left, nothing was given back twice or used after.
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
    let mut desk = allowing();
    let mut tracker = Tracker::new(functions(), &mut desk);
    let size_px = [2400, 1080];
    tracker.set_display(Geometry {
        quarter_turns: 1,
        size_px,
    });
    assert_eq!(tracker.resume(), Step::Ready);
    assert_eq!(
        calls(),
        "availability create mode=2 update=1 planes=3 texture=1 light=2 configure display=1,2400,1080 resume"
    );
    assert_eq!(tracker.resume(), Step::Ready, "twice");
    tracker.pause();
    tracker.pause();
    assert!(tracker.update().expect("no frame").is_none());
    assert_eq!(tracker.resume(), Step::Ready);
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
    let mut desk = allowing();
    let mut tracker = Tracker::new(functions(), &mut desk);
    assert_eq!(tracker.resume(), Step::Waiting(Wait::Answer));
    assert_eq!(tracker.resume(), Step::Waiting(Wait::Install));
    assert_eq!(calls(), "availability availability install=1");
    tracker.pause();
    world(|world| world.install = (-105, 0));
    assert_eq!(tracker.resume(), Step::Refused(Failure(-105)), "declined");
    assert_eq!(calls(), "availability install=0");
    world(|world| world.install = (0, 0));
    assert_eq!(tracker.resume(), Step::Ready);
    drop(tracker);
    assert_clean();
}

#[test]
fn a_phone_that_cannot_is_told_so_and_asked_for_nothing() {
    world(|world| world.availability = vec![100]);
    let mut desk = Desk::default();
    let mut tracker = Tracker::new(functions(), &mut desk);
    let step = tracker.resume();
    assert_eq!(calls(), "availability");
    let (message, remedy) = step.message().expect("a message");
    assert_eq!(remedy, Some(Remedy::None));
    assert!(message.starts_with("This phone cannot run ARCore."), "{message}");
    drop(tracker);
    assert_eq!(desk.n_asked, 0);
}

#[test]
fn the_camera_is_asked_for_once_and_again_after_it_was_allowed_and_taken_away() {
    let mut desk = Desk::default();
    let mut first = Tracker::new(functions(), &mut desk);
    assert_eq!(first.resume(), Step::Waiting(Wait::Permission));
    first.pause();
    assert_eq!(first.resume(), Step::Refused(Failure(-9)));
    assert_eq!(first.resume(), Step::Refused(Failure(-9)));
    drop(first);
    assert_eq!(desk.n_asked, 1);

    desk.allows = true;
    let phone = std::cell::RefCell::new(desk);
    let mut tracker = Tracker::new(functions(), &phone);
    assert_eq!(tracker.resume(), Step::Ready);
    tracker.pause();
    phone.borrow_mut().allows = false;
    assert_eq!(tracker.resume(), Step::Waiting(Wait::Permission));
    phone.borrow_mut().allows = true;
    assert_eq!(tracker.resume(), Step::Ready);
    drop(tracker);
    assert_clean();
}

impl Phone for &std::cell::RefCell<Desk> {
    fn java(&mut self) -> Java {
        (&mut *self.borrow_mut()).java()
    }

    fn has_camera_permission(&mut self) -> bool {
        self.borrow().allows
    }

    fn ask_for_camera(&mut self) {
        self.borrow_mut().n_asked += 1;
    }
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
        let mut desk = allowing();
        let mut tracker = Tracker::new(functions(), &mut desk);
        assert_eq!(tracker.resume(), Step::Refused(Failure(status)), "{step}");
        world(|world| world.fails.clear());
        assert_eq!(tracker.resume(), Step::Ready, "{step}");
        drop(tracker);
        assert_clean();
    }
}

#[test]
fn a_phone_without_light_estimation_does_without() {
    world(|world| {
        world.fails.insert("configure", -8);
        world.time_ns = 5;
    });
    let mut desk = allowing();
    let mut tracker = Tracker::new(functions(), &mut desk);
    assert_eq!(tracker.resume(), Step::Ready);
    assert!(calls().contains("light=2 configure update=1 planes=3 texture=1 light=0 configure"));
    let frame = tracker.update().expect("no error").expect("a frame");
    assert_eq!(frame.light, None);
    drop(tracker);
    assert_clean();
}

#[test]
fn a_frame_is_copied_whole() {
    world(|world| {
        world.time_ns = 77;
        world.planes = vec![
            FakePlane {
                state: 0,
                kind: 0,
                pose: [0.0, 0.0, 0.0, 1.0, 0.0, -0.4, 0.0],
                outline: vec![0.5, 0.25, -0.5, 0.25, 0.0, -0.25],
                merged_into: None,
            },
            FakePlane {
                state: 0,
                kind: 2,
                pose: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0],
                outline: vec![],
                merged_into: Some(0),
            },
            FakePlane {
                state: 1,
                kind: 0,
                pose: [0.0; 7],
                outline: vec![],
                merged_into: None,
            },
        ];
    });
    let mut desk = allowing();
    let mut tracker = Tracker::new(functions(), &mut desk);
    assert_eq!(tracker.resume(), Step::Ready);
    let frame = tracker.update().expect("no error").expect("a frame");
    assert_eq!(frame.time_ns, 77);
    let CameraImage::Planes(image) = &frame.image else {
        panic!("{:?}", frame.image);
    };
    assert_eq!(
        (image.size_px(), image.luma(), image.chroma()),
        ([4, 2], &[50; 8][..], &[90, 200, 90, 200][..])
    );
    let pose = frame.world_from_camera.expect("a pose");
    assert_eq!(pose.transform_point3(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(
        frame.sensor_px_from_camera_rdf * DVec3::Z,
        DVec3::new(2.0, 1.0, 1.0)
    );
    assert_eq!(frame.lost, None);
    let light = frame.light.expect("light");
    assert_eq!(light.direction_to_light_in_world, Some(DVec3::Z));
    assert_eq!(light.intensity, Some([1.0, 2.0, 3.0]));
    let [table, wall] = &frame.planes[..] else {
        panic!("{:?}", frame.planes);
    };
    assert_eq!((table.lie, wall.lie), (Lie::Up, Lie::Upright));
    assert_eq!(
        table.world_from_plane.transform_point3(DVec3::ZERO).y,
        f64::from(-0.4_f32)
    );
    assert_eq!(table.outline_m[1], DVec2::new(-0.5, 0.25));
    assert_eq!(table.merged_into, None);
    assert!(wall.merged_into.is_some());
    drop(tracker);
    assert_clean();
}

#[test]
fn no_frame_before_the_first_twice_or_without_its_picture() {
    let mut desk = allowing();
    let mut tracker = Tracker::new(functions(), &mut desk);
    assert_eq!(tracker.resume(), Step::Ready);
    let mut n_frames = |time_ns, image| {
        world(|world| {
            world.time_ns = time_ns;
            world.fails.insert("image", image);
        });
        usize::from(tracker.update().expect("no error").is_some())
    };
    assert_eq!(n_frames(0, 0), 0, "before the first");
    assert_eq!(n_frames(10, 0), 1);
    assert_eq!(n_frames(10, 0), 0, "again");
    for status in [-12, -11, -10] {
        assert_eq!(n_frames(20, status), 0, "{status}");
    }
    assert_eq!(n_frames(20, 0), 1, "its picture came later");
    assert_eq!(tracker.n_missed(), 3);
    drop(tracker);
    assert_clean();
}

#[test]
fn a_camera_that_is_lost_has_no_pose_and_a_message() {
    let mut desk = allowing();
    let mut tracker = Tracker::new(functions(), &mut desk);
    assert_eq!(tracker.resume(), Step::Ready);
    for reason in 0..=6 {
        world(|world| {
            world.time_ns += 1;
            world.tracking = (1, reason);
        });
        let frame = tracker.update().expect("no error").expect("a frame");
        assert_eq!(frame.world_from_camera, None);
        assert!(
            frame.lost.is_some_and(|message| message.ends_with('.')),
            "{reason}"
        );
    }
}

#[test]
fn frames_that_are_wrong_are_errors_and_leave_nothing() {
    type Harm = fn(&mut super::fake::World);
    let harms: [(&str, Harm); 8] = [
        ("format 0x1", |world| world.format = 1),
        ("has 2 planes", |world| world.image.truncate(2)),
        ("luma: 7 bytes", |world| world.image[0].0.truncate(7)),
        ("luma: rows", |world| world.image[0].1 = -4),
        ("Cb: rows", |world| world.image[1].2 = 0),
        ("0 x 2 px", |world| world.size_px = [-4, 2]),
        ("focal length", |world| world.intrinsics[0] = 0.0),
        ("focal length", |world| world.intrinsics[3] = f32::NAN),
    ];
    for (message, harm) in harms {
        world(|world| {
            *world = super::fake::World::default();
            harm(world);
        });
        let mut desk = allowing();
        let mut tracker = Tracker::new(functions(), &mut desk);
        assert_eq!(tracker.resume(), Step::Ready);
        let error = tracker.update().expect_err(message).to_string();
        assert!(error.contains(message), "{error}");
        drop(tracker);
        assert_clean();
    }
}

#[test]
fn after_a_fatal_failure_a_new_session_begins() {
    let mut desk = allowing();
    let mut tracker = Tracker::new(functions(), &mut desk);
    assert_eq!(tracker.resume(), Step::Ready);
    world(|world| world.fails.insert("update", -2));
    assert!(matches!(tracker.update(), Err(FrameError::Failed(Failure(-2)))));
    assert_clean();
    world(|world| world.fails.clear());
    calls();
    assert_eq!(tracker.resume(), Step::Ready);
    assert!(calls().starts_with("availability create"));
    drop(tracker);
    assert_clean();
}

#[test]
fn a_session_that_cannot_be_paused_is_given_up() {
    let mut desk = allowing();
    let mut tracker = Tracker::new(functions(), &mut desk);
    assert_eq!(tracker.resume(), Step::Ready);
    world(|world| world.fails.insert("pause", -2));
    tracker.pause();
    assert_clean();
}

#[test]
fn the_camera_is_set_to_the_largest_picture_that_is_not_too_large() {
    let mode = |width, height, hz| CameraMode {
        size_px: [width, height],
        hz,
    };
    assert_eq!(best_mode(&[]), None);
    let modes = [
        mode(640, 480, 30),
        mode(1920, 1080, 60),
        mode(1920, 1080, 30),
        mode(2560, 1440, 30),
    ];
    assert_eq!(best_mode(&modes), Some(2));
    assert_eq!(best_mode(&[mode(4000, 3000, 30), mode(2560, 1440, 30)]), Some(1));
}

#[test]
fn every_status_has_a_message_of_its_own() {
    for (index, (number, name, message, _)) in STATUSES.iter().enumerate() {
        assert!(message.ends_with('.') && message.len() > 15, "{name}");
        assert!(Failure(*number).to_string().starts_with(message));
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
