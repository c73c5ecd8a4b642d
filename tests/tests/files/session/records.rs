//! Written records are read back unchanged.

use app_core::scene::Scene;
use app_core::session::record::{CaptureRecord, Index};
use app_core::session::{Capture, ScenePaths, Session};
use harness::session_format::example;
use serde_json::{Value, json};

use crate::session::parts::{Parts, good_index};

/// A scene in text form without its pictures; numbers are rounded to survive two conversions
/// between degrees and radians.
fn told(scene: &Scene) -> String {
    let plates: Vec<_> = scene.plates.iter().map(|plate| plate.camera).collect();
    let probe = scene.probe.as_ref().unwrap();
    let pictures = probe.pictures.iter();
    let pictures: Vec<_> = pictures
        .map(|picture| (picture.camera, picture.world_from_probe, picture.exposure_ratio))
        .collect();
    format!(
        "{:.12?}",
        (
            (&scene.name, scene.width_px, scene.height_px),
            (scene.world_from_object, &scene.physical_pose),
            (&scene.receivers, &scene.lights, plates),
            (&probe.shape, pictures, &scene.uncertainty, &scene.place_mesh),
        )
    )
}

#[test]
fn a_scene_comes_back() {
    let mut index = good_index();
    index["toy"]["physical_pose"] = json!({ "clip": "Wave", "time": 0.25 });
    // A lens has a focal length if no facet is given.
    let mut focal = index.clone();
    focal["probe"]["facets"] = json!([]);
    let mut ball = index.clone();
    ball["probe"]["kind"] = json!("mirror_ball");
    for index in [index, focal, ball] {
        let open = |index: Value| {
            let parts = Parts {
                index,
                ..Parts::good()
            };
            Capture::open(parts.into_memory().0).unwrap()
        };
        let given = open(index.clone());
        let paths = ScenePaths {
            toy: "toy.glb",
            plates: &["plate.jpg".to_owned()],
            probe: &["frame.png", "frame.png"].map(str::to_owned),
            place_mesh: Some("place.glb"),
        };
        let intrinsics = given.frame(0).unwrap().camera.intrinsics;
        let mut record = CaptureRecord::new(given.scene(), &intrinsics, paths);
        record.frames = serde_json::from_value(index["frames"].clone()).unwrap();
        let written = open(json!(Index::from(record)));
        assert_eq!(told(written.scene()), told(given.scene()));
    }
}

#[test]
fn every_key_comes_back() {
    for text in [example().unwrap(), &good_index().to_string()] {
        let given: CaptureRecord = serde_json::from_str(text).unwrap();
        let written = json!(Index::from(given.clone()));
        assert_eq!(written["format"], "shadow-capture");
        let back: CaptureRecord = serde_json::from_value(written).unwrap();
        assert_eq!(back, given);
    }
}
