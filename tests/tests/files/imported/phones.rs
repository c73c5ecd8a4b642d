//! Texts of nerfstudio, Record3D and Stray Scanner.

use std::path::Path;

use app_core::session::Session;
use desk::files::BUNDLED_SESSION;
use desk::import::{
    Format, ImportError, Imported, Lacking, Lens, Source, parse, read, write, write_transforms,
};
use desk::stored::Stored;
use glam::{DMat4, DQuat, DVec3};
use harness::bundled_session;
use harness::temporary::Temporary;
use measure::random::Random;

const ODOMETRY: &str = "timestamp, frame, x, y, z, qx, qy, qz, qw, fx, fy, cx, cy\n\
100.000, 000000, 0.1, 0.2, 0.3, 1, 0, 0, 0, 1597.44, 1597.44, 960.1, 720.2,,\n\
100.017, 000001, 0.1, 0.2, 0.3, 1.0, 0.0, 0.0, 0.0, 1597.89, 1597.89, 960.2, 720.1,,\n\
100.050, 000002, 0.1, 0.2, 0.3, 1, 0, 0, 0,,,,,,\n\
100.100, 000003, 0.1, 0.2, 0.3, 1, 0, 0, 0, 1597.44, 1597.44, 960.1, 720.2\n\n";
const MATRIX: &str = "1600.0, 0.0, 961.0\n0.0, 1601.0, 721.0\n0.0, 0.0, 1.0\n";
const METADATA: &str = r#"{"w":720,"h":960,"fps":60,"K":[660,0,0,0,661,0,362,480,1],
"poses":[[0,0,0,1,0,0,0],[0,0.7071067811865476,0,0.7071067811865476,1,2,3],[0,0,0,1,9,9,9]],
"frameTimestamps":[0,0.0166,0.05],"perFrameIntrinsicCoeffs":[[650,651,361,481]]}"#;
const TRANSFORMS: &str = r#"{"camera_model":"OPENCV","fl_x":500,"fl_y":501,"cx":320,"cy":240,"w":640,"h":480,
"k1":-0.05,"k2":0.01,"p1":0,"p2":0,"frames":[
{"file_path":"./images/a.png","transform_matrix":[[1,0,0,1],[0,0,-1,2],[0,1,0,3],[0,0,0,1]]},
{"file_path":"images/b","fl_x":510,"transform_matrix":[[1,0,0,4],[0,1,0,5],[0,0,1,6]],"time":0.5}]}"#;

fn paths(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

fn stray(odometry: &str) -> Result<Imported, ImportError> {
    let pictures = paths(&[
        "rgb/000000.jpg",
        "rgb/000001.jpg",
        "rgb/000002.png",
        "rgb/000003.jpg",
    ]);
    parse(
        Format::StrayScanner,
        [odometry, MATRIX].map(str::as_bytes),
        &pictures,
    )
}

fn record3d(metadata: &str) -> Result<Imported, ImportError> {
    parse(
        Format::Record3d,
        [metadata.as_bytes(), b""],
        &paths(&["rgbd/0.jpg", "rgbd/1.jpg"]),
    )
}

fn nerfstudio(transforms: &str) -> Result<Imported, ImportError> {
    parse(
        Format::Nerfstudio,
        [transforms.as_bytes(), b""],
        &paths(&["images/a.png", "images/b.jpg"]),
    )
}

#[test]
fn stray_scanner_has_blanks_and_empty_columns_and_intrinsics_of_each_frame() {
    let imported = stray(ODOMETRY).unwrap();
    let intrinsics: Vec<_> = imported.frames.iter().map(|frame| frame.intrinsics).collect();
    let first = [1597.44, 1597.44, 960.1, 720.2];
    let shared = [1600.0, 1601.0, 961.0, 721.0];
    assert_eq!(
        intrinsics,
        [first, [1597.89, 1597.89, 960.2, 720.1], shared, first]
    );
}

#[test]
fn gaps_stay_as_they_are() {
    let times: Vec<_> = stray(ODOMETRY)
        .unwrap()
        .frames
        .iter()
        .map(|frame| frame.time_s.unwrap())
        .collect();
    let gaps: Vec<_> = times
        .windows(2)
        .map(|pair| (1e3 * (pair[1] - pair[0])).round())
        .collect();
    assert_eq!(gaps, [17.0, 33.0, 50.0]);
}

/// That program writes a camera of ARKit with half a turn about x.
#[test]
fn stray_scanner_has_cameras_that_look_along_z() {
    let imported = stray(ODOMETRY).unwrap();
    let expected = DMat4::from_translation(DVec3::new(0.1, 0.2, 0.3));
    assert!(
        imported.frames[0]
            .recorded_from_camera
            .abs_diff_eq(expected, 1e-12)
    );
    assert_eq!(imported.up, Some(DVec3::Y));
}

#[test]
fn the_oldest_odometry_has_no_header_and_no_time() {
    let imported = stray("0.1, 0.2, 0.3, 1, 0, 0, 0\n1e-1, 0.2, 0.3, 1, 0, 0, 0\n").unwrap();
    assert_eq!(imported.frames.len(), 2);
    assert!(imported.frames.iter().all(|frame| frame.time_s.is_none()));
    assert_eq!(imported.frames[1].image, "rgb/000001.jpg");
}

#[test]
fn record3d_has_more_poses_than_pictures_and_columns_first() {
    let imported = record3d(METADATA).unwrap();
    assert_eq!(imported.frames.len(), 2);
    assert_eq!(imported.frames[0].intrinsics, [650.0, 651.0, 361.0, 481.0]);
    assert_eq!(
        imported.frames[1].intrinsics,
        [660.0, 661.0, 362.0, 480.0],
        "that of K"
    );
    assert_eq!(imported.frames[1].time_s, Some(0.0166));
    let quarter = DMat4::from_rotation_translation(
        DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2),
        DVec3::new(1.0, 2.0, 3.0),
    );
    assert!(
        imported.frames[1]
            .recorded_from_camera
            .abs_diff_eq(quarter, 1e-12)
    );
    assert_eq!(imported.up, None, "gravity is lost");
}

/// Times of a list that ends too early are not mixed with those from `fps`.
#[test]
fn record3d_has_times_for_all_frames_or_counts_all() {
    let metadata = METADATA.replace("[0,0.0166,0.05]", "[7]");
    let imported = record3d(&metadata).unwrap();
    let times: Vec<_> = imported.frames.iter().map(|frame| frame.time_s).collect();
    assert_eq!(times, [Some(0.0), Some(1.0 / 60.0)]);
    assert!(
        imported.notes.iter().any(|note| note.contains("none is used")),
        "{:?}",
        imported.notes
    );
}

#[test]
fn matrices_that_are_no_poses_are_refused() {
    let pose = "[[1,0,0,1],[0,0,-1,2],[0,1,0,3],[0,0,0,1]]";
    assert!(nerfstudio(TRANSFORMS).is_ok());
    // A scale applies to the whole scene, and is left out; four digits are enough.
    for good in [
        "[[2,0,0,1],[0,0,-2,2],[0,2,0,3],[0,0,0,1]]",
        "[[0.7071,-0.7071,0,1],[0.7071,0.7071,0,2],[0,0,1,3],[0,0,0,1]]",
    ] {
        assert!(nerfstudio(&TRANSFORMS.replace(pose, good)).is_ok(), "{good}");
    }
    for wrong in [
        "[[1,0,0,1],[0,0,1,2],[0,1,0,3],[0,0,0,1]]",
        "[[1,0.2,0,1],[0,0,-1,2],[0,1,0,3],[0,0,0,1]]",
        "[[1,0,0,1],[0,0,-1,2],[0,1.2,0,3],[0,0,0,1]]",
        "[[0,0,0,1],[0,0,0,2],[0,0,0,3],[0,0,0,1]]",
        "[[1,0,0,1],[0,0,-1,2],[0,1,0,3],[1,2,3,1]]",
    ] {
        let error = nerfstudio(&TRANSFORMS.replace(pose, wrong)).err().unwrap();
        let error = error.to_string();
        assert!(
            error.contains("frames[0].transform_matrix") && error.contains("the matrix is no pose"),
            "{wrong}: {error}"
        );
    }
}

#[test]
fn nerfstudio_has_rows_and_z_up_and_its_own_intrinsics() {
    let imported = nerfstudio(TRANSFORMS).unwrap();
    assert_eq!(imported.up, Some(DVec3::Z));
    assert!(!imported.is_metric);
    assert_eq!(imported.frames[0].lens, Lens::radial([-0.05, 0.01, 0.0, 0.0]));
    assert_eq!(imported.frames[0].size_px, Some([640.0, 480.0]));
    assert_eq!(imported.frames[1].image, "images/b.jpg");
    assert_eq!(imported.frames[1].intrinsics, [510.0, 501.0, 320.0, 240.0]);
    let pose = imported.frames[0].recorded_from_camera;
    assert_eq!(pose.w_axis.truncate(), DVec3::new(1.0, 2.0, 3.0));
    // The camera looks along its own -Z, which is +Y of that world.
    assert_eq!(pose.transform_vector3(DVec3::NEG_Z), DVec3::Y);
}

#[test]
fn errors_name_file_field_and_reason() {
    #[rustfmt::skip] // One case a line.
    let cases = [
        (stray(&ODOMETRY.replace("100.050, 000002, 0.1", "100.050, 000002, far")), "odometry.csv (line 4, x): \"far\" is not a finite number"),
        (stray(&ODOMETRY.replace("0.3, 1.0, 0.0,", "0.3, 0.0, 0.0,")), "odometry.csv (line 3, qw): the quaternion has no direction"),
        (stray(&ODOMETRY.replace("000003, 0.1", "000003, inf")), "odometry.csv (line 5, x): \"inf\" is not a finite number"),
        (record3d(&METADATA.replace(",1,2,3]", ",1,2]")), "metadata (poses[1]): 6 numbers, 7 are needed"),
        (record3d("{}"), "metadata (the file): missing field `poses`"),
        (nerfstudio(&TRANSFORMS.replace("OPENCV", "EQUIRECTANGULAR")), "transforms.json (camera_model): \"EQUIRECTANGULAR\": that camera model cannot be taken: undistort the pictures first"),
        (nerfstudio(&TRANSFORMS.replace("\"time\":0.5", "\"time\":1.7e18")), "transforms.json (frames[1].time): 1700000000000000000 is no time in seconds"),
        (nerfstudio(&TRANSFORMS.replace("[0,0,1,6]", "[0,0,1]")), "transforms.json (frames[1].transform_matrix): 3 numbers, 4 are needed"),
        (parse(Format::Record3d, [METADATA.as_bytes(), b""], &[]), "metadata (the frames): no frame with a pose has a picture: the first is looked for as \"rgbd/0.jpg\""),
    ];
    for (result, expected) in cases {
        let error = result.err().map(|error| error.to_string()).unwrap_or_default();
        assert!(error.starts_with(expected), "{error}\n{expected}");
    }
}

/// Texts with bytes changed, cut or doubled at random: nothing panics, and all accepted values are
/// finite.
#[test]
fn whatever_is_in_a_file_is_answered() {
    let mut random = Random::new(77);
    let mut taken = [0; 3];
    for _ in 0..3000 {
        let texts = [ODOMETRY, METADATA, TRANSFORMS].map(|text| mutated(text, &mut random));
        let results = [stray(&texts[0]), record3d(&texts[1]), nerfstudio(&texts[2])];
        for (result, taken) in results.into_iter().zip(&mut taken) {
            for frame in result.into_iter().flat_map(|imported| imported.frames) {
                *taken += 1;
                assert!(frame.recorded_from_camera.is_finite());
                assert!(frame.intrinsics.iter().all(|number| number.is_finite()));
                assert!(frame.time_s.is_none_or(f64::is_finite));
            }
        }
    }
    assert!(taken.iter().all(|n| *n > 200), "{taken:?}");
}

#[expect(clippy::cast_possible_truncation, reason = "below n")]
fn pick(random: &mut Random, n: usize) -> usize {
    ((random.uniform() * n as f64) as usize).min(n.saturating_sub(1))
}

fn mutated(text: &str, random: &mut Random) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + pick(random, 3) {
        let at = pick(random, bytes.len());
        let with = b"0123456789-.,e[]{}\"\n nuINaf"[pick(random, 27)];
        match pick(random, 4) {
            0 => bytes[at] = with,
            1 => bytes.insert(at, with),
            2 => bytes.truncate(bytes.len() - 1 - pick(random, 3)),
            _ => b"803e999".iter().for_each(|digit| bytes.insert(at, *digit)),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Export to nerfstudio's format and import again: cameras and pictures are the same.
#[test]
fn the_bundled_session_comes_back_from_nerfstudio() {
    let folder = Temporary::new("nerfstudio");
    let [there, back] = ["there", "back"].map(|name| folder.0.join(name));
    write_transforms(&Stored::open(BUNDLED_SESSION).unwrap(), &there).unwrap();
    let files = Source::open(&there).unwrap();
    let imported = read(Format::Nerfstudio, &files, &files.paths().unwrap(), None).unwrap();
    let given = bundled_session();
    let error = write("llama", &files, &imported, &Lacking::default(), &back)
        .err()
        .unwrap()
        .to_string();
    for name in [
        "--toy",
        "--world-from-object",
        "--receiver",
        "--light",
        "--plates",
        "--metres",
    ] {
        assert!(error.contains(name), "{error}");
    }
    assert!(!error.contains("--up") && !back.exists(), "{error}");
    let place = given
        .scene()
        .world_from_object
        .to_cols_array()
        .map(|number| number.to_string())
        .join(",");
    let lacking = Lacking {
        toy: Some(Path::new(BUNDLED_SESSION).join("toy.glb")),
        world_from_object: Some(place),
        receiver: vec![r#"{"name":"table","world_from_plane":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"half_extent":[0.6,0.4],"surface":"textured"}"#.to_owned()],
        light: vec!["none".to_owned()],
        plates: Some("0-0".to_owned()),
        metres: Some(1.0),
        ..Lacking::default()
    };
    let capture = write("llama", &files, &imported, &lacking, &back)
        .unwrap()
        .capture;
    assert_eq!(
        (capture.n_frames() + 1, capture.scene().plates.len()),
        (given.n_frames(), 1)
    );
    for index in 0..capture.n_frames() {
        let [given, back] = [given.frame(index + 1).unwrap(), capture.frame(index).unwrap()];
        assert!(
            back.camera
                .world_from_camera
                .abs_diff_eq(given.camera.world_from_camera, 1e-9)
        );
        assert_eq!(back.camera.intrinsics, given.camera.intrinsics);
        assert!(back.image.rgba8 == given.image.rgba8);
    }
}
