//! A session of photographs: the toy determines camera and table, and its shadow the light.

use std::fs;
use std::path::{Path, PathBuf};

use app_core::scene::Light;
use app_core::session::{Capture, Session};
use desk::files::{BUNDLED_SESSION, Folder};
use film::length::metres;
use film::new::{DRAWING, Key, NewError, View, Wanted, new};
use film::photograph::{Photograph, PhotographReason};
use glam::{DMat4, DVec3};
use harness::temporary::Temporary;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, Rgb, RgbImage};

/// The 35 mm equivalent of the bundled session's lens: its picture has 640 x 360 px and a focal
/// length of 576 px.
const BUNDLED_35MM: f64 = 33.939;

fn bundled(file: &str) -> PathBuf {
    Path::new(BUNDLED_SESSION).join(file)
}

fn wanted(photographs: &[&str]) -> Wanted {
    Wanted {
        photographs: photographs.iter().map(|file| bundled(file)).collect(),
        toy: bundled("toy.glb"),
        height_m: None,
        moment: None,
        focal_35mm: Some(BUNDLED_35MM),
        view: View::default(),
        up: DVec3::Y,
        lifted_m: 0.0,
        keys: Vec::new(),
        apart_secs: 1.0,
    }
}

/// Transforms from the table, whose +Y is up, and from the toy to the camera.
fn in_camera(capture: &Capture) -> [DMat4; 2] {
    let scene = capture.scene();
    let camera_from_world = capture.frame(0).unwrap().camera.world_from_camera.inverse();
    [scene.receivers[0].world_from_plane, scene.world_from_object].map(|pose| camera_from_world * pose)
}

fn sphere(capture: &Capture) -> DVec3 {
    match capture.scene().lights[0] {
        Light::Sphere {
            position_in_world, ..
        } => position_in_world,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_plate_and_a_photograph_become_the_session_that_they_are_of() {
    let out = Temporary::new("new");
    let out = out.0.join("session");
    new(
        &wanted(&["background_0000.png", "frame_0000.png"]),
        &out,
        &mut |_| {},
    )
    .unwrap();
    assert!(out.join(DRAWING).is_file());
    let made = Capture::open(Folder::open(&out).unwrap()).unwrap();
    let recorded = Capture::open(Folder::open(BUNDLED_SESSION).unwrap()).unwrap();
    let [[table, toy], [true_table, true_toy]] = [&made, &recorded].map(in_camera);
    let off_m = toy.w_axis.distance(true_toy.w_axis);
    assert!(off_m < 3e-4, "the toy is {off_m} m off");
    let normals = [table, true_table].map(|table| table.y_axis.truncate());
    let off_deg = normals[0].angle_between(normals[1]).to_degrees();
    // For pictures with twice as many pixels a side the limit is a tenth of a degree.
    assert!(off_deg < 0.2, "the table is {off_deg} degrees off");
    // Direction from the toy, in the camera's space.
    let towards = |capture: &Capture, toy: DMat4, table: DMat4| {
        let world_from_table = capture.scene().receivers[0].world_from_plane;
        let camera_from_world = table * world_from_table.inverse();
        (camera_from_world.transform_point3(sphere(capture)) - toy.w_axis.truncate()).normalize()
    };
    let lights = [
        towards(&made, toy, table),
        towards(&recorded, true_toy, true_table),
    ];
    let off_deg = lights[0].angle_between(lights[1]).to_degrees();
    assert!(off_deg < 1.0, "the light is {off_deg} degrees off");
}

#[test]
fn what_shows_no_toy_is_refused_and_nothing_is_written() {
    let out = Temporary::new("new-without");
    let out = out.0.join("session");
    let error = new(
        &wanted(&["background_0000.png", "background_0000.png"]),
        &out,
        &mut |_| {},
    )
    .unwrap_err();
    let reason = error.downcast_ref::<NewError>().unwrap();
    assert!(matches!(reason, NewError::NotFound { .. }), "{error}");
    assert!(!out.exists());
}

#[test]
fn a_lens_that_nothing_states_is_asked_for() {
    let out = Temporary::new("new-lens");
    let mut wanted = wanted(&["background_0000.png", "frame_0000.png"]);
    wanted.focal_35mm = None;
    let error = new(&wanted, &out.0.join("session"), &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("--focal-35mm"), "{error}");
}

#[test]
fn a_key_beyond_the_end_of_its_clip_is_refused_like_a_pose() {
    let out = Temporary::new("new-key");
    let mut wanted = wanted(&["background_0000.png", "frame_0000.png"]);
    let moment = ("Look".to_owned(), 99.0);
    wanted.keys = vec![Key {
        path: bundled("frame_0000.png"),
        moment,
    }];
    let error = new(&wanted, &out.0.join("session"), &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("\"Look\" ends at"), "{error}");
}

/// EXIF with an orientation and a 35 mm equivalent focal length, as a segment of a JPEG.
fn exif(orientation: u16, focal_35mm: u16) -> Vec<u8> {
    let mut tiff = b"II*\0\x08\0\0\0".to_vec();
    let entry = |tag: u16, kind: u16, value: u32| {
        let [tag, kind] = [tag, kind].map(u16::to_le_bytes);
        [&tag[..], &kind, &1_u32.to_le_bytes(), &value.to_le_bytes()].concat()
    };
    // The first directory: orientation, and the position of the directory of EXIF's own tags.
    tiff.extend(2_u16.to_le_bytes());
    tiff.extend(entry(0x0112, 3, orientation.into()));
    tiff.extend(entry(0x8769, 4, 38));
    tiff.extend(0_u32.to_le_bytes());
    tiff.extend(1_u16.to_le_bytes());
    tiff.extend(entry(0xa405, 3, focal_35mm.into()));
    tiff.extend(0_u32.to_le_bytes());
    let length = u16::try_from(8 + tiff.len()).unwrap();
    [&b"\xff\xe1"[..], &length.to_be_bytes(), b"Exif\0\0", &tiff].concat()
}

#[test]
fn a_photograph_is_turned_upright_and_its_lens_is_read() {
    let folder = Temporary::new("new-exif");
    let path = folder.0.join("turned.jpg");
    // Red on the left: a quarter turn to the right moves it to the top.
    let picture = RgbImage::from_fn(64, 32, |x, _| Rgb(if x < 32 { [250, 0, 0] } else { [0, 0, 250] }));
    let mut jpeg = Vec::new();
    JpegEncoder::new_with_quality(&mut jpeg, 95)
        .write_image(&picture, 64, 32, ExtendedColorType::Rgb8)
        .unwrap();
    let [start, rest] = [&jpeg[..2], &jpeg[2..]];
    fs::write(&path, [start, &exif(6, 26), rest].concat()).unwrap();
    let read = Photograph::read(&path).unwrap();
    assert_eq!([read.image.width_px, read.image.height_px], [32, 64]);
    let [top, bottom] = [0, 63 * 32 * 4].map(|at| [read.image.rgba8[at], read.image.rgba8[at + 2]]);
    assert!(
        top[0] > 200 && top[1] < 60 && bottom[0] < 60 && bottom[1] > 200,
        "{top:?} {bottom:?}"
    );
    // 26 mm of a film's diagonal of 43.27 mm, over 71.55 px.
    let focal_px = read.focal_px.unwrap();
    assert!((focal_px - 43.0).abs() < 0.05, "{focal_px}");
}

#[test]
fn colours_of_a_phone_are_brought_to_srgb() {
    let folder = Temporary::new("new-p3");
    let picture = RgbImage::from_pixel(4, 4, Rgb([180, 120, 100]));
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(&picture, 4, 4, ExtendedColorType::Rgb8)
        .unwrap();
    // After the header of 33 bytes: Display P3, sRGB's transfer function, full range; then the same
    // with PQ instead.
    let read = |transfer: u8| {
        let named = [&b"cICP"[..], &[12, transfer, 0, 1]].concat();
        let chunk = [
            &4_u32.to_be_bytes()[..],
            &named,
            &crc32fast::hash(&named).to_be_bytes(),
        ]
        .concat();
        let path = folder.0.join(format!("{transfer}.png"));
        fs::write(&path, [&png[..33], &chunk, &png[33..]].concat()).unwrap();
        Photograph::read(&path)
    };
    let image = read(13).unwrap().image;
    // By the primaries of both (SMPTE EG 432-1, IEC 61966-2-1), in 64 bits: 190.3, 116.6, 95.7.
    let expected = [190, 117, 96];
    let off = expected
        .iter()
        .zip(&image.rgba8)
        .map(|(a, b): (&u8, &u8)| a.abs_diff(*b));
    assert!(off.max() <= Some(1), "{:?}", &image.rgba8[..3]);
    assert!(matches!(
        read(16).unwrap_err().reason,
        PhotographReason::Profile(_)
    ));
}

#[test]
fn formats_that_are_not_read_are_named_with_the_way_out() {
    let folder = Temporary::new("new-heic");
    for (name, bytes, format) in [
        ("a.heic", &b"\0\0\0\x18ftypheic\0\0\0\0"[..], "HEIC"),
        ("b.tif", &b"II*\0\x08\0\0\0"[..], "TIFF or a raw photograph"),
    ] {
        let path = folder.0.join(name);
        fs::write(&path, bytes).unwrap();
        let error = Photograph::read(&path).unwrap_err();
        assert!(
            matches!(error.reason, PhotographReason::Foreign { format: told, .. } if told == format),
            "{error}"
        );
        assert!(error.to_string().contains("save it as PNG or JPEG"), "{error}");
    }
}

#[test]
fn lengths_have_units() {
    let length = |text| metres(text).map(|metres| (1e6 * metres).round() / 1e6);
    assert_eq!(length("12cm"), Ok(0.12));
    assert_eq!(length(" 120 mm "), Ok(0.12));
    assert_eq!(length("4in"), Ok(0.1016));
    for none in ["12", "cm", "-3cm", "0m", "12 furlongs"] {
        assert!(metres(none).is_err(), "{none}");
    }
}
