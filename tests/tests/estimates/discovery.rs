//! Lights that are not listed are found by the toy's shadow: in the right number, at their places,
//! and none if there is none.
//!
//! Worlds are photographed by exact rays; the lights that are found are compared with the true
//! lamps.

use std::sync::{Arc, LazyLock};

use app_core::alignment::{Aligner, Alignment, AlignmentWarning, EstimatedLight, NoLight};
use app_core::frame::FrameInput;
use app_core::scene::{Light, LightEstimate, N_HARMONICS, Scene};
use app_core::session::{Capture, Session};
use desk::alignment::{Alignments, Asked, SeenLight};
use desk::check::aligned_session::{self, Assumed};
use desk::files::{BUNDLED_SESSION, Folder};
use desk::stored::Stored;
use glam::DVec3;
use harness::temporary::Temporary;
use measure::photographer;
use measure::photographer::world::toward;
use measure::photographer::{Lamp, Quality, Shot, World};

/// Size of the pictures: 1 px is a third of a millimetre on the table.
const SIZE_PX: [u32; 2] = [512, 288];

/// Photograph and alignment of the boxes under some lamps, without a list of them.
fn discover(lamps: Vec<Lamp>) -> (Shot, Alignment) {
    let shot = photographed(lamps);
    let found = Aligner::new(shot.scene.clone()).align(&shot.input).unwrap();
    (shot, found)
}

/// The same without a plate.
fn discover_without_plate(lamps: Vec<Lamp>) -> Alignment {
    let Shot { mut scene, input, .. } = photographed(lamps);
    scene.plates.clear();
    Aligner::new(scene).align(&input).unwrap()
}

fn photographed(lamps: Vec<Lamp>) -> Shot {
    let mut world = World::boxes().resized(SIZE_PX).lit_by(lamps);
    world.quality = Quality {
        n_across: 2,
        n_light_rays: 48,
        n_sky_rays: 32,
    };
    let mut shot = Shot::of(&world).unwrap();
    shot.scene.lights.clear();
    shot
}

/// The lights that are found for the lamps, nearest first; as many as there are lamps.
fn matched(lamps: &[Lamp]) -> Vec<(EstimatedLight, SeenLight)> {
    let (shot, found) = discover(lamps.to_vec());
    let mut lights = found.report.discovered.clone();
    assert_eq!(lights.len(), lamps.len(), "{:#?}", found.report);
    assert_eq!(found.lights.as_deref().map(<[_]>::len), Some(lamps.len()));
    let bounds = shot.scene.toy.bounds_of_pose(&shot.scene.physical_pose).unwrap();
    let middle = shot
        .input
        .world_from_object
        .transform_point3(0.5 * (bounds.min + bounds.max).as_dvec3());
    let pairs = lamps.iter().map(|lamp| {
        let listed = SeenLight::from(middle, &lamp.light);
        let off = |light: &EstimatedLight| light.direction_in_world.angle_between(listed.direction_in_world);
        lights.sort_by(|a, b| off(b).total_cmp(&off(a)));
        (lights.pop().unwrap(), listed)
    });
    pairs.collect()
}

fn assert_near((found, listed): &(EstimatedLight, SeenLight), deg: f64, distance: f64, size: f64) {
    let off_deg = found
        .direction_in_world
        .angle_between(listed.direction_in_world)
        .to_degrees();
    assert!(off_deg < deg, "{off_deg} degrees off: {found:?} for {listed:?}");
    match listed.distance_m {
        Some(distance_m) => {
            let ratio = found.distance_m.unwrap() / distance_m;
            assert!((ratio - 1.0).abs() < distance, "{ratio} times the distance");
        }
        None => assert_eq!(found.distance_m, None, "{found:?}"),
    }
    let ratio = found.angular_radius_rad / listed.angular_radius_rad;
    assert!((ratio - 1.0).abs() < size, "{ratio} times the size: {found:?}");
}

#[test]
fn no_lamp_is_found_where_there_is_none() {
    let (_, found) = discover(Vec::new());
    assert_eq!(
        found.report.no_light,
        Some(NoLight::NoneDominant),
        "{:#?}",
        found.report
    );
    assert_eq!((found.lights, found.report.discovered.len()), (None, 0));
    assert!(
        matches!(
            found.warnings[..],
            [AlignmentWarning::LightNotFound {
                reason: NoLight::NoneDominant
            }]
        ),
        "{:?}",
        found.warnings
    );
}

/// A lamp that covers a third of the sky is not found either: it is assumed, coarsely, and a
/// warning reports that.
#[test]
fn a_window_is_assumed() {
    let window = toward(40.0, 60.0);
    let (shot, found) = discover(vec![Lamp::sun(window, 35.0f64.to_radians(), 0.35)]);
    assert_eq!(found.report.discovered, [], "{:#?}", found.report);
    let assumed = found.report.assumed.unwrap();
    let direction = SeenLight::from(DVec3::ZERO, &assumed.light).direction_in_world;
    let off_deg = direction.angle_between(window).to_degrees();
    assert!(off_deg < 15.0, "{off_deg} degrees off: {assumed:?}");
    assert_eq!(found.lights.as_deref(), Some(&[assumed.light][..]));
    assert!(
        matches!(found.warnings[..], [AlignmentWarning::LightAssumed { .. }]),
        "{:?}",
        found.warnings
    );
    assert_eq!(n_written_with(&shot, Assumed::Written), 1);
    // It is no result.
    assert_eq!(n_written_with(&shot, Assumed::Omitted), 0);
}

/// The number of frames that are corrected in a session of a photograph that is written anew.
fn n_written_with(shot: &Shot, assumed: Assumed) -> usize {
    let folder = Temporary::new("assumed");
    let [given, aligned] = ["given", "aligned"].map(|name| folder.0.join(name));
    photographer::folder::write(&given, shot).unwrap();
    let stored = Stored::open(&given).unwrap();
    let capture = Capture::open(Folder::open(&given).unwrap()).unwrap();
    let alignments = Alignments::find(&capture, 0..1, Asked::default()).unwrap();
    aligned_session::write(&stored, &aligned, &alignments, assumed).unwrap()
}

/// A light that is not a disc is found as several, whether it is listed as one or not.
#[test]
fn a_tube_is_several_lights() {
    const N_BULBS: i32 = 13;
    let along = 0.6 / f64::from(N_BULBS - 1) * DVec3::new(0.8, 0.0, -0.6);
    let middle = toward(55.0, 60.0);
    let bulbs = (-N_BULBS / 2..=N_BULBS / 2).map(|index| {
        let at = middle + f64::from(index) * along;
        Lamp::bulb(at, 0.03, 0.7 / f64::from(N_BULBS))
    });
    let shot = photographed(bulbs.collect());
    for listed in [vec![], vec![Light::sphere(middle, 0.2)]] {
        let scene = shot.scene.clone().with_lights(listed);
        let found = Aligner::new(scene).align(&shot.input).unwrap();
        assert!(
            found.lights.is_some_and(|lights| lights.len() > 1),
            "{:#?}",
            found.report
        );
        assert!(found.report.unexplained.unwrap() < 0.06, "{:#?}", found.report);
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    }
}

#[test]
fn a_bulb_is_found() {
    let bulb = Lamp::bulb(toward(50.0, 30.0), 0.01, 0.75);
    let found = matched(&[bulb]);
    assert_near(&found[0], 0.15, 0.03, 0.1);
    let (found, listed) = &found[0];
    let off_rad = found.direction_in_world.angle_between(listed.direction_in_world);
    assert!(off_rad < 3.0 * found.deviation.direction_rad, "{found:?}");
    assert!((0.4..0.8).contains(&found.share), "{found:?}");
}

#[test]
fn a_wide_lamp_is_found() {
    let found = matched(&[Lamp::bulb(0.8 * toward(55.0, -40.0), 0.08, 0.5)]);
    assert_near(&found[0], 0.4, 0.08, 0.05);
}

#[test]
fn the_sun_is_found_at_no_distance() {
    let found = matched(&[Lamp::sun(toward(42.0, 60.0), 0.5f64.to_radians(), 0.6)]);
    assert_near(&found[0], 0.15, 0.0, 0.1);
}

#[test]
fn two_lamps_are_told_apart() {
    let lamps = [
        Lamp::bulb(toward(50.0, 30.0), 0.01, 0.4),
        Lamp::bulb(0.8 * toward(60.0, -70.0), 0.02, 0.25),
    ];
    for found in matched(&lamps) {
        assert_near(&found, 0.25, 0.05, 0.15);
    }
}

#[test]
fn a_faint_second_lamp_is_found() {
    let lamps = [
        Lamp::bulb(toward(50.0, 30.0), 0.01, 0.75),
        Lamp::bulb(toward(55.0, -80.0), 0.01, 0.09),
    ];
    let found = matched(&lamps);
    assert!(found[1].0.share < 0.1, "{:?}", found[1].0);
    let off = found[1]
        .0
        .direction_in_world
        .angle_between(found[1].1.direction_in_world);
    assert!(off.to_degrees() < 1.0, "{:?}", found[1]);
}

static BUNDLED: LazyLock<(Scene, FrameInput)> = LazyLock::new(|| {
    let session = Capture::open(Folder::open(BUNDLED_SESSION).unwrap()).unwrap();
    let input = FrameInput::from(&session.frame(0).unwrap());
    (session.scene().clone(), input)
});

/// The bundled session's bulb, relative to its toy.
fn bundled_light() -> SeenLight {
    let (scene, input) = &*BUNDLED;
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose).unwrap();
    let middle: DVec3 = 0.5 * (bounds.min + bounds.max).as_dvec3();
    SeenLight::from(input.world_from_object.transform_point3(middle), &scene.lights[0])
}

#[test]
fn the_bundled_bulb_is_found_and_kept() {
    let (mut scene, input) = BUNDLED.clone();
    scene.lights.clear();
    let mut aligner = Aligner::new(scene);
    let found = aligner.align(&input).unwrap();
    assert_eq!(found.report.discovered.len(), 1, "{:#?}", found.report);
    assert_near(&(found.report.discovered[0], bundled_light()), 0.1, 0.03, 0.05);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    assert_eq!(found.applied_to(&input).lights, found.lights);
    // In another picture it is not searched again.
    let mut again = input.clone();
    again.image = app_core::scene::Image::clone(input.image.rgba()).into();
    let again = aligner.align(&again).unwrap();
    assert_eq!(again.report.discovered, found.report.discovered);
}

#[test]
fn without_a_plate_it_is_found_too() {
    let (mut scene, input) = BUNDLED.clone();
    scene.lights.clear();
    scene.plates.clear();
    let found = Aligner::new(scene).align(&input).unwrap();
    assert_eq!(found.report.discovered.len(), 1, "{:#?}", found.report);
    assert_near(&(found.report.discovered[0], bundled_light()), 0.5, 0.1, 0.2);
}

#[test]
fn without_a_plate_a_wide_sun_is_found_at_no_distance() {
    for azimuth_deg in [-60.0, 30.0, 140.0] {
        let toward = toward(52.0, azimuth_deg);
        let found = discover_without_plate(vec![Lamp::sun(toward, 7.0f64.to_radians(), 0.6)])
            .report
            .discovered;
        let [sun] = found[..] else {
            panic!("{azimuth_deg}: {found:?}");
        };
        let off_rad = sun.direction_in_world.angle_between(toward);
        assert!(off_rad.to_degrees() < 0.5, "{azimuth_deg}: {sun:?}");
        assert!(
            (sun.angular_radius_rad.to_degrees() - 7.0).abs() < 0.5,
            "{azimuth_deg}: {sun:?}"
        );
        assert_eq!(sun.distance_m, None, "{azimuth_deg}: {sun:?}");
    }
}

#[test]
fn without_a_plate_no_lamp_is_found_where_there_is_none() {
    let found = discover_without_plate(Vec::new()).report;
    assert_eq!(found.no_light, Some(NoLight::NoneDominant), "{found:#?}");
}

/// A platform's light estimate, off the bundled bulb by this many degrees.
fn estimated(off_deg: f64) -> LightEstimate {
    let direction = bundled_light().direction_in_world;
    let about = glam::DQuat::from_axis_angle(direction.any_orthonormal_vector(), off_deg.to_radians());
    LightEstimate {
        direction_to_light_in_world: Some(about * direction),
        ..LightEstimate::default()
    }
}

#[test]
fn a_wrong_estimate_changes_nothing_however_often_it_comes() {
    let (mut scene, input) = BUNDLED.clone();
    scene.lights.clear();
    let without = Aligner::new(scene.clone()).align(&input).unwrap();
    let mut told = input.clone();
    told.light_estimate = Some(estimated(40.0));
    let mut aligner = Aligner::new(scene);
    for _ in 0..100 {
        let with = aligner.align(&told).unwrap();
        assert_eq!(with.report, without.report);
        assert_eq!(with.lights, without.lights);
    }
}

#[test]
fn no_lamp_is_found_for_an_estimate_alone() {
    let (mut shot, _) = discover(Vec::new());
    shot.input.light_estimate = Some(estimated(0.0));
    let found = Aligner::new(shot.scene).align(&shot.input).unwrap();
    assert_eq!(found.report.no_light, Some(NoLight::NoneDominant));
    assert_eq!(found.lights, None);
}

#[test]
fn harmonics_point_to_most_of_the_light() {
    let direction = DVec3::new(0.48, 0.6, -0.64);
    let mut harmonics = [0.0; N_HARMONICS];
    for (index, one) in [(1, direction.y), (2, direction.z), (3, direction.x)] {
        harmonics[3 * index..3 * index + 3].fill(one);
    }
    let mut estimate = LightEstimate {
        spherical_harmonics: Some(harmonics),
        ..LightEstimate::default()
    };
    let pointed = estimate.direction_in_world().unwrap();
    assert!(pointed.abs_diff_eq(direction, 1e-12), "{pointed}");
    // The platform's own direction takes precedence over them; an even light has no direction.
    estimate.direction_to_light_in_world = Some(DVec3::Y);
    assert_eq!(estimate.direction_in_world(), Some(DVec3::Y));
    estimate = LightEstimate {
        spherical_harmonics: Some([0.0; N_HARMONICS]),
        ..LightEstimate::default()
    };
    assert_eq!(estimate.direction_in_world(), None);
}

#[test]
fn no_light_is_found_by_a_toy_that_is_not_there() {
    let (mut scene, mut input) = BUNDLED.clone();
    scene.lights.clear();
    input.image = Arc::clone(&scene.plates[0].image).into();
    let found = Aligner::new(scene).align(&input).unwrap();
    assert_eq!(
        found.report.no_light,
        Some(NoLight::PoseUnknown),
        "{:#?}",
        found.report
    );
    assert_eq!(found.lights, None);
}
