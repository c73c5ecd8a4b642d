//! Captures that are good, and captures that are each wrong in one way.

mod document;
mod folder;
mod follows;
mod lens;
mod parts;
mod records;
mod schema;
mod turned;

use std::sync::Arc;
use std::sync::atomic::Ordering;

use app_core::scene::{Light, Pose, Surface};
use app_core::session::{Capture, GroundTruth, Session};
use image::{DynamicImage, ImageFormat};
use serde_json::{Value, json};

use parts::{IDENTITY, Parts, encode, good_index, toy_glb};

#[test]
fn a_good_capture_is_read_as_written() {
    let (memory, n_reads) = Parts::good().into_memory();
    let capture = Capture::open(memory).unwrap();
    let scene = capture.scene();
    assert_eq!(
        (scene.name.as_str(), scene.width_px, scene.height_px),
        ("tiny", 2, 2)
    );
    assert_eq!(
        scene.world_from_object.transform_point3(glam::DVec3::X),
        glam::dvec3(1.0, 2.0, 2.5)
    );
    assert_eq!(scene.receivers[0].half_extent_m, glam::dvec2(1.5, 2.5));
    assert_eq!(scene.receivers[0].surface, Surface::Textured);
    assert_eq!(
        scene.lights[1],
        Light::Directional {
            direction_to_light_in_world: glam::DVec3::Y,
            angular_radius_rad: std::f64::consts::FRAC_PI_4,
        }
    );
    assert_eq!(scene.plates[0].image.rgba8, [0, 0, 0, 255].repeat(4));
    let probe = scene.probe.as_ref().unwrap();
    assert_eq!(probe.pictures.len(), 2);
    assert_eq!(probe.pictures[0].exposure_ratio, 0.125);
    assert_eq!(probe.pictures[1].exposure_ratio, 0.25);
    let cameras = [0, 1].map(|index| probe.pictures[index].camera.intrinsics.fx_px);
    assert_eq!(cameras, [2.0, 2.5], "of the first frame, and its own");
    assert_eq!(
        probe.pictures[1].world_from_probe,
        probe.pictures[0].world_from_probe
    );

    let before = n_reads.load(Ordering::Relaxed);
    let (first, second) = (capture.frame(0).unwrap(), capture.frame(1).unwrap());
    assert!(
        Arc::ptr_eq(&first.image, &second.image),
        "a repeated picture is shared"
    );
    let n_files = 3;
    assert_eq!(
        n_reads.load(Ordering::Relaxed),
        before + n_files,
        "a picture, depths and people, each read once"
    );
    let depth = first.depth.unwrap();
    assert_eq!((depth.size_px().to_array(), depth.known()), ([4, 4], 0.0));
    assert!(second.depth.is_none());
    let people = first.people.unwrap();
    assert_eq!((people.size_px().to_array(), people.has_any()), ([4, 4], false));
    assert!(second.people.is_none());
    assert_eq!(first.light_estimate, None);
    let estimate = second.light_estimate.unwrap();
    assert_eq!(estimate.direction_to_light_in_world, Some(glam::DVec3::Y));
    assert_eq!(estimate.color_temperature_k, Some(5600.0));
    assert_eq!(time_in_clip(&first.shown_pose), Some(0.25));
    assert_eq!((second.time_secs, second.shown_pose), (0.1, Pose::Authored));
    assert!(capture.warnings().is_empty() && first.warnings.is_empty());
    assert_eq!(
        capture.truth(0).unwrap().unwrap().mask.rgba8,
        [0; 16],
        "a mask keeps its alpha"
    );
    assert!(capture.truth(1).unwrap().is_none());
    assert!(capture.frame(2).unwrap_err().to_string().contains("frames[2]"));
}

#[test]
fn what_is_optional_may_be_missing() {
    let mut parts = Parts::good();
    for key in ["lights", "backgrounds", "probe"] {
        parts.index.as_object_mut().unwrap().remove(key);
    }
    let capture = parts.open().unwrap();
    assert!(capture.scene().lights.is_empty() && capture.scene().plates.is_empty());
}

#[test]
fn a_picture_larger_than_a_still_is_refused_before_any_is_read() {
    for (width, height, is_too_large) in [(7680, 4320, true), (4097, 3072, true), (4032, 3024, false)] {
        let mut parts = Parts::good();
        parts.set("width", json!(width));
        parts.set("height", json!(height));
        let Err(error) = parts.open() else {
            panic!("the pictures are of another size");
        };
        let error = error.to_string();
        let limit = "more than the 12582912 pixels that a picture may have";
        assert_eq!(
            error.contains("(width, height)") && error.contains(limit),
            is_too_large,
            "{error}"
        );
    }
}

fn time_in_clip(pose: &Pose) -> Option<f64> {
    match pose {
        Pose::Clip { time_secs, .. } => Some(*time_secs),
        _ => None,
    }
}

#[test]
fn a_frame_brings_what_a_live_camera_changes() {
    let capture = Parts::good().open().unwrap();
    let (first, second) = (capture.frame(0).unwrap(), capture.frame(1).unwrap());
    assert_eq!(
        [first.camera, second.camera].map(|camera| camera.intrinsics.fx_px),
        [2.0, 2.5]
    );
    assert_eq!(capture.scene().plates[0].camera, second.camera);
    assert_eq!([first.exposure, second.exposure], [1.0, 0.5]);
    assert_eq!(first.world_from_object, capture.scene().world_from_object);
    assert_eq!(second.world_from_object.w_axis.x, 0.25);
    let [of_first, of_second] = [first.world_from_shown, second.world_from_shown];
    assert_eq!(
        (of_first, of_second.map(|place| place.w_axis.x)),
        (None, Some(0.5))
    );
}

#[test]
fn a_time_beyond_its_clip_is_clamped_and_said() {
    let mut parts = Parts::good();
    parts.set("frames[0].animation.time", json!(7.5));
    parts.set("toy.physical_pose", json!({"clip": "Wave", "time": 3.0}));
    let capture = parts.open().unwrap();
    let frame = capture.frame(0).unwrap();
    assert_eq!(
        (time_in_clip(&frame.shown_pose), frame.warnings.len()),
        (Some(1.0), 1)
    );
    let text = frame.warnings[0].to_string();
    assert!(
        text.contains("capture.json (frames[0].animation.time): 7.5 s is beyond"),
        "{text}"
    );
    let physical_pose = &capture.scene().physical_pose;
    assert_eq!(
        (time_in_clip(physical_pose), capture.warnings().len()),
        (Some(1.0), 1)
    );
}

#[test]
fn each_wrong_value_is_named() {
    let with = |at: usize, value: Value| {
        let mut matrix = json!(IDENTITY);
        matrix[at] = value;
        matrix
    };
    let plate = &good_index()["backgrounds"][0];
    #[rustfmt::skip] // One case a line.
    let cases = [
        ("format", json!("shadow-movie"), "only \"shadow-capture\" can be read"),
        ("version", json!(2), "only version 1 is"),
        ("encoding", json!("linear"), "expected `srgb`"),
        ("width", json!(0), "0 is not from 1 to 16384"),
        ("width", json!(-2), "expected u32"),
        ("height", json!(1.5e308), "`1.5e+308`, expected u32"),
        ("height", json!(16385), "16385 is not from 1 to 16384"),
        ("intrinsics.fx", json!(0), "0 is not from"),
        ("intrinsics.cy", json!(null), "expected f64"),
        ("toy.file", json!("/etc/toy.glb"), "absolute"),
        ("toy.world_from_object", with(0, json!(0.9)), "scales its axes differently"),
        ("toy.world_from_object", with(3, json!(0.1)), "not affine"),
        ("toy.physical_pose.clip", json!("Wafe"), "none is called \"Wafe\"; it has Wave"),
        ("receivers", json!([]), "empty"),
        ("receivers[0].half_extent[1]", json!(0), "0 is not from"),
        ("receivers[0].world_from_plane", with(5, json!(-1)), "mirrors"),
        ("lights[0].kind", json!("laser"), "unknown variant `laser`"),
        ("lights[0].radius", json!(-0.1), "-0.1 is not from 0"),
        ("lights[0].position", json!(null), "missing"),
        ("lights[1].direction_to_light", json!([0, 0, 0]), "too short"),
        ("lights[1].angular_radius_deg", json!(90), "90 is not from 0"),
        ("frames", json!([]), "empty"),
        ("frames[0].image", json!("../frame.png"), "`..`"),
        ("frames[0].truth", json!("C:frame.png"), "not portable"),
        ("frames[0].depth", json!("../depth.png"), "`..`"),
        ("frames[0].people", json!("../people.png"), "`..`"),
        ("frames[0].mask", json!("a\\b.png"), "not portable"),
        ("frames[0].world_from_camera", with(0, json!(1.01)), "not rigid"),
        ("frames[0].world_from_camera", with(12, json!(1e300)), "is not from"),
        ("frames[0].world_from_camera", json!([1, 0, 0]), "invalid length 3"),
        ("frames[1].world_from_camera[7]", json!(null), "expected f64"),
        ("frames[1].exposure", json!(0), "0 is not from"),
        ("frames[1].light_estimate.direction_to_light", json!([0, 0, 0]), "too short"),
        ("frames[1].light_estimate.intensity[2]", json!(-1), "-1 is not from 0"),
        ("frames[1].light_estimate.ambient_intensity", json!(-1), "-1 is not from 0"),
        ("frames[1].light_estimate.color_temperature", json!(0), "0 is not from 100"),
        ("frames[1].light_estimate.spherical_harmonics", json!([0, 0, 0]), "invalid length 3"),
        ("frames[1].light_estimate.spherical_harmonics[26]", json!(1e10), "is not from"),
        ("frames[1].intrinsics.fx", json!(-1), "-1 is not from"),
        ("frames[1].world_from_object", with(5, json!(-1)), "mirrors"),
        ("frames[1].world_from_shown", with(5, json!(-1)), "mirrors"),
        ("backgrounds[0].intrinsics.fy", json!(0), "0 is not from"),
        ("backgrounds", json!(vec![plate; 513]), "has 513 entries, but the limit is 512"),
        ("frames[0].animation.clip", json!("Wafe"), "none is called \"Wafe\"; it has Wave"),
        ("frames[0].animation.time", json!(-0.1), "-0.1 s is not from 0 s to"),
        ("probe.focal_length", json!(0), "0 is not from"),
        ("probe.facets[0].at", json!(1.5), "1.5 is not from"),
        ("probe.pictures[0].exposure_ratio", json!(2), "2 is not from"),
        ("probe.exposure_ratio", json!(0), "0 is not from"),
        ("place_mesh.deviation", json!(-1), "-1 is not from 0"),
        ("place_mesh.file", json!("../place.glb"), "`..`"),
        ("uncertainty.toy.position", json!(-1), "-1 is not from 0"),
        ("uncertainty.camera.rotation_deg", json!(181), "181 is not from 0 to 180"),
        ("uncertainty.lights.size_ratio", json!(0.5), "0.5 is not from 1 to 1000"),
    ];
    for (field, value, reason) in cases {
        let mut parts = Parts::good();
        parts.set(field, value);
        expect_error(parts, "capture.json", field, reason);
    }
}

#[test]
fn each_damaged_file_is_named() {
    let good = Parts::good().files;
    let cut = |name: &str, n_bytes: usize| Some(good[name][..good[name].len() - n_bytes].to_vec());
    let png = |image: DynamicImage| Some(encode(&image, ImageFormat::Png));
    let with_size = |side_px: u32| {
        let mut bytes = good["frame.png"].clone();
        bytes[16..24].copy_from_slice(&[side_px.to_be_bytes(), side_px.to_be_bytes()].concat());
        let crc = crc32fast::hash(&bytes[12..29]).to_be_bytes();
        bytes[29..33].copy_from_slice(&crc);
        Some(bytes)
    };
    #[rustfmt::skip] // One case a line.
    let cases = [
        ("frame.png", "frames[0].image", None, "does not exist"),
        ("frame.png", "frames[0].image", cut("frame.png", 20), "damaged"),
        ("frame.png", "frames[0].image", png(DynamicImage::new_rgb8(3, 2)), "3 x 2 px, but the session's is 2 x 2"),
        ("frame.png", "frames[0].image", with_size(100_000), "100000 x 100000 px"),
        ("frame.png", "frames[0].image", Some(b"GIF89a".to_vec()), "the picture is GIF, and only PNG and JPEG are read"),
        ("frame.png", "frames[0].image", Some(b"\0\0\0\x18ftypheic".to_vec()), "the picture is HEIC"),
        ("frame.png", "frames[0].image", Some(b"whatever".to_vec()), "neither PNG nor JPEG"),
        ("mask.png", "frames[0].mask", png(DynamicImage::new_rgb8(2, 2)), "not an 8-bit RGBA picture"),
        ("depth.png", "frames[0].depth", None, "does not exist"),
        ("depth.png", "frames[0].depth", png(DynamicImage::new_luma8(2, 2)), "not a grey PNG of 16 bits"),
        ("depth.png", "frames[0].depth", png(DynamicImage::new_luma16(4, 2)), "not the shape of the session's pictures, 2 x 2 px"),
        ("depth.png", "frames[0].depth", cut("depth.png", 20), "damaged"),
        ("people.png", "frames[0].people", None, "does not exist"),
        ("people.png", "frames[0].people", png(DynamicImage::new_luma16(2, 2)), "not a grey PNG of 8 bits"),
        ("people.png", "frames[0].people", png(DynamicImage::new_luma8(4, 2)), "not the shape of the session's pictures, 2 x 2 px"),
        ("people.png", "frames[0].people", cut("people.png", 20), "damaged"),
        ("plate.jpg", "backgrounds[0].image", None, "does not exist"),
        ("plate.jpg", "backgrounds[0].image", cut("plate.jpg", 4), "cut short"),
        ("place.glb", "place_mesh.file", None, "does not exist"),
        ("place.glb", "place_mesh.file", cut("place.glb", 20), "not binary glTF"),
        ("place.glb", "place_mesh.file", Some(toy_glb(false)), "triangle"),
        ("toy.glb", "toy.file", None, "does not exist"),
        ("toy.glb", "toy.file", cut("toy.glb", 20), "not binary glTF"),
        ("toy.glb", "toy.file", Some(toy_glb(false)), "triangle"),
    ];
    for (file, field, bytes, reason) in cases {
        let mut parts = Parts::good();
        parts.index.as_object_mut().unwrap().remove("probe");
        match bytes {
            Some(bytes) => drop(parts.files.insert(file.to_owned(), bytes)),
            None => drop(parts.files.remove(file)),
        }
        expect_error(parts, file, field, reason);
    }
}

/// The check of the pictures' headers reports other kinds in the same way as decoding.
#[test]
fn heads_of_other_kinds_are_named() {
    let mut parts = Parts::good();
    parts.index.as_object_mut().unwrap().remove("probe");
    parts
        .files
        .insert("frame.png".to_owned(), b"\0\0\0\x18ftypheic".to_vec());
    let error = parts
        .open()
        .unwrap()
        .check_pictures(0..1)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("frame.png (frames[0].image): the picture is HEIC"),
        "{error}"
    );
}

#[test]
fn json_that_is_cut_or_not_json_is_named() {
    let text = good_index().to_string();
    let with_fx = |fx: &str| text.replace("\"fx\":2.0", &format!("\"fx\":{fx}"));
    #[rustfmt::skip] // One case a line.
    let cases = [
        (text[..text.find("2.0,\"fy\"").unwrap()].to_owned(), "intrinsics.fx", "EOF"),
        (format!("{text}x"), "the whole file", "trailing characters"),
        (with_fx("1e999"), "intrinsics.fx", "number out of range"),
        (with_fx("NaN"), "intrinsics.fx", "expected value"),
        (String::new(), "the whole file", "EOF"),
    ];
    for (text, field, reason) in cases {
        let parts = Parts {
            raw_index: Some(text.into_bytes()),
            ..Parts::good()
        };
        expect_error(parts, "capture.json", field, reason);
    }
}

/// Reads all of a spoilt capture, and expects one error with file, field and reason.
fn expect_error(parts: Parts, file: &str, field: &str, reason: &str) {
    let error = parts
        .read_all()
        .expect_err(&format!("{file} ({field}): {reason}"));
    let text = error.to_string();
    assert!(
        text.starts_with(&format!("{file} ({field}): ")),
        "{file} and {field} should be named: {text}"
    );
    assert!(text.contains(reason), "{reason:?} should be given: {text}");
}
