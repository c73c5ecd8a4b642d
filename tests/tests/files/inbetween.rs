//! In-between frames: the permitted content of a shot, the times of frames, and the quality of a
//! moved photograph.

use app_core::grain::{Grain, Noise};
use app_core::session::Folder;
use film::ease::Ease;
use film::inbetween::blend::{FrameGrain, Mix};
use film::inbetween::light::LightPicture;
use film::inbetween::resample::resampled;
use film::inbetween::shot::Shot;
use film::inbetween::timing::{Rate, moments};
use glam::{DMat3, DVec2};
use reference::grain::grain_at;
use serde_json::{Value, json};

const SESSION: &str = "sessions/llama";

/// File content of a shot of two prints.
fn shot() -> Value {
    let index = std::fs::read(format!("{SESSION}/capture.json")).unwrap();
    let mut index: Value = serde_json::from_slice(&index).unwrap();
    index["format"] = json!("shadow-shot");
    index["lens"] = Value::Null;
    index["keys"] = json!([
        { "image": "truth_0000.png", "time": 0.0, "physical_pose": { "clip": "Look", "time": 0.6 } },
        { "image": "frame_0000.png", "time": 1.0, "nodes": { "head": { "rotation": [0.0, 0.0, 0.0, 1.0] } } },
    ]);
    index
}

#[test]
fn a_bad_shot_is_refused_by_file_field_and_reason() {
    let refused = |path: &str, value: Value| {
        let mut shot = shot();
        *shot.pointer_mut(path).unwrap() = value;
        let text = serde_json::to_vec(&shot).unwrap();
        match Shot::read(&text, Folder::open(SESSION).unwrap()) {
            Ok(_) => String::new(),
            Err(error) => error.to_string(),
        }
    };
    assert_eq!(refused("/keys/0/time", json!(0.5)), "");
    let cases = [
        (
            "/format",
            json!("shadow-capture"),
            ["shot.json", "(format, version)", "shadow-shot"],
        ),
        (
            "/keys/1/time",
            json!(0.0),
            ["shot.json", "(keys[1].time)", "not later"],
        ),
        (
            "/keys/0/physical_pose/clip",
            json!("Jump"),
            ["shot.json", "(keys[0].physical_pose.clip)", "Look"],
        ),
        (
            "/keys/1/nodes",
            json!({ "trunk": {} }),
            ["shot.json", "(keys[1].nodes)", "trunk"],
        ),
        (
            "/keys/0/image",
            json!("../key.png"),
            ["shot.json", "(keys[0].image)", ".."],
        ),
        (
            "/backgrounds",
            json!([]),
            ["shot.json", "(keys[0].world_from_camera)", "plate"],
        ),
        ("/keys", json!([]), ["shot.json", "(keys)", "two or more"]),
        (
            "/keys/0",
            json!({ "image": "truth_0000.png", "time": 0.0, "pose": { "clip": "Look", "time": 0.6 } }),
            ["shot.json", "(keys[0].pose)", "unknown"],
        ),
        (
            "/keys/0",
            json!({ "image": "truth_0000.png", "time": 0.0, "physical_pose": { "time": 0.6 }, "nodes": {} }),
            ["shot.json", "(keys[0])", "both"],
        ),
        (
            "/lens",
            json!({ "k1": -0.05 }),
            ["shot.json", "(lens)", "distortion"],
        ),
    ];
    for (path, value, parts) in cases {
        let said = refused(path, value);
        assert!(parts.iter().all(|part| said.contains(part)), "{path}: {said}");
    }
}

#[test]
fn frames_meet_their_keys_and_pictures_stay_as_long_as_they_are_held() {
    let at = |rate, hold| {
        let moments = moments(&[0.0, 0.5, 2.0], rate, Ease::Linear, hold).unwrap();
        let ways = moments.iter().map(|moment| moment.left as f64 + moment.share);
        ways.collect::<Vec<_>>()
    };
    assert_eq!(at(Rate::Between(1), 1), [0.0, 0.5, 1.0, 1.5, 2.0]);
    let by_time = at(Rate::PerSecond(4.0), 1);
    let expected = [
        0.0,
        0.5,
        1.0,
        7.0 / 6.0,
        8.0 / 6.0,
        1.5,
        10.0 / 6.0,
        11.0 / 6.0,
        2.0,
    ];
    assert!(
        by_time.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9),
        "{by_time:?}"
    );
    assert_eq!(at(Rate::Between(1), 2), [0.0, 0.0, 1.0, 1.0, 2.0]);
    // A hold that does not fit the gap ends at the key.
    assert_eq!(
        at(Rate::Between(3), 3),
        [0.0, 0.0, 0.0, 0.75, 1.0, 1.0, 1.0, 1.75, 2.0]
    );
    let held = at(Rate::PerSecond(4.0), 3);
    assert_eq!([held[0], held[1], held[2], held[8]], [0.0, 0.0, 1.0, 2.0]);
    assert!(moments(&[0.0, 1e9], Rate::PerSecond(24.0), Ease::Linear, 1).is_err());
}

/// A wave with a period of five pixels, which a cubic kernel would dim by a tenth at half a pixel.
fn wave(shift_px: f64) -> LightPicture {
    let (width_px, height_px) = (64, 48);
    let pixels = (0..width_px * height_px).map(|pixel| {
        let [x, y] = [pixel % width_px, pixel / width_px].map(|at| at as f64);
        let phase = std::f64::consts::TAU * ((x + shift_px) / 5.0 + (y - 0.5 * shift_px) / 9.0);
        #[allow(clippy::cast_possible_truncation, reason = "from 0 to 1")]
        let light = (0.5 + 0.3 * phase.sin()) as f32;
        [light; 3]
    });
    LightPicture {
        width_px,
        height_px,
        rgb: pixels.collect(),
    }
}

#[test]
fn a_moved_photograph_keeps_its_detail() {
    let still = wave(0.0);
    let difference = |a: &LightPicture, b: &LightPicture| {
        let inside = |pixel: &usize| (8..56).contains(&(pixel % 64)) && (8..40).contains(&(pixel / 64));
        let pixels = (0..a.rgb.len()).filter(inside);
        pixels
            .map(|pixel| (a.rgb[pixel][0] - b.rgb[pixel][0]).abs())
            .fold(0.0, f32::max)
    };
    let same = resampled(&still, &DMat3::IDENTITY);
    assert!(difference(&same, &still) < 1e-6);
    let moved = resampled(&still, &DMat3::from_translation(DVec2::new(0.5, -0.25)));
    let error = difference(&moved, &wave(0.5));
    assert!(error < 0.01 * 0.3, "{error}");
}

#[test]
fn a_blend_of_two_grainy_photographs_is_as_grainy_at_every_share() {
    const SIDE: i32 = 64;
    const LIGHT: f32 = 0.3;
    let noise = Noise {
        floor: 1e-4,
        per_light: 1e-3,
    };
    let grain = Grain {
        frame: noise,
        plate: noise,
        weights: [0.3, 0.1],
        channels: 0.2,
    };
    let variance = noise.variance(f64::from(LIGHT));
    #[allow(clippy::cast_possible_truncation, reason = "of the range of light")]
    let grainy = |number: u32| {
        let pixels = (0..SIDE * SIDE).map(|k| grain_at([k % SIDE, k / SIDE], number, [0.3, 0.1], 0.2));
        LightPicture {
            width_px: SIDE as usize,
            height_px: SIDE as usize,
            rgb: pixels
                .map(|noise| noise.map(|noise| LIGHT + (variance.sqrt() * noise) as f32))
                .collect(),
        }
    };
    let [left, right] = [1001, 1002].map(grainy);
    let n_pixels = (SIDE * SIDE) as usize;
    let (seen, shadow) = (vec![None; n_pixels], vec![true; n_pixels]);
    let deviation_ratio = |share: f32, grain: Option<FrameGrain>| {
        let mix = Mix {
            pictures: [&left, &right],
            share,
            seen: [&seen, &seen],
            covered: &vec![false; n_pixels],
            touched: &shadow,
            grain,
        };
        let pixels = mix.blended(None).rgb;
        let squares = pixels
            .iter()
            .flatten()
            .map(|light| f64::from(light - LIGHT).powi(2));
        (squares.sum::<f64>() / (3 * n_pixels) as f64 / variance).sqrt()
    };
    for share in [0.0, 0.25, 0.5, 0.9] {
        let ratio = deviation_ratio(share, Some(FrameGrain { grain, frame: 7 }));
        assert!((0.95..1.05).contains(&ratio), "{share}: {ratio}");
    }
    assert!(deviation_ratio(0.5, None) < 0.75);
}
