//! The output of `check` for a good session and for wrong ones, and the correction of these by
//! `align`.

mod index;
mod pictures;

use std::fs;
use std::path::Path;

use app_core::alignment::LightAlignment;
use app_core::scene::{Camera, Light};
use app_core::session::{Capture, Session};
use desk::alignment::{Alignments, Asked, Lights, Ratio, Source};
use desk::check::aligned_session::{self, Assumed};
use desk::check::{check, is_as_listed};
use desk::files::{BUNDLED_SESSION, Folder, SESSION_FILE};
use desk::stored::Stored;
use glam::{DMat4, DVec3};
use harness::bundled_session;
use harness::session_format::example;
use harness::temporary::Temporary;
use serde_json::{Value, json};

/// The bundled session with a changed index.
pub(crate) fn changed(name: &str, change: impl Fn(&mut Value)) -> Temporary {
    let folder = Temporary::new(name);
    for entry in fs::read_dir(BUNDLED_SESSION).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.0.join(path.file_name().unwrap())).unwrap();
    }
    let index = folder.0.join("capture.json");
    let mut value: Value = serde_json::from_str(&fs::read_to_string(&index).unwrap()).unwrap();
    change(&mut value);
    fs::write(&index, value.to_string()).unwrap();
    folder
}

fn wrong(session: &Path) -> Vec<String> {
    let out = Temporary::new("drawing");
    check(session, &out.0, (Asked::default(), Source::Given))
        .unwrap()
        .wrong
}

fn matrix(value: &Value) -> DMat4 {
    let columns: Vec<f64> = value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect();
    DMat4::from_cols_slice(&columns)
}

fn off(index: &mut Value) {
    let object = &mut index["toy"]["world_from_object"];
    let moved = DMat4::from_translation(DVec3::new(0.003, 0.001, -0.002)) * matrix(object);
    *object = json!(moved.to_cols_array());
}

#[test]
fn a_good_session_has_nothing_wrong_and_is_drawn() {
    let out = Temporary::new("good");
    let findings = check(
        Path::new(BUNDLED_SESSION),
        &out.0,
        (Asked::default(), Source::Given),
    )
    .unwrap();
    assert_eq!(findings.wrong, Vec::<String>::new());
    let drawing = image::open(findings.drawing.unwrap()).unwrap().into_rgba8();
    let greens = drawing
        .pixels()
        .filter(|pixel| pixel.0 == [40, 255, 60, 255])
        .count();
    assert!(greens > 400, "{greens} pixels of outlines");
}

#[test]
fn a_toy_that_lies_on_its_back_is_offered_the_turn() {
    let upright = json!([1.0]);
    let given = std::cell::RefCell::new(upright);
    let lying = changed("lying", |index| {
        let object = &mut index["toy"]["world_from_object"];
        *given.borrow_mut() = object.clone();
        // This corresponds to a file with Z up.
        *object =
            json!((matrix(object) * DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2)).to_cols_array());
    });
    let wrong = wrong(&lying.0);
    let offer = wrong
        .iter()
        .find(|wrong| wrong.contains("Z up"))
        .expect("an offer");
    let (_, numbers) = offer.split_once("toy.world_from_object [").expect("a matrix");
    let (numbers, _) = numbers.split_once(']').expect("a matrix");
    let numbers: Vec<f64> = numbers
        .split(", ")
        .map(|number| number.parse().unwrap())
        .collect();
    let upright = matrix(&given.into_inner());
    assert!(
        DMat4::from_cols_slice(&numbers).abs_diff_eq(upright, 1e-5),
        "{offer}"
    );
}

#[test]
fn each_wrong_session_is_told_by_its_field() {
    type Change = fn(&mut Value);
    #[rustfmt::skip] // One case a line.
    let cases: [(&str, Change, &str); 9] = [
        ("key", |index| index["toy"]["scale"] = json!(2.0), "capture.json (toy.scale)"),
        (
            "millimetres",
            |index| {
                let object = &mut index["toy"]["world_from_object"];
                *object = json!((matrix(object) * DMat4::from_scale(DVec3::splat(1e3))).to_cols_array());
            },
            "lengths are in metres",
        ),
        (
            "convention",
            |index| {
                for frame in index["frames"].as_array_mut().unwrap() {
                    let camera = matrix(&frame["world_from_camera"]);
                    frame["world_from_camera"] =
                        json!((camera * DMat4::from_rotation_y(3.1)).to_cols_array());
                }
            },
            "the toy is behind the camera",
        ),
        (
            "cameras",
            |index| {
                for list in ["frames", "backgrounds"] {
                    for entry in index[list].as_array_mut().unwrap() {
                        for axis in 12..15 {
                            let metres = entry["world_from_camera"][axis].as_f64().unwrap();
                            entry["world_from_camera"][axis] = json!(1e3 * metres);
                        }
                    }
                }
            },
            "lengths are in metres: if it is given in millimetres, multiply its last column by 0.001",
        ),
        ("bulb", |index| index["lights"][0]["radius"] = json!(50.0), "lights[0].radius: the bulb's radius is 50 m, but its middle is only"),
        ("exposure", |index| index["frames"][0]["exposure"] = json!(4.0), "frames[0].exposure: an exposure of 4 is stated, but the picture is"),
        ("light", |index| index["lights"][0]["position"][1] = json!(-1.0), "lights[0]: it is not above any receiver"),
        ("file", |index| index["frames"][1]["image"] = json!("gone.png"), "gone.png"),
        ("pose", off, "toy.world_from_object: the outline is"),
    ];
    for (name, change, expected) in cases {
        let session = changed(name, change);
        let wrong = wrong(&session.0);
        assert!(
            wrong.iter().any(|line| line.contains(expected)),
            "{name}: {wrong:?}"
        );
    }
}

#[test]
fn a_grey_frame_of_a_coloured_place_is_told() {
    let session = changed("grey", |_| {});
    let path = session.0.join("frame_0000.png");
    let grey = image::open(&path).unwrap().into_luma8();
    grey.save(&path).unwrap();
    let expected = "frames[0].image: the picture is grey, but a plate has colours";
    let is_reported = |wrong: Vec<String>| wrong.iter().any(|line| line.starts_with(expected));
    assert!(is_reported(wrong(&session.0)));
    // Two grey pictures belong to the same camera.
    let plate = session.0.join("background_0000.png");
    image::open(&plate).unwrap().into_luma8().save(&plate).unwrap();
    assert!(!is_reported(wrong(&session.0)));
}

/// Keys that are reported as unknown in an index without files.
fn unknown(index: &Value) -> Vec<String> {
    let session = Temporary::new("keys");
    fs::write(session.0.join(SESSION_FILE), index.to_string()).unwrap();
    let mut wrong = wrong(&session.0);
    wrong.retain(|line| line.ends_with("the key is not known"));
    wrong
}

/// Inserts a key into each object of a value; returns the positions.
fn misspell(value: &mut Value, path: &str) -> Vec<String> {
    match value {
        Value::Object(entries) => {
            let below = |key: &str| format!("{path}{}{key}", if path.is_empty() { "" } else { "." });
            let mut places: Vec<String> = entries
                .iter_mut()
                .flat_map(|(key, value)| misspell(value, &below(key)))
                .collect();
            places.push(below("misspelt"));
            entries.insert("misspelt".to_owned(), json!({ "any": 1 }));
            places
        }
        Value::Array(entries) => {
            let entries = entries.iter_mut().enumerate();
            entries
                .flat_map(|(index, value)| misspell(value, &format!("{path}[{index}]")))
                .collect()
        }
        _ => Vec::new(),
    }
}

/// The example of the document has every key that the reader has.
#[test]
fn every_key_of_the_format_is_known_and_no_other() {
    let mut index: Value = serde_json::from_str(example().unwrap()).unwrap();
    assert_eq!(unknown(&index), Vec::<String>::new());
    let mut expected: Vec<String> = misspell(&mut index, "")
        .iter()
        .map(|place| format!("{SESSION_FILE} ({place}): the key is not known"))
        .collect();
    let mut told = unknown(&index);
    told.sort();
    expected.sort();
    assert!(expected.len() > 10, "{expected:?}");
    assert_eq!(told, expected);
}

/// Focal lengths of the session, of the plates and of the frames.
#[test]
fn an_aligned_session_has_the_focal_length_that_was_found() {
    let lengthen = |index: &mut Value, ratio: f64| {
        for key in ["fx", "fy"] {
            index["intrinsics"][key] = json!(ratio * index["intrinsics"][key].as_f64().unwrap());
        }
        index["frames"][1]["intrinsics"] = index["intrinsics"].clone();
    };
    let recorded = changed("recorded", |index| lengthen(index, 1.0));
    let session = changed("focal", |index| lengthen(index, 1.01));
    let parent = Temporary::new("focal-aligned");
    let out = parent.0.join("session");
    let capture = Capture::open(Folder::open(&session.0).unwrap()).unwrap();
    let asked = Asked {
        ratio: Ratio::FocalLength,
        ..Asked::default()
    };
    let alignments = Alignments::find(&capture, 0..1, asked).unwrap();
    aligned_session::write(
        &Stored::open(&session.0).unwrap(),
        &out,
        &alignments,
        Assumed::Omitted,
    )
    .unwrap();
    let cameras = [&recorded.0, &session.0, &out].map(|folder| {
        let capture = Capture::open(Folder::open(folder).unwrap()).unwrap();
        let frames = [0, 1].map(|index| capture.frame(index).unwrap().camera);
        [frames[0], frames[1], capture.scene().plates[0].camera]
    });
    let [recorded, given, written] = cameras;
    for place in 0..3 {
        let ratio = |camera: &Camera| camera.intrinsics.fx_px / recorded[place].intrinsics.fx_px;
        assert!((ratio(&given[place]) - 1.01).abs() < 1e-9);
        assert!((ratio(&written[place]) - 1.0).abs() < 1e-3, "{written:?}");
    }
    assert!(wrong(&out).is_empty());
}

#[test]
fn an_aligned_session_has_the_lights_that_were_found() {
    // A sun in the list, while the shadow is a bulb's.
    let session = changed("sun", |index| {
        index["lights"] = json!([{ "kind": "directional", "direction_to_light": [0.0, 1.0, 0.0], "angular_radius_deg": 1.0 }]);
    });
    let parent = Temporary::new("lights-found");
    let out = parent.0.join("session");
    let capture = Capture::open(Folder::open(&session.0).unwrap()).unwrap();
    let asked = Asked {
        lights: Lights::Found,
        ..Asked::default()
    };
    let alignments = Alignments::find(&capture, 0..1, asked).unwrap();
    aligned_session::write(
        &Stored::open(&session.0).unwrap(),
        &out,
        &alignments,
        Assumed::Omitted,
    )
    .unwrap();
    assert_eq!(wrong(&out), Vec::<String>::new());
    let bulb = bundled_session();
    let found = Capture::open(Folder::open(&out).unwrap()).unwrap();
    let place = |capture: &Capture| match *capture.scene().lights {
        [
            Light::Sphere {
                position_in_world, ..
            },
        ] => position_in_world,
        ref other => panic!("not one bulb: {other:?}"),
    };
    let off_rad = place(&bulb).angle_between(place(&found));
    assert!(off_rad.to_degrees() < 0.5, "{} degrees", off_rad.to_degrees());
    // None of the sun's own keys is left.
    let index: Value = serde_json::from_slice(&fs::read(out.join(SESSION_FILE)).unwrap()).unwrap();
    assert!(index["lights"][0].get("direction_to_light").is_none());
}

/// A lamp that is listed some millimetres off is found elsewhere, which is no mistake of the list.
#[test]
fn a_lamp_listed_as_well_as_it_can_be_measured_is_not_wrong() {
    let told = |off_m: f64| {
        let session = changed("lamp", |index| {
            let x = index["lights"][0]["position"][0].as_f64().unwrap();
            index["lights"][0]["position"][0] = json!(x + off_m);
        });
        let out = Temporary::new("drawing");
        check(&session.0, &out.0, (Asked::default(), Source::Given)).unwrap()
    };
    let is_light = |line: &&String| line.starts_with("lights[0]: the estimate from its shadow");
    let slightly = told(0.005);
    assert_eq!(slightly.wrong, Vec::<String>::new());
    assert_eq!(slightly.facts.iter().filter(is_light).count(), 1, "{slightly:?}");
    let clearly = told(0.03);
    assert_eq!(clearly.wrong.iter().filter(is_light).count(), 1, "{clearly:?}");
}

/// A turn that is visible makes no mistake of a small lamp's size, which is not.
#[test]
fn a_size_that_does_not_differ_visibly_is_as_listed() {
    let light = LightAlignment {
        is_applied: true,
        is_moved: true,
        turned_rad: 0.1_f64.to_radians(),
        distance_ratio: 1.0,
        size_ratio: Some(1.2),
        is_resized: false,
        deviation_rad: 1e-4,
    };
    assert!(is_as_listed(&light));
    for wrong in [
        LightAlignment {
            is_resized: true,
            ..light
        },
        LightAlignment {
            turned_rad: 0.6_f64.to_radians(),
            ..light
        },
        LightAlignment {
            distance_ratio: 1.2,
            ..light
        },
    ] {
        assert!(!is_as_listed(&wrong), "{wrong:?}");
    }
}

#[test]
fn an_aligned_session_is_right() {
    let session = changed("align", |index| {
        off(index);
        index["lights"][0]["position"][0] = json!(index["lights"][0]["position"][0].as_f64().unwrap() + 0.1);
    });
    let parent = Temporary::new("aligned");
    let out = parent.0.join("session");
    let capture = Capture::open(Folder::open(&session.0).unwrap()).unwrap();
    let alignments = Alignments::find(&capture, 0..capture.n_frames(), Asked::default()).unwrap();
    assert_eq!(
        aligned_session::write(
            &Stored::open(&session.0).unwrap(),
            &out,
            &alignments,
            Assumed::Omitted
        )
        .unwrap(),
        capture.n_frames()
    );
    assert_eq!(wrong(&out), Vec::<String>::new());
    // Nothing is overwritten, and nothing is written into the session that is read.
    let inside = session.0.join("inside");
    assert!(
        aligned_session::write(
            &Stored::open(&session.0).unwrap(),
            &inside,
            &alignments,
            Assumed::Omitted
        )
        .is_err()
    );
    assert!(!inside.exists());
    assert!(
        aligned_session::write(
            &Stored::open(&session.0).unwrap(),
            &out,
            &alignments,
            Assumed::Omitted
        )
        .is_err()
    );
}
