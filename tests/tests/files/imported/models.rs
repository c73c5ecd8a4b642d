//! Models of COLMAP and scenes of BOP: the image positions of a point of the world, and meshes.

use app_core::session::Session;
use app_core::toy::{Pose, Toy};
use desk::import::{Format, Imported, Lens, glb_of_ply, parse};
use glam::{DMat3, DMat4, DQuat, DVec2, DVec3};
use measure::glb::chunks;
use measure::random::Random;

use crate::imported::small::{Small, grey, lacking};

const POINT: DVec3 = DVec3::new(0.3, -0.2, 0.5);
/// Rotation from the world to the camera, in COLMAP's order: w, x, y, z.
const QUATERNION: [f64; 4] = [0.8, 0.1, 0.55, -0.2];
const TRANSLATION: [f64; 3] = [0.1, -0.3, 2.0];
const NUMBERS: [f64; 8] = [600.0, 610.0, 320.5, 238.0, -0.05, 0.01, 0.001, -0.002];

const CAMERAS: &str =
    "# Camera list\n# Number of cameras: 1\n7 OPENCV 640 480 600 610 320.5 238 -0.05 0.01 0.001 -0.002\n";
/// The points of the first image are an empty line.
const IMAGES: &str = "# Image list with two lines of data per image:\n1 0.8 0.1 0.55 -0.2 0.1 -0.3 2 7 my 10.png\n\n2 1 0 0 0 0 0 1 7 my 2.png\n10 20 -1 30 40 5\n";
const THERE: [&str; 2] = ["images/my 10.png", "images/my 2.png"];

fn colmap(files: [&[u8]; 2]) -> Imported {
    parse(Format::Colmap, files, &THERE.map(str::to_owned)).unwrap()
}

/// The same in COLMAP's binary format.
fn binary() -> [Vec<u8>; 2] {
    let floats = |values: &[f64]| {
        values
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect::<Vec<_>>()
    };
    let cameras = [
        &1_u64.to_le_bytes()[..],
        &7_u32.to_le_bytes(),
        &4_i32.to_le_bytes(),
        &640_u64.to_le_bytes(),
        &480_u64.to_le_bytes(),
        &floats(&NUMBERS),
    ]
    .concat();
    let image = |id: u32, pose: &[f64], name: &[u8], points: &[u8]| {
        let n_points = points.len() as u64 / 24;
        [
            &id.to_le_bytes()[..],
            &floats(pose),
            &7_u32.to_le_bytes(),
            name,
            &n_points.to_le_bytes(),
            points,
        ]
        .concat()
    };
    let first = image(
        1,
        &[QUATERNION.as_slice(), &TRANSLATION].concat(),
        b"my 10.png\0",
        &[],
    );
    let second = image(2, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], b"my 2.png\0", &[9; 48]);
    [cameras, [2_u64.to_le_bytes().to_vec(), first, second].concat()]
}

/// By COLMAP's own formulas: `x = R X + t`, then the intrinsics of a pinhole.
fn pixel_by_colmap([w, x, y, z]: [f64; 4], t: [f64; 3]) -> DVec2 {
    let n = (w * w + x * x + y * y + z * z).sqrt();
    let [w, x, y, z] = [w / n, x / n, y / n, z / n];
    let rows = [
        DVec3::new(
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
        ),
        DVec3::new(
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
        ),
        DVec3::new(
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        ),
    ];
    let at = DVec3::from_array(rows.map(|row| row.dot(POINT))) + DVec3::from_array(t);
    DVec2::new(
        NUMBERS[0] * at.x / at.z + NUMBERS[2],
        NUMBERS[1] * at.y / at.z + NUMBERS[3],
    )
}

/// By the session's formulas.
fn pixel_by_us(recorded_from_camera: &DMat4, [fx, fy, cx, cy]: [f64; 4], world: DVec3) -> DVec2 {
    let at = recorded_from_camera.inverse().transform_point3(world);
    DVec2::new(cx + fx * at.x / -at.z, cy - fy * at.y / -at.z)
}

#[test]
fn colmaps_cameras_see_a_point_where_colmap_has_it() {
    let [cameras, images] = binary();
    for imported in [
        colmap([CAMERAS.as_bytes(), IMAGES.as_bytes()]),
        colmap([&cameras, &images]),
    ] {
        let names: Vec<_> = imported.frames.iter().map(|frame| frame.image.as_str()).collect();
        assert_eq!(names, [THERE[1], THERE[0]], "2 comes before 10");
        let frame = &imported.frames[1];
        let expected = pixel_by_colmap(QUATERNION, TRANSLATION);
        let found = pixel_by_us(&frame.recorded_from_camera, frame.intrinsics, POINT);
        assert!(found.distance(expected) < 1e-9, "{found} {expected}");
        // With an inverted pose it would be elsewhere.
        let inverted = pixel_by_us(&frame.recorded_from_camera.inverse(), frame.intrinsics, POINT);
        assert!(inverted.distance(expected) > 10.0);
        let [_, _, _, _, k1, k2, p1, p2] = NUMBERS;
        let lens = Lens::Brown {
            radial: [k1, k2, 0.0, 0.0],
            divisor: [0.0; 3],
            tangential: [p1, p2],
        };
        assert_eq!((frame.lens, frame.size_px), (lens, Some([640.0, 480.0])));
        assert!(imported.up.is_none() && !imported.is_metric);
    }
}

#[test]
fn models_of_colmap_are_found_and_damaged_ones_told() {
    let folder = |model: &str| {
        let small = Small::new("colmap");
        small.file(
            &format!("{model}cameras.txt"),
            CAMERAS.replace("OPENCV", "FOV").as_bytes(),
        );
        small.file(&format!("{model}images.txt"), IMAGES.as_bytes());
        small.picture("images/my 2.png", &grey([64, 48]));
        small.import(Format::Colmap, &lacking())
    };
    for model in ["", "sparse/0/"] {
        let error = folder(model).err().unwrap().to_string();
        let expected = format!("{model}cameras.txt (line 3): \"FOV\": that camera model cannot be taken");
        assert!(error.starts_with(&expected), "{error}");
    }
    let error = folder("elsewhere/").err().unwrap().to_string();
    assert!(
        error.starts_with("cameras.bin, images.bin (the files): missing"),
        "{error}"
    );
    let [cameras, images] = binary();
    let there = THERE.map(str::to_owned);
    for n_bytes in 1..images.len() {
        let cut = parse(Format::Colmap, [&cameras, &images[..n_bytes]], &there);
        assert!(cut.is_err(), "{n_bytes} bytes are read as all");
    }
    let mut vast = images.clone();
    vast[..8].copy_from_slice(&u64::MAX.to_le_bytes());
    let error = parse(Format::Colmap, [&cameras, &vast], &there)
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("18446744073709551615 of them do not fit into the file"),
        "{error}"
    );
}

/// Rows of a rotation, and millimetres.
const ROWS: [f64; 9] = [0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6];
const TRANSLATION_MM: [f64; 3] = [30.0, -20.0, 700.0];

fn scene(of_second: &str) -> [String; 2] {
    let camera = r#"{"cam_K":[500,0,31.5,0,510,23.5,0,0,1],"depth_scale":1}"#;
    let pose = |id: u32| format!(r#"{{"cam_R_m2c":{ROWS:?},"cam_t_m2c":{TRANSLATION_MM:?},"obj_id":{id}}}"#);
    [
        format!(r#"{{"3":{camera},"12":{camera}}}"#),
        format!(r#"{{"12":[{of_second}{}],"3":[{}]}}"#, pose(5), pose(5)),
    ]
}

#[test]
fn a_scene_of_bop_is_in_metres_and_says_where_the_toy_is() {
    let [camera, truth] = scene("");
    let small = Small::new("bop");
    small.file("scene_camera.json", camera.as_bytes());
    small.file("scene_gt.json", truth.as_bytes());
    for number in [3, 12] {
        small.picture(&format!("rgb/{number:06}.png"), &grey([64, 48]));
    }
    let given = desk::import::Lacking {
        world_from_object: None,
        metres: None,
        up: Some("0,0,1".to_owned()),
        ..lacking()
    };
    let written = small.import(Format::Bop, &given).unwrap();
    let (scene, frame) = (written.capture.scene(), written.capture.frame(0).unwrap());
    // OpenCV's own formula, in millimetres, with the centre of the first pixel at 0.
    let point_mm = DVec3::new(12.0, 34.0, -21.0);
    let at = DMat3::from_cols_array(&ROWS).transpose() * point_mm + DVec3::from_array(TRANSLATION_MM);
    let expected = DVec2::new(500.0 * at.x / at.z + 31.5, 510.0 * at.y / at.z + 23.5) + 0.5;
    let world = scene.world_from_object.transform_point3(point_mm);
    let in_camera = frame.camera.world_from_camera.inverse().transform_point3(world);
    let found = frame.camera.intrinsics.pixel_of(in_camera).unwrap();
    assert!(found.distance(expected) < 1e-9, "{found} {expected}");
    assert!((in_camera.length() - 1e-3 * at.length()).abs() < 1e-12, "metres");
    // The model's +Z is up.
    let up = scene.world_from_object.transform_vector3(1000.0 * DVec3::Z);
    assert!(up.distance(DVec3::Y) < 1e-12, "{up}");
}

#[test]
fn the_toy_of_several_objects_is_asked_for() {
    let [camera, truth] = scene(r#"{"cam_R_m2c":[1,0,0,0,1,0,0,0,1],"cam_t_m2c":[0,0,9],"obj_id":2},"#);
    let there = ["rgb/000003.png".to_owned(), "rgb/000012.png".to_owned()];
    let error = parse(Format::Bop, [camera.as_bytes(), truth.as_bytes()], &there);
    let error = error.err().unwrap().to_string();
    assert_eq!(
        error,
        "scene_gt.json (obj_id): the scene has the objects 2, 5: name the toy with --object"
    );
    let mirrored = truth
        .replace("[1,0,0,0,1,0,0,0,1]", "[1,0,0,0,1,0,0,0,-1]")
        .replace("5}", "2}");
    let error = parse(Format::Bop, [camera.as_bytes(), mirrored.as_bytes()], &there);
    let error = error.err().unwrap().to_string();
    assert_eq!(error, "scene_gt.json (12.cam_R_m2c): the matrix is no rotation");
    // A shear, which keeps the volume.
    let sheared = mirrored.replace("[1,0,0,0,1,0,0,0,-1]", "[1,0.5,0,0,1,0,0,0,1]");
    assert_ne!(sheared, mirrored);
    let error = parse(Format::Bop, [camera.as_bytes(), sheared.as_bytes()], &there);
    let error = error.err().unwrap().to_string();
    assert_eq!(error, "scene_gt.json (12.cam_R_m2c): the matrix is no rotation");
}

/// A pyramid of a square and four triangles, in millimetres.
fn ply(format: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\ncomment made by a test\nelement vertex 5\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 5\nproperty list uchar int vertex_indices\nend_header\n"
    );
    let corners: [[f64; 3]; 5] = [
        [-10.0, 0.0, -10.0],
        [-10.0, 0.0, 10.0],
        [10.0, 0.0, 10.0],
        [10.0, 0.0, -10.0],
        [0.0, 25.0, 0.0],
    ];
    let faces: [&[i32]; 5] = [&[3, 2, 1, 0], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];
    let mut bytes = header.into_bytes();
    let swapped = format == "binary_big_endian";
    let mut add = |mut number: Vec<u8>, text: String| {
        if format == "ascii" {
            bytes.extend((text + " ").bytes());
        } else {
            if swapped {
                number.reverse();
            }
            bytes.extend(number);
        }
    };
    for [x, y, z] in corners {
        #[expect(clippy::cast_possible_truncation, reason = "small whole numbers")]
        let [single_x, single_z] = [x as f32, z as f32];
        add(single_x.to_le_bytes().to_vec(), x.to_string());
        add(y.to_le_bytes().to_vec(), y.to_string());
        add(single_z.to_le_bytes().to_vec(), z.to_string());
        for code in [188_u8, 0, 255] {
            add(vec![code], code.to_string());
        }
    }
    for face in faces {
        let n = u8::try_from(face.len()).unwrap();
        add(vec![n], n.to_string());
        for corner in face {
            add(corner.to_le_bytes().to_vec(), corner.to_string());
        }
    }
    bytes
}

#[test]
fn a_mesh_is_the_same_however_it_is_written() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let file = ply(format);
        let glb = glb_of_ply(&file, &|_| None).unwrap();
        let toy = Toy::from_glb("pyramid.glb", &glb).unwrap();
        assert_eq!(toy.indices().len(), 18, "a square is two triangles");
        let bounds = toy.bounds_of_pose(&Pose::Authored).unwrap();
        assert_eq!(bounds.min.to_array(), [-10.0, 0.0, -10.0], "{format}");
        assert_eq!(bounds.max.to_array(), [10.0, 25.0, 10.0], "{format}");
        // Codes are sRGB, but the file's colours are linear.
        let (tree, bin) = chunks(&glb);
        let number = |value: &serde_json::Value| usize::try_from(value.as_u64().unwrap()).unwrap();
        let colors = &tree["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"];
        let at = number(&tree["bufferViews"][number(colors)]["byteOffset"]);
        let red = f32::from_le_bytes(bin[at..at + 4].try_into().unwrap());
        assert!((red - 0.5029).abs() < 1e-3, "{red}");
        let cut = glb_of_ply(&file[..file.len() - 3], &|_| None);
        assert!(cut.is_err(), "{format}: a cut file is taken");
    }
    let text = String::from_utf8(ply("ascii")).unwrap();
    let (header, _) = text.split_once("element face").unwrap();
    let cloud = format!(
        "{header}end_header\n{}",
        text.split_once("end_header\n").unwrap().1
    );
    let error = glb_of_ply(cloud.as_bytes(), &|_| None).err().unwrap().to_string();
    assert!(error.contains("a cloud of points is no toy"), "{error}");
}

/// The form in which MeshLab writes it.
#[test]
fn a_texture_whose_coordinates_stand_in_the_faces_is_not_lost_silently() {
    let text = "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n";
    let read = |text: &str| glb_of_ply(text.as_bytes(), &|_| Some(b"\x89PNG".to_vec()));
    let error = read(text).err().unwrap().to_string();
    assert!(error.contains("texture coordinates per vertex"), "{error}");
    assert!(read(&text.replace("comment TextureFile skin.png\n", "")).is_ok());
}

#[test]
fn a_quaternion_of_colmap_begins_with_its_real_part() {
    let [w, x, y, z] = QUATERNION;
    let imported = colmap([CAMERAS.as_bytes(), IMAGES.as_bytes()]);
    let turned = DQuat::from_xyzw(x, y, z, w).normalize().inverse() * DVec3::Z;
    let looks = imported.frames[1]
        .recorded_from_camera
        .transform_vector3(DVec3::NEG_Z);
    assert!(looks.distance(turned) < 1e-12, "{looks} {turned}");
}

/// Files with bytes changed, cut or doubled at random: nothing panics, and all accepted values are
/// finite.
#[test]
fn whatever_is_in_a_model_is_answered() {
    let [cameras, images] = binary();
    let mesh = ply("binary_little_endian");
    let [camera, truth] = scene("");
    let texts = [(Format::Colmap, CAMERAS, IMAGES), (Format::Bop, &camera, &truth)];
    let texts =
        texts.map(|(format, first, second)| (format, first.as_bytes().to_vec(), second.as_bytes().to_vec()));
    let there = THERE.map(str::to_owned);
    let mut random = Random::new(44);
    let mut n_taken = 0;
    for _ in 0..1500 {
        let mut check = |format, files: [&[u8]; 2]| {
            let changed = files.map(|file| changed(file, &mut random));
            let imported = parse(format, changed.each_ref().map(Vec::as_slice), &there);
            for frame in imported.into_iter().flat_map(|imported| imported.frames) {
                assert!(frame.recorded_from_camera.is_finite());
                assert!(frame.intrinsics.iter().all(|number| number.is_finite()));
                n_taken += 1;
            }
        };
        check(Format::Colmap, [&cameras, &images]);
        for (format, first, second) in &texts {
            check(*format, [first, second]);
        }
        if let Ok(glb) = glb_of_ply(&changed(&mesh, &mut random), &|_| None) {
            let _ = Toy::from_glb("changed.glb", &glb);
            n_taken += 1;
        }
    }
    assert!(n_taken > 500, "{n_taken}");
}

/// A file with up to two changes.
fn changed(file: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = file.to_vec();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below n")]
    let mut below = |n: usize| (random.uniform() * n as f64) as usize;
    for _ in 0..below(3) {
        let at = below(bytes.len());
        match below(4) {
            0 => bytes[at] ^= 1 << below(8),
            1 => bytes[at] = [0, 0xff, b'9', b'-'][below(4)],
            2 => bytes.truncate(at + 1),
            _ => bytes.insert(at, b'7'),
        }
    }
    bytes
}
