//! Whole pictures of cases that the bundled session lacks: several lights, a wall, a moving camera.

use app_core::preset::Preset;
use app_core::scene::Image;
use glam::DVec3;
use harness::golden::{Goldens, ON_HARDWARE, ON_SOFTWARE};

use crate::cores::{any_core, core_on};
use crate::photo::Photo;
use crate::run::{input, plate_of, scene};
use crate::setups::{SETUPS, Setup, WALL};
use crate::stand::Stand;

/// Viewpoints of the moving camera, as offsets from its target; the picture is that of the last.
const VIEWS: [DVec3; 3] = [
    DVec3::new(-0.3, 0.42, 0.2),
    DVec3::new(0.0, 0.36, 0.42),
    DVec3::new(0.2, 0.3, 0.38),
];

/// The pictures by their names.
fn pictures() -> [(&'static str, Image); 3] {
    let large = |setup: Setup| Setup {
        image_px: 2 * setup.image_px,
        ..setup
    };
    [
        ("boxes_two_lights", seen_at_once(large(SETUPS[1]))),
        ("boxes_wall", seen_at_once(large(WALL))),
        ("boxes_moving_camera", seen_in_passing(large(SETUPS[0]))),
    ]
}

fn seen_at_once(setup: Setup) -> Image {
    seen_by(&[Stand::new(setup)])
}

fn seen_in_passing(setup: Setup) -> Image {
    seen_by(&VIEWS.map(|offset| Stand::seen_from(setup, offset)))
}

/// The picture of the last of several views, with a plate of the first alone.
fn seen_by(stands: &[Stand]) -> Image {
    let photo = Photo::plain(stands[0].setup.lights.len());
    let frames: Vec<_> = stands
        .iter()
        .map(|stand| photo.frame(stand, &stand.physical))
        .collect();
    let staged =
        scene(&stands[0], &frames[0]).with_plates(vec![plate_of(&stands[0], &photo.plate(&stands[0]))]);
    let mut core = core_on(staged, Preset::Balanced).unwrap();
    for (stand, frame) in stands.iter().zip(&frames) {
        core.frame(&input(stand, frame)).unwrap();
    }
    core.read_picture().unwrap()
}

#[test]
fn pictures_are_their_goldens() {
    let is_software = any_core().is_software();
    let checks = if is_software { ON_SOFTWARE } else { ON_HARDWARE };
    let failures =
        pictures().map(|(name, picture)| Goldens::of_project().check(name, &picture, checks).err());
    let failures: Vec<String> = failures
        .into_iter()
        .flatten()
        .map(|error| error.to_string())
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The bytes are the same for any order of the receivers.
#[test]
fn receivers_may_be_listed_in_any_order() {
    let stand = Stand::new(WALL);
    let photo = Photo::plain(stand.setup.lights.len());
    let frame = photo.frame(&stand, &stand.physical);
    let listed = scene(&stand, &photo.plate(&stand));
    let mut reversed = listed.clone();
    reversed.receivers.reverse();
    for preset in [Preset::Balanced, Preset::Paper] {
        let pictures = [&listed, &reversed].map(|scene| {
            let mut core = core_on(scene.clone(), preset).unwrap();
            core.frame(&input(&stand, &frame)).unwrap();
            core.read_picture().unwrap()
        });
        assert!(pictures[0] == pictures[1], "{preset}");
    }
}

/// A part of `cargo xtask bless`: makes the goldens anew, and fails, so that a person inspects
/// them.
#[test]
#[ignore = "writes the goldens"]
fn bless() {
    for (name, picture) in pictures() {
        Goldens::of_project().write(name, &picture).unwrap();
    }
    panic!("blessed, look at the pictures, then run the tests again");
}
