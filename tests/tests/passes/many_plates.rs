//! Exposures of many plates, which are matched although few pairs are compared.

use std::f64::consts::TAU;
use std::sync::Arc;

use app_core::core::CoreError;
use app_core::preset::Preset;
use app_core::scene::{FieldError, Image, InputError, MAX_SCENE_PLATES, Plate, Scene};
use app_pipeline::plates::exposure::match_plates;
use app_pipeline::plates::overlap::compared_plates;
use glam::{DMat4, DVec3};

use crate::cores::any_core;
use crate::photo::Photo;
use crate::plates::{HERE, SETUP, flat, turned};
use crate::run::{plate_of, scene};
use crate::stand::Stand;

/// Relative error of a gain: as with three plates.
const MAX_OFF: f64 = 0.005;

/// A camera of `n` around the toy.
fn around(index: usize, n: usize) -> Stand {
    let angle_rad = TAU * index as f64 / n as f64;
    Stand::seen_from(SETUP, DMat4::from_rotation_y(angle_rad).transform_vector3(HERE))
}

/// Exposure and white balance of a plate: 1 for the first, and up to a factor of two either way.
fn gain(index: usize) -> DVec3 {
    let angle_rad = 2.1 * index as f64;
    DVec3::new(1.0, 0.7, -0.8).map(|scale| (scale * angle_rad.sin()).exp2())
}

fn scene_with(plates: Vec<Plate>) -> (Stand, Scene) {
    let stand = Stand::seen_from(SETUP, HERE);
    let scene = scene(&stand, &flat(128)).with_plates(plates);
    (stand, scene)
}

/// Relative error of the gains of plates with these exposures.
fn off(plates: Vec<Plate>, exposures: &[DVec3]) -> f64 {
    let (stand, scene) = scene_with(plates);
    let gains = match_plates(&scene, &stand.anchored);
    assert_eq!(gains.len(), exposures.len());
    let off = gains.iter().zip(exposures);
    off.map(|(gain, exposure)| (*gain * *exposure - 1.0).abs().max_element())
        .fold(0.0, f64::max)
}

#[test]
fn exposures_all_around_the_toy_are_matched() {
    const N: usize = 60;
    let photo = Photo::plain(SETUP.lights.len());
    let plate = |index| {
        let stand = around(index, N);
        plate_of(&stand, &photo.exposed_plate(&stand, gain(index)))
    };
    let exposures: Vec<DVec3> = (0..N).map(gain).collect();
    let off = off((0..N).map(plate).collect(), &exposures);
    eprintln!("{N} plates: off by {off:.4}");
    assert!(off < MAX_OFF, "{off}");
}

/// The first two have no common points, and the plate that connects them comes last.
#[test]
fn exposures_are_matched_by_way_of_a_later_plate() {
    let here = Stand::seen_from(SETUP, HERE);
    let photo = Photo::plain(SETUP.lights.len());
    let exposures = [0, 1, 2].map(gain);
    let plates = [0.45, -0.45, 0.0].iter().zip(exposures).map(|(left_rad, gain)| {
        let stand = Stand {
            camera: turned(&here.camera, *left_rad),
            ..Stand::seen_from(SETUP, HERE)
        };
        plate_of(&stand, &photo.exposed_plate(&stand, gain))
    });
    let plates: Vec<Plate> = plates.collect();
    let apart = scene_with(plates[..2].to_vec());
    assert_eq!(
        match_plates(&apart.1, &apart.0.anchored),
        [DVec3::ONE; 2],
        "the first two share a view"
    );
    let off = off(plates, &exposures);
    eprintln!("by way of a later plate: off by {off:.4}");
    assert!(off < MAX_OFF, "{off}");
}

/// Plates all around, with the same picture.
fn ring(n: usize, image: &Arc<Image>) -> Vec<Plate> {
    (0..n).map(|index| plate_of(&around(index, n), image)).collect()
}

#[test]
fn pairs_grow_with_the_number_of_plates_and_connect_them_all() {
    for n in [2, 5, 50, 300] {
        let (stand, scene) = scene_with(ring(n, &flat(128)));
        let compared = compared_plates(&scene, &stand.anchored);
        let n_pairs: usize = compared.iter().map(Vec::len).sum();
        // All pairs as long as they are few.
        assert!(
            n_pairs <= 5 * n && n_pairs >= (n - 1) * n.min(5) / 2,
            "{n}: {n_pairs}"
        );
        assert_eq!(n_parts(&compared), 1, "{n}");
    }
    // A plate without any measure of exposure is compared with none.
    let (stand, scene) = scene_with(ring(20, &flat(255)));
    assert_eq!(n_parts(&compared_plates(&scene, &stand.anchored)), 20);
}

/// Number of parts that no pair connects.
fn n_parts(compared: &[Vec<usize>]) -> usize {
    let mut part_of: Vec<usize> = (0..compared.len()).collect();
    for (later, others) in compared.iter().enumerate() {
        for earlier in others {
            let (from, to) = (part_of[later], part_of[*earlier]);
            for part in &mut part_of {
                *part = if *part == from { to } else { *part };
            }
        }
    }
    part_of.sort_unstable();
    part_of.dedup();
    part_of.len()
}

#[test]
fn more_plates_than_are_handled_are_refused_by_name() {
    let plates = vec![plate_of(&around(0, 1), &flat(128)); MAX_SCENE_PLATES + 1];
    let refused = any_core().set_scene(scene_with(plates).1, Preset::Balanced);
    let Err(CoreError::Input(InputError { field, reason })) = refused else {
        panic!("{refused:?}");
    };
    let expected = FieldError::TooMany {
        n: MAX_SCENE_PLATES + 1,
        max: MAX_SCENE_PLATES,
    };
    assert_eq!((field.as_str(), reason), ("plates", expected));
}
