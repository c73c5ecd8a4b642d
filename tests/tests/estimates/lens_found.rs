//! The distortion of a lens that is not listed is found by toy and shadow; a picture without one
//! stays unchanged.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{fs, process};

use app_core::alignment::{Aligner, LensAlignment, RatioOutcome};
use app_core::frame::FrameInput;
use app_core::lens::Distortion;
use app_core::scene::{Image, Scene};
use desk::alignment::{Alignments, Asked, Lights, Source};
use desk::check::aligned_session::{self, Assumed};
use desk::files::{BUNDLED_SESSION, SESSION_FILE};
use desk::opened;
use desk::stored::Stored;
use image::RgbaImage;
use serde_json::Value;

use super::bundled::SESSION;

const BARREL: Distortion = Distortion { k1: -0.1, k2: 0.03 };
const CUSHION: Distortion = Distortion { k1: 0.08, k2: 0.0 };
/// A distortion that one term cannot describe.
const MOUSTACHE: Distortion = Distortion { k1: -0.3, k2: 0.9 };
/// Distance from the principal point to most of toy and shadow: half that of the farthest corner.
const AT_PX: f64 = 180.0;
/// Largest error of the estimated lens at that distance: for every lens the minimum of the loss is
/// .2 px beside the truth, since the session was rendered with few samples per pixel.
const OFF_PX: f64 = 0.25;

/// Displacement by a lens, in pixels outwards, of a pixel at this distance from the principal
/// point.
fn moved_px(lens: Distortion, at_px: f64) -> f64 {
    let r = at_px / SESSION.1.camera.intrinsics.fx_px;
    at_px * (lens.k1 * r.powi(2) + lens.k2 * r.powi(4))
}

/// A pinhole's picture through the lens: the documented formula, inverted by bisection.
fn bent(image: &Image, lens: Distortion) -> Image {
    let intrinsics = SESSION.1.camera.intrinsics;
    let centre = [intrinsics.cx_px, intrinsics.cy_px];
    let mut rgba8 = Vec::with_capacity(image.rgba8.len());
    for y in 0..image.height_px {
        for x in 0..image.width_px {
            let from_centre = [f64::from(x) + 0.5 - centre[0], f64::from(y) + 0.5 - centre[1]];
            let distorted = from_centre[0].hypot(from_centre[1]);
            let (mut low, mut high) = (0.0, 2.0 * distorted);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                let is_inside = middle + moved_px(lens, middle) < distorted;
                (low, high) = if is_inside { (middle, high) } else { (low, middle) };
            }
            let factor = low / distorted.max(f64::MIN_POSITIVE);
            let at = [0, 1].map(|axis| centre[axis] + factor * from_centre[axis] - 0.5);
            rgba8.extend(between(image, at));
        }
    }
    Image {
        rgba8,
        ..image.clone()
    }
}

/// Codes between four pixels; their centres are at integers.
#[expect(
    clippy::cast_possible_truncation,
    reason = "places within the picture, and codes"
)]
fn between(image: &Image, at: [f64; 2]) -> [u8; 4] {
    let last = [image.width_px - 1, image.height_px - 1];
    let at = [0, 1].map(|axis: usize| at[axis].clamp(0.0, f64::from(last[axis])));
    let first = at.map(|at| at as u32);
    [0, 1, 2, 3].map(|channel| {
        let mut sum = 0.0;
        for [dx, dy] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let [x, y] = [(first[0] + dx).min(last[0]), (first[1] + dy).min(last[1])];
            let weight = (1.0 - (at[0] - f64::from(first[0] + dx)).abs())
                * (1.0 - (at[1] - f64::from(first[1] + dy)).abs());
            let texel = 4 * (y * image.width_px + x) as usize;
            sum += weight * f64::from(image.rgba8[texel + channel]);
        }
        sum.round() as u8
    })
}

fn taken_through(lens: Distortion) -> (Scene, FrameInput) {
    let (mut scene, input) = SESSION.clone();
    for plate in &mut scene.plates {
        plate.image = Arc::new(bent(&plate.image, lens));
    }
    let image = Arc::new(bent(input.image.rgba(), lens));
    (scene, input.with_image(image))
}

fn found((scene, input): (Scene, FrameInput)) -> LensAlignment {
    Aligner::new(scene).lens(&input).unwrap()
}

fn off_px(found: Distortion, lens: Distortion) -> f64 {
    (moved_px(found, AT_PX) - moved_px(lens, AT_PX)).abs()
}

#[test]
fn a_lens_that_nobody_lists_is_found() {
    for lens in [BARREL, CUSHION, MOUSTACHE] {
        assert!(
            off_px(Distortion::NONE, lens) > 5.0 * OFF_PX,
            "there is something to find"
        );
        let report = found(taken_through(lens));
        assert_eq!(report.outcome, RatioOutcome::Corrected, "{report:?}");
        let off = off_px(report.distortion, lens);
        assert!(off < OFF_PX, "{off} px, {report:?}");
        assert_eq!(report.distortion.k2 != 0.0, lens == MOUSTACHE, "{report:?}");
    }
}

#[test]
fn a_picture_without_one_stays_as_it_is() {
    let report = found(SESSION.clone());
    assert_eq!(report.outcome, RatioOutcome::AsGiven, "{report:?}");
    assert_eq!(report.distortion, Distortion::NONE);
}

/// Without a plate no shadow is measured.
#[test]
fn what_cannot_tell_it_is_said() {
    let (mut scene, input) = taken_through(BARREL);
    scene.plates.clear();
    let report = found((scene, input));
    assert_eq!(report.outcome, RatioOutcome::Unseen);
    assert_eq!(report.distortion, Distortion::NONE);
}

/// The bundled session in another folder, its photographs through a lens.
fn folder_through(lens: Distortion) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("lens-found-{}", process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for entry in fs::read_dir(BUNDLED_SESSION).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, folder.join(path.file_name().unwrap())).unwrap();
    }
    let (scene, input) = taken_through(lens);
    for (name, image) in [
        ("background_0000.png", &*scene.plates[0].image),
        ("frame_0000.png", &**input.image.rgba()),
    ] {
        let picture = RgbaImage::from_raw(image.width_px, image.height_px, image.rgba8.clone());
        let rgb = image::DynamicImage::from(picture.unwrap()).into_rgb8();
        rgb.save(folder.join(name)).unwrap();
    }
    folder
}

#[test]
fn an_aligned_session_has_the_lens_that_was_found() {
    let folder = folder_through(BARREL);
    let opened = opened::open(&folder, Source::Found, Lights::Given).unwrap();
    let report = opened.lens.unwrap();
    assert!(off_px(report.distortion, BARREL) < OFF_PX, "{report:?}");
    let alignments = Alignments::find(&opened.capture, 0..1, Asked::default())
        .unwrap()
        .with_lens(opened.lens);
    let out = folder.with_extension("aligned");
    let _ = fs::remove_dir_all(&out);
    aligned_session::write(
        &Stored::open(&folder).unwrap(),
        &out,
        &alignments,
        Assumed::Omitted,
    )
    .unwrap();
    let index: Value = serde_json::from_slice(&fs::read(out.join(SESSION_FILE)).unwrap()).unwrap();
    for (key, term) in [("k1", report.distortion.k1), ("k2", report.distortion.k2)] {
        assert_eq!(index["lens"][key].as_f64(), Some(term));
    }
    for folder in [folder, out] {
        fs::remove_dir_all(folder).unwrap();
    }
}
