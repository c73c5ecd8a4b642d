//! Photographs through a lens are converted to a pinhole's, and only changed pixels are put back.

use app_core::scene::Image;
use app_core::session::{Capture, Session, SessionError};
use desk::lens::{map_through_lens, through_lens};
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
use serde_json::json;

use crate::session::parts::{Parts, encode};

const SIZE_PX: [u32; 2] = [96, 64];
const FOCAL_PX: f64 = 60.0;
const CENTRE_PX: [f64; 2] = [45.0, 35.0];
const K1: f64 = 0.12;
const K2: f64 = -0.04;

/// A smooth pattern over a pinhole's picture, in pixels.
fn pattern(u: f64, v: f64) -> f64 {
    130.0 + 60.0 * (0.21 * u).sin() * (0.17 * v + 0.6).cos() + 40.0 * (0.05 * (u - v)).sin()
}

/// A pinhole's position for a position in the photograph: the documented formula, inverted by
/// bisection.
fn of_pinhole(at_px: [f64; 2]) -> [f64; 2] {
    let [x, y] = [0, 1].map(|axis| (at_px[axis] - CENTRE_PX[axis]) / FOCAL_PX);
    let distorted = x.hypot(y);
    let (mut low, mut high) = (0.0, 2.0 * distorted);
    for _ in 0..60 {
        let r: f64 = 0.5 * (low + high);
        let r2 = r * r;
        let is_inside = r * (1.0 + K1 * r2 + K2 * r2 * r2) < distorted;
        (low, high) = if is_inside { (r, high) } else { (low, r) };
    }
    let factor = if distorted > 0.0 { low / distorted } else { 1.0 };
    [
        CENTRE_PX[0] + FOCAL_PX * x * factor,
        CENTRE_PX[1] + FOCAL_PX * y * factor,
    ]
}

fn open(lens: serde_json::Value) -> Result<Capture, SessionError> {
    let mut parts = Parts::good();
    let photo = RgbImage::from_fn(SIZE_PX[0], SIZE_PX[1], |x, y| {
        let [u, v] = of_pinhole([f64::from(x) + 0.5, f64::from(y) + 0.5]);
        #[allow(clippy::cast_possible_truncation, reason = "a code")]
        let code = pattern(u, v).round() as u8;
        Rgb([code; 3])
    });
    let bytes = encode(&DynamicImage::from(photo), ImageFormat::Png);
    for file in ["frame.png", "plate.jpg"] {
        parts.files.insert(file.to_owned(), bytes.clone());
    }
    let intrinsics = json!({"fx": FOCAL_PX, "fy": FOCAL_PX, "cx": CENTRE_PX[0], "cy": CENTRE_PX[1]});
    parts.set("width", json!(SIZE_PX[0]));
    parts.set("height", json!(SIZE_PX[1]));
    for field in [
        "intrinsics",
        "frames[1].intrinsics",
        "backgrounds[0].intrinsics",
        "probe.pictures[0].intrinsics",
    ] {
        parts.set(field, intrinsics.clone());
    }
    parts.index["lens"] = lens;
    let depth = DynamicImage::new_luma16(SIZE_PX[0] / 2, SIZE_PX[1] / 2);
    let people = DynamicImage::new_luma8(SIZE_PX[0] / 2, SIZE_PX[1] / 2);
    for (name, picture) in [("depth.png", depth), ("people.png", people)] {
        let bytes = encode(&picture, ImageFormat::Png);
        parts.files.insert(name.to_owned(), bytes);
    }
    parts.open()
}

/// The largest difference from the pattern, in codes, where the photograph has all needed pixels.
fn worst(image: &Image) -> f64 {
    let texels = (0..).zip(image.rgba8.chunks_exact(4));
    let errors = texels.filter_map(|(index, texel): (u32, _)| {
        let (x, y) = (index % SIZE_PX[0], index / SIZE_PX[0]);
        let is_within = (12..SIZE_PX[0] - 12).contains(&x) && (10..SIZE_PX[1] - 10).contains(&y);
        let expected = pattern(f64::from(x) + 0.5, f64::from(y) + 0.5);
        is_within.then(|| (f64::from(texel[0]) - expected).abs())
    });
    errors.fold(0.0, f64::max)
}

#[test]
fn frames_and_plates_are_those_of_a_pinhole() {
    let capture = open(json!({"k1": K1, "k2": K2})).unwrap();
    let frame = capture.frame(0).unwrap();
    let plate = &capture.scene().plates[0].image;
    assert!(worst(&frame.image) < 1.5, "{}", worst(&frame.image));
    assert!(worst(plate) < 1.5, "{}", worst(plate));
    // Control: a lens with the opposite distortion, or none, is detected.
    for wrong in [json!({"k1": -K1, "k2": -K2}), json!(null)] {
        let frame = open(wrong).unwrap().frame(0).unwrap();
        assert!(worst(&frame.image) > 10.0, "{}", worst(&frame.image));
    }
}

#[test]
fn only_what_was_changed_is_put_back() {
    let capture = open(json!({"k1": K1, "k2": K2})).unwrap();
    let taken = capture.photograph(0).unwrap();
    let seen = capture.frame(0).unwrap().image;
    assert!(seen.rgba8 != taken.rgba8, "the lens does something");
    let same = through_lens(&capture, 0, Image::clone(&seen)).unwrap();
    assert!(same == *taken, "nothing was changed");

    let mut made = Image::clone(&seen);
    let square = |x: u32, y: u32| (70..80).contains(&x) && (20..30).contains(&y);
    for y in 0..SIZE_PX[1] {
        for x in 0..SIZE_PX[0] {
            if square(x, y) {
                let at = 4 * (y * SIZE_PX[0] + x) as usize;
                made.rgba8[at..at + 3].fill(255);
            }
        }
    }
    let shown = through_lens(&capture, 0, made).unwrap();
    let (mut n_white, mut n_kept) = (0, 0);
    for y in 0..SIZE_PX[1] {
        for x in 0..SIZE_PX[0] {
            let at = 4 * (y * SIZE_PX[0] + x) as usize;
            let [u, v] = of_pinhole([f64::from(x) + 0.5, f64::from(y) + 0.5]);
            let inside = (u - 70.0).min(80.0 - u).min(v - 20.0).min(30.0 - v);
            if inside > 2.5 {
                assert!(shown.rgba8[at] > 250, "({x}, {y}): {}", shown.rgba8[at]);
                n_white += 1;
            } else if inside < -2.5 {
                assert_eq!(shown.rgba8[at..at + 4], taken.rgba8[at..at + 4], "({x}, {y})");
                n_kept += 1;
            }
        }
    }
    assert!(n_white > 20 && n_kept > 5000, "{n_white}, {n_kept}");
}

/// A map's pixels are at the lens's positions, with unchanged values.
#[test]
fn a_map_lies_over_the_photograph() {
    let capture = open(json!({"k1": K1, "k2": K2})).unwrap();
    let mut map = Image::clone(&capture.frame(0).unwrap().image);
    for y in 0..SIZE_PX[1] {
        for x in 0..SIZE_PX[0] {
            let at = 4 * (y * SIZE_PX[0] + x) as usize;
            #[allow(clippy::cast_possible_truncation, reason = "a small picture")]
            map.rgba8[at..at + 4].copy_from_slice(&[x as u8, y as u8, 7, 9]);
        }
    }
    let unbent = open(json!(null)).unwrap();
    assert!(map_through_lens(&unbent, 0, map.clone()).unwrap() == map);
    let bent = map_through_lens(&capture, 0, map.clone()).unwrap();
    let (mut n, mut n_moved) = (0, 0);
    for y in 0..SIZE_PX[1] {
        for x in 0..SIZE_PX[0] {
            let at = 4 * (y * SIZE_PX[0] + x) as usize;
            let [u, v] = of_pinhole([f64::from(x) + 0.5, f64::from(y) + 0.5]);
            if bent.rgba8[at..at + 4] == [0; 4] {
                continue;
            }
            assert_eq!(bent.rgba8[at + 2..at + 4], [7, 9]);
            let [is_u, is_v] = [0, 1].map(|part| f64::from(bent.rgba8[at + part]) + 0.5);
            assert!((is_u - u).abs() < 0.51 && (is_v - v).abs() < 0.51, "({x}, {y})");
            n += 1;
            n_moved += usize::from(bent.rgba8[at..at + 2] != map.rgba8[at..at + 2]);
        }
    }
    assert!(n > 5000 && n_moved > 500, "{n}, {n_moved}");
}

#[test]
fn a_lens_that_folds_the_picture_is_refused() {
    let refused = [
        (json!({"k1": 11}), "lens.k1", "11 is not from"),
        (json!({"k1": -0.6}), "lens", "folds the picture"),
        (json!({"k1": 0.5, "k2": -0.6}), "lens", "folds the picture"),
        (json!({"k1": -2.0, "k2": 1.0}), "lens", "folds the picture"),
        (json!({"k2": 0.1}), "lens", "missing field `k1`"),
    ];
    for (lens, field, reason) in refused {
        let error = open(lens).err().unwrap();
        assert_eq!(error.field, field);
        assert!(error.to_string().contains(reason), "{error}");
    }
}
