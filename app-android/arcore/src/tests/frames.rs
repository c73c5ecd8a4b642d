//! The content of ARCore's frames, and the cases without a frame.

use app_core::camera_frame::{CameraImage, Stamp, Tracking};
use glam::{DMat4, DVec2, DVec3};

use super::super::fake::{FakePlane, World, world};
use super::{ANEW, Desk, LOOK, assert_clean, calls, running, update};
use crate::tracker::{Geometry, Run, Step};

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
            },
            FakePlane {
                state: 0,
                kind: 2,
                pose: [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0],
                outline: vec![0.5, 0.25, -0.5, 0.25, 0.0, -0.25],
            },
            FakePlane {
                state: 1,
                kind: 0,
                pose: [0.0; 7],
                outline: vec![],
            },
        ];
    });
    let mut tracker = running();
    let frame = update(&mut tracker).expect("no error").expect("a frame");
    let stamp = Stamp {
        id: 0,
        time_ns: 77,
        world_epoch: 1,
    };
    assert_eq!(frame.stamp, stamp);
    let CameraImage::Planes(image) = &frame.image else {
        panic!("{:?}", frame.image);
    };
    assert_eq!(
        (image.size_px(), image.luma(), image.chroma()),
        ([4, 2], &[50; 8][..], &[90, 200, 90, 200][..])
    );
    let pose = frame.world_from_camera.expect("a pose");
    assert_eq!(pose.transform_point3(DVec3::ZERO), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!((frame.intrinsics.fx_px, frame.intrinsics.cy_px), (500.0, 1.0));
    assert_eq!(frame.tracking, Tracking::Normal);
    assert_eq!(frame.light_estimate, None);
    let [table] = &frame.planes[..] else {
        panic!("walls and what is not tracked are left out: {:?}", frame.planes);
    };
    let centre = table.world_from_plane.transform_point3(DVec3::ZERO);
    assert_eq!(centre, DVec3::new(0.0, f64::from(-0.4_f32), 0.0));
    assert_eq!(table.half_extent_m, DVec2::new(0.5, 0.25));
    drop(tracker);
    assert_clean();
}

#[test]
fn exposure_is_told_where_the_camera_tells_it() {
    let mut tracker = running();
    let mut exposure = |told, status| {
        world(|world| {
            world.exposure = told;
            world.fails.insert("metadata", status);
            world.time_ns += 1;
        });
        let frame = update(&mut tracker).expect("no error").expect("a frame");
        frame.exposure.and_then(|exposure| exposure.amount())
    };
    // A hundredth of a second at ISO 200.
    assert_eq!(exposure((10_000_000, 200, 1), 0), Some(0.02));
    assert_eq!(exposure((10_000_000, 200, 1), -12), None, "not yet there");
    assert_eq!(exposure((10_000_000, 200, 3), 0), None, "another type");
    assert_eq!(exposure((0, 200, 1), 0), None);
    assert_eq!(exposure((10_000_000, -1, 1), 0), None);
    drop(tracker);
    assert_clean();
}

#[test]
fn the_card_is_where_it_is_seen_and_nowhere_else() {
    let card = |state, method| FakePlane {
        state,
        kind: method,
        pose: [0.0, 0.0, 0.0, 1.0, 0.5, -0.25, 0.0],
        outline: Vec::new(),
    };
    let mut tracker = running();
    // Tracked and visible, at its last visible pose, paused, stopped.
    let seen = [(0, 1), (0, 2), (1, 1), (2, 0)].map(|(state, method)| {
        world(|world| {
            world.images = vec![card(state, method)];
            world.time_ns += 1;
        });
        let frame = update(&mut tracker).expect("no error").expect("a frame");
        assert!(frame.planes.is_empty());
        frame.world_from_card
    });
    let place = DMat4::from_translation(DVec3::new(0.5, -0.25, 0.0));
    assert_eq!(seen, [Some(place), None, None, None]);
    drop(tracker);
    assert_clean();
}

#[test]
fn a_card_is_looked_for_where_one_is_and_done_without_where_it_is_refused() {
    let with_card = Run {
        finds_card: true,
        ..LOOK
    };
    let mut tracker = running();
    assert!(!calls().contains("images"), "nobody has one");
    assert_eq!(tracker.run(&mut Desk, with_card), Step::Ready);
    assert_eq!(
        calls(),
        "card=600x600,0.15,true update=1 planes=1 texture=1 light=0 focus=1 images configure"
    );
    drop(tracker);
    assert_clean();
    world(|world| {
        world.fails.insert("add image", -17);
    });
    let mut tracker = running();
    calls();
    assert_eq!(tracker.run(&mut Desk, with_card), Step::Ready);
    assert!(calls().ends_with("focus=1 configure"), "no images are set");
    drop(tracker);
    assert_clean();
}

#[test]
fn a_picture_is_turned_as_the_display_lies() {
    let mut tracker = running();
    let mut turns = |rotation, display_turns, state| {
        tracker.set_display(Geometry {
            quarter_turns: rotation,
            size_px: [2400, 1080],
        });
        world(|world| {
            world.display_turns = display_turns;
            world.tracking = (state, 0);
            world.time_ns += 1;
        });
        let frame = update(&mut tracker).expect("no error").expect("a frame");
        frame.display.quarter_turns
    };
    // Before any pose is known: the value of nearly every phone.
    assert_eq!([turns(1, 3, 1), turns(3, 3, 1), turns(0, 3, 1)], [0, 2, 1]);
    // With the display's rotation.
    assert_eq!([turns(1, 0, 0), turns(3, 2, 0), turns(0, 1, 0)], [0, 2, 1]);
    // A sensor with another rotation, as in some tablets: it is determined, and stays known while
    // the pose is not.
    assert_eq!([turns(0, 0, 0), turns(1, 0, 1), turns(3, 0, 1)], [0, 3, 1]);
    assert_eq!(tracker.run(&mut Desk, ANEW), Step::Ready);
    drop(tracker);
    assert_clean();
}

#[test]
fn no_frame_before_the_first_twice_or_without_its_picture() {
    let mut tracker = running();
    let mut n_frames = |time_ns, image| {
        world(|world| {
            world.time_ns = time_ns;
            world.fails.insert("image", image);
        });
        usize::from(update(&mut tracker).expect("no error").is_some())
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
fn a_camera_that_is_lost_has_no_pose_and_a_reason() {
    let mut tracker = running();
    let expected = [
        Tracking::Starting,
        Tracking::Relocalising,
        Tracking::TooDark,
        Tracking::TooFast,
        Tracking::TooPlain,
        Tracking::Starting,
        Tracking::Starting,
    ];
    for (reason, expected) in (0..).zip(expected) {
        world(|world| {
            world.time_ns += 1;
            world.tracking = (1, reason);
        });
        let frame = update(&mut tracker).expect("no error").expect("a frame");
        assert_eq!(frame.world_from_camera, None);
        assert_eq!(frame.tracking, expected, "{reason}");
    }
}

#[test]
fn frames_that_are_wrong_are_errors_and_leave_nothing() {
    type Harm = fn(&mut World);
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
            *world = World::default();
            harm(world);
        });
        let mut tracker = running();
        let error = update(&mut tracker).expect_err(message).to_string();
        assert!(error.contains(message), "{error}");
        drop(tracker);
        assert_clean();
    }
}
