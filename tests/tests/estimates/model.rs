//! After alignment, a model that differs slightly from the toy has the toy's outline.

use std::sync::Arc;

use app_core::alignment::{Aligner, AlignmentWarning};
use app_core::scene::Scene;
use app_core::toy::{Pose, PosedMesh, Toy};
use glam::{DMat4, DVec3};

use crate::bundled::SESSION;
use crate::softness::{UPRIGHT_PX, moved};

/// Amplitude and length of the waves on the model, in metres.
const WAVE_M: f64 = 6e-4;
const WAVE_LENGTH_M: f64 = 0.025;

fn positions(toy: &Toy, pose: &Pose) -> Vec<DVec3> {
    let mut posed = PosedMesh::default();
    toy.pose(pose, &DMat4::IDENTITY, &mut posed).unwrap();
    posed.points().collect()
}

/// Displacement of a point of the toy's surface.
fn wave(point: DVec3) -> DVec3 {
    let turns = point * (std::f64::consts::TAU / WAVE_LENGTH_M);
    WAVE_M
        * DVec3::new(
            (turns.y + 1.0).sin(),
            (turns.z + 2.0).sin(),
            (turns.x + turns.y).sin(),
        )
}

/// The bundled scene with a model that is deformed by waves, so many times as high.
pub(crate) fn wavy(times: f64) -> Scene {
    let scene = SESSION.0.clone();
    let points = positions(&scene.toy, &scene.physical_pose).into_iter();
    let displacements: Vec<DVec3> = points.map(|point| times * wave(point)).collect();
    let toy = scene.toy.displaced(&scene.physical_pose, &displacements);
    scene.with_toy(Arc::new(toy.unwrap()))
}

#[test]
fn a_displaced_toy_is_displaced_in_every_pose() {
    let (scene, pose) = (&SESSION.0, &SESSION.0.physical_pose);
    let displaced = wavy(1.0).toy;
    let pairs = positions(&scene.toy, pose)
        .into_iter()
        .zip(positions(&displaced, pose));
    for (before, after) in pairs {
        assert!((after - before - wave(before)).length() < 1e-6);
    }
    let clip = scene.toy.clip_ids().next().unwrap();
    let moved = Pose::Clip { clip, time_secs: 1.0 };
    let pairs = positions(&scene.toy, &moved)
        .into_iter()
        .zip(positions(&displaced, &moved));
    for ((before, after), at_rest) in pairs.zip(positions(&scene.toy, pose)) {
        // Joints turn it, and a mean of several of them shortens it.
        let (length_m, of_wave_m) = ((after - before).length(), wave(at_rest).length());
        assert!(length_m < of_wave_m + 1e-6 && length_m > 0.7 * of_wave_m - 1e-6);
    }
    assert_eq!(displaced.first_alike(), scene.toy.first_alike());
    assert_eq!(displaced.shadow_indices(), scene.toy.shadow_indices());
}

#[test]
fn a_model_that_is_off_has_the_toys_outline() {
    let input = &SESSION.1;
    let scene = wavy(1.0);
    let mut aligner = Aligner::new(scene.clone());
    let found = aligner.align(input).unwrap();
    let model = found.report.model.unwrap();
    assert!(model.outlines_px[1] < 0.75 * model.outlines_px[0], "{model:?}");
    assert!(
        model.displaced_m < WAVE_M && model.most_displaced_m < 3.0 * WAVE_M,
        "{model:?}"
    );
    let is_reported = |warning: &AlignmentWarning| matches!(warning, AlignmentWarning::ModelDiffers { displaced_m, .. } if *displaced_m == Some(model.displaced_m));
    assert!(found.warnings.iter().any(is_reported), "{:?}", found.warnings);

    // The displaced surface is nearer to the toy's own, along the displacement.
    let adapted = &found.scene.unwrap().toy;
    let pose = &scene.physical_pose;
    let (given, truth) = (positions(&scene.toy, pose), positions(&SESSION.0.toy, pose));
    let mut squares = [0.0; 2];
    for ((given, truth), adapted) in given.iter().zip(truth).zip(positions(adapted, pose)) {
        if let Some(along) = (adapted - *given)
            .try_normalize()
            .filter(|_| (adapted - *given).length() > 1e-4)
        {
            squares[0] += (truth - *given).dot(along).powi(2);
            squares[1] += (truth - adapted).dot(along).powi(2);
        }
    }
    assert!(squares[1] < 0.75 * squares[0], "{squares:?}");

    // The next picture is aligned with the result unchanged.
    let again = aligner.align(input).unwrap();
    assert!(again.scene.is_none() && again.report == found.report);
}

#[test]
fn an_exact_model_stays() {
    let (scene, input) = &*SESSION;
    let mut aligner = Aligner::new(scene.clone());
    let found = aligner.align(input).unwrap();
    assert_eq!(found.report.model, None);
    assert!(Arc::ptr_eq(&aligner.scene().toy, &scene.toy));
}

/// The model's outline is a pixel or two away from the toy's all around, in every pose.
#[test]
fn a_toy_is_found_with_a_poor_model() {
    const OFF_M: f64 = 5e-3;
    let mut input = SESSION.1.clone();
    let exact = input.world_from_object;
    input.world_from_object = DMat4::from_translation(DVec3::X * OFF_M) * exact;
    let mut aligner = Aligner::new(wavy(4.0));
    let found = aligner.align(&input).unwrap();
    let off_m = (found.world_from_object.w_axis - exact.w_axis)
        .truncate()
        .length();
    assert!(found.report.pose.unwrap().is_applied, "{:?}", found.report.pose);
    assert!(off_m < 0.5 * OFF_M, "{off_m}");
}

/// An outline that a motion blurs is compared with one of a round blur, which tells nothing of the model.
#[test]
fn a_motion_tells_of_no_other_model() {
    let input = &SESSION.1;
    let input = input.clone().with_image(moved(input.image.rgba(), UPRIGHT_PX));
    let found = Aligner::new(wavy(2.0)).align(&input).unwrap();
    assert!(!found.report.pose.unwrap().is_of_model, "no difference is seen");
    assert_eq!(found.report.model, None);
    let blames = |warning: &AlignmentWarning| matches!(warning, AlignmentWarning::ModelDiffers { .. });
    assert!(!found.warnings.iter().any(blames), "{:?}", found.warnings);
}
