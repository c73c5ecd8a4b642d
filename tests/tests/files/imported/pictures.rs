//! Pictures whose size differs from that of their intrinsics, and pictures through lenses that a
//! session cannot describe.

use app_core::scene::Image;
use app_core::session::Session;
use desk::import::{Format, Lacking, Written};

use crate::imported::small::{Small, grey, lacking};

const SIZE_PX: [u32; 2] = [192, 108];
const FOCAL_PX: f64 = 170.0;
const CENTRE_PX: [f64; 2] = [95.0, 55.0];

fn transforms(camera: &str) -> String {
    let frame =
        r#"{"file_path":"a.png","transform_matrix":[[1,0,0,0],[0,0.8,-0.6,-0.3],[0,0.6,0.8,0.3],[0,0,0,1]]}"#;
    format!(r#"{{{camera},"frames":[{frame}]}}"#)
}

/// The session, and the folder from which it is read.
fn import(name: &str, camera: &str, picture: &Image) -> anyhow::Result<(Written, Small)> {
    let small = Small::new(name);
    small.file("transforms.json", transforms(camera).as_bytes());
    small.picture("a.png", picture);
    let written = small.import(Format::Nerfstudio, &lacking())?;
    Ok((written, small))
}

#[test]
fn intrinsics_are_scaled_to_smaller_pictures() {
    let camera = r#""w":768,"h":432,"fl_x":680,"fl_y":684,"cx":380,"cy":220"#;
    let (written, _small) = import("scaled", camera, &grey(SIZE_PX)).unwrap();
    let of_frame = written.capture.frame(0).unwrap().camera.intrinsics;
    let found = [of_frame.fx_px, of_frame.fy_px, of_frame.cx_px, of_frame.cy_px];
    assert_eq!(found, [170.0, 171.0, 95.0, 55.0]);
    assert_eq!(
        written.notes,
        ["the pictures are 192 x 108 px, the intrinsics of 768 x 432 px: these are scaled by 0.2500"]
    );
    // Without a change there is no note.
    let camera = r#""w":192,"h":108,"fl_x":170,"cx":95,"cy":55"#;
    assert!(
        import("unscaled", camera, &grey(SIZE_PX))
            .unwrap()
            .0
            .notes
            .is_empty()
    );
}

/// Before any picture is copied or undistorted.
#[test]
fn a_session_that_could_not_be_opened_is_refused_at_once() {
    let small = Small::new("at-once");
    let camera = r#""w":192,"h":108,"fl_x":170,"cx":95,"cy":55"#;
    small.file("transforms.json", transforms(camera).as_bytes());
    small.picture("a.png", &grey(SIZE_PX));
    let refused = |lacking: &Lacking| {
        let error = small.import(Format::Nerfstudio, lacking).err().unwrap();
        assert!(!small.folder.0.join("session").exists());
        format!("{error:#}")
    };
    let mut long = lacking();
    long.receiver[0] = long.receiver[0].replace("\"\"", &format!("\"{}\"", "a".repeat(16 << 20)));
    let error = refused(&long);
    assert!(error.starts_with("capture.json: would have 167"), "{error}");
    // More triangles than a toy may have.
    let n_faces = 250_001;
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face {n_faces}\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n{}",
        "3 0 1 2\n".repeat(n_faces)
    );
    small.file("toy.ply", ply.as_bytes());
    let toy = small.folder.0.join("recording/toy.ply");
    let error = refused(&Lacking {
        toy: Some(toy.clone()),
        ..lacking()
    });
    let named = toy.display().to_string();
    assert!(
        error.starts_with(&named) && error.contains("triangles"),
        "{error}"
    );
}

#[test]
fn other_pictures_are_refused() {
    #[rustfmt::skip] // One case a line.
    let cases = [
        ("cropped", r#""w":768,"h":512,"fl_x":680,"cx":384,"cy":256"#, "intrinsics are of 768 x 512 px, which are no multiple of it"),
        ("turned", r#""w":108,"h":192,"fl_x":170,"cx":54,"cy":96"#, "neither cropped nor turned"),
        ("unsized", r#""fl_x":680,"cx":384,"cy":216"#, "its principal point is at (384, 216) px, far from the middle"),
    ];
    for (name, camera, expected) in cases {
        let error = import(name, camera, &grey(SIZE_PX)).err().unwrap().to_string();
        assert!(
            error.starts_with("a.png (the picture): ") && error.contains(expected),
            "{error}"
        );
    }
}

/// A pinhole's view at a position: smooth, and different on each side.
#[test]
fn what_cannot_be_a_session_is_refused_and_leaves_no_folder() {
    let camera = r#""w":192,"h":108,"fl_x":170,"cx":95,"cy":55"#;
    let heic = Small::new("heic");
    heic.file("transforms.json", transforms(camera).as_bytes());
    heic.file("a.png", b"\0\0\0\x18ftypheic");
    let error = heic
        .import(Format::Nerfstudio, &lacking())
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("a.png (the file): the picture is HEIC"), "{error}");

    let small = Small::new("refused");
    small.file("transforms.json", transforms(camera).as_bytes());
    small.picture("a.png", &grey(SIZE_PX));
    small.file("toy.glb", b"whatever");
    let toy = small.folder.0.join("recording/toy.glb");
    let plane = lacking().receiver[0].replace("[1,1]", "[-1,1]");
    #[rustfmt::skip] // One case a line.
    let cases = [
        (Lacking { fps: Some(-30.0), ..lacking() }, "--fps: -30 is not above 0"),
        (Lacking { toy: Some(toy), ..lacking() }, "toy.glb"),
        (Lacking { receiver: vec![plane], ..lacking() }, "receivers[0].half_extent"),
    ];
    for (lacking, expected) in cases {
        let error = small.import(Format::Nerfstudio, &lacking).err().unwrap();
        let error = format!("{error:#}");
        assert!(error.contains(expected), "{error}");
        assert!(!small.folder.0.join("session").exists(), "{expected}");
    }
}

#[test]
fn times_count_if_all_frames_have_one() {
    let camera = r#""w":192,"h":108,"fl_x":170,"cx":95,"cy":55"#;
    let text = transforms(camera);
    let (head, frame) = text.split_once("[{").unwrap();
    let frame = frame.strip_suffix("}]}").unwrap();
    let second = frame.replace("a.png", "b.png");
    for (of_second, times, n_notes) in [(r#","time":9"#, [0.0, 2.0], 0), ("", [0.0, 1.0 / 30.0], 1)] {
        let small = Small::new("times");
        let text = format!(r#"{head}[{{{frame},"time":7}},{{{second}{of_second}}}]}}"#);
        small.file("transforms.json", text.as_bytes());
        small.picture("a.png", &grey(SIZE_PX));
        small.picture("b.png", &grey(SIZE_PX));
        let written = small.import(Format::Nerfstudio, &lacking()).unwrap();
        let found = [0, 1].map(|index| written.capture.frame(index).unwrap().time_secs);
        assert_eq!(found, times);
        assert_eq!(written.notes.len(), n_notes, "{:?}", written.notes);
    }
}

fn pattern([x, y]: [f64; 2]) -> f64 {
    120.0 + 50.0 * (14.0 * x + 3.0 * y).sin() + 40.0 * (11.0 * y - 2.0 * x).cos()
}

fn slope(column: u32, row: u32) -> [f64; 2] {
    [
        (f64::from(column) + 0.5 - CENTRE_PX[0]) / FOCAL_PX,
        (f64::from(row) + 0.5 - CENTRE_PX[1]) / FOCAL_PX,
    ]
}

/// A picture of a function of the position.
fn picture(of: impl Fn([f64; 2]) -> f64) -> Image {
    let [width_px, height_px] = SIZE_PX;
    let pixels = (0..height_px).flat_map(|row| (0..width_px).map(move |column| slope(column, row)));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
    let rgba8 = pixels
        .flat_map(|at| [[of(at).round() as u8; 3].as_slice(), &[255]].concat())
        .collect();
    Image {
        width_px,
        height_px,
        rgba8,
    }
}

/// The pinhole's position of the light that a lens moves to `bent`, by a fixed point of the lens
/// alone.
fn straight(bent: [f64; 2], lens: impl Fn([f64; 2]) -> [f64; 2]) -> [f64; 2] {
    let mut at = bent;
    for _ in 0..200 {
        let [x, y] = lens(at);
        at = [at[0] + 0.5 * (bent[0] - x), at[1] + 0.5 * (bent[1] - y)];
    }
    at
}

/// Largest difference within the picture, in codes.
fn difference(made: &Image, expected: &Image) -> u8 {
    const BORDER: u32 = 12;
    let [width, height] = SIZE_PX;
    let mut largest = 0;
    for row in BORDER..height - BORDER {
        for column in BORDER..width - BORDER {
            let at = 4 * (row * width + column) as usize;
            largest = largest.max(made.rgba8[at].abs_diff(expected.rgba8[at]));
        }
    }
    largest
}

/// OpenCV's model as in its documentation.
fn brown([x, y]: [f64; 2]) -> [f64; 2] {
    let [k1, k2, p1, p2, k3] = [-0.12, 0.05, 0.009, -0.006, 0.02];
    let r2 = x * x + y * y;
    let radial = 1.0 + k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
    [
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    ]
}

/// OpenCV's fisheye model as in its documentation.
fn fisheye([x, y]: [f64; 2]) -> [f64; 2] {
    let r = x.hypot(y);
    let angle = r.atan();
    let bent = angle * (1.0 + 0.05 * angle.powi(2) - 0.02 * angle.powi(4));
    if r > 0.0 {
        [x * bent / r, y * bent / r]
    } else {
        [x, y]
    }
}

#[test]
fn pictures_through_other_lenses_are_undistorted() {
    const CAMERA: &str = r#""w":192,"h":108,"fl_x":170,"cx":95,"cy":55"#;
    let as_pinhole = picture(pattern);
    type Model = fn([f64; 2]) -> [f64; 2];
    let brown_keys = r#""k1":-0.12,"k2":0.05,"p1":0.009,"p2":-0.006,"k3":0.02"#;
    let fisheye_keys = r#""camera_model":"OPENCV_FISHEYE","k1":0.05,"k2":-0.02"#;
    for (name, keys, model) in [
        ("brown", brown_keys, brown as Model),
        ("fisheye", fisheye_keys, fisheye),
    ] {
        let photograph = picture(|at| pattern(straight(at, model)));
        let bent = difference(&photograph, &as_pinhole);
        assert!(
            bent > 12,
            "{name}: as a pinhole's it is off by {bent} codes alone"
        );
        let (written, _small) = import(name, &format!("{CAMERA},{keys}"), &photograph).unwrap();
        assert!(
            written.notes[0].contains("are undistorted"),
            "{:?}",
            written.notes
        );
        let made = written.capture.frame(0).unwrap().image;
        let left = difference(&made, &as_pinhole);
        assert!(left <= 2, "{name}: {left} codes are left");
    }
    // With a wrong sign the residual is larger.
    let photograph = picture(|at| pattern(straight(at, brown)));
    let wrong = brown_keys.replace("0.009", "-0.009");
    let (written, _small) = import("wrong", &format!("{CAMERA},{wrong}"), &photograph).unwrap();
    assert!(difference(&written.capture.frame(0).unwrap().image, &as_pinhole) > 6);
}

#[test]
fn a_session_says_two_radial_terms_itself() {
    let keys = r#""w":192,"h":108,"fl_x":170,"cx":95,"cy":55,"k1":-0.12,"k2":0.05,"p1":0,"p2":0"#;
    let photograph = picture(|at| {
        pattern(straight(at, |[x, y]| {
            let r2 = x * x + y * y;
            let radial = 1.0 - 0.12 * r2 + 0.05 * r2 * r2;
            [x * radial, y * radial]
        }))
    });
    let (written, _small) = import("radial", keys, &photograph).unwrap();
    assert!(written.notes.is_empty(), "{:?}", written.notes);
    assert!(written.capture.lens(0).unwrap().is_some());
    assert!(
        *written.capture.photograph(0).unwrap() == photograph,
        "not a code is another"
    );
    assert!(difference(&written.capture.frame(0).unwrap().image, &picture(pattern)) <= 2);
}

#[test]
fn a_lens_that_folds_is_refused() {
    let camera = r#""w":192,"h":108,"fl_x":170,"cx":95,"cy":55,"k1":-3,"p1":0.1"#;
    let error = import("folds", camera, &grey(SIZE_PX)).err().unwrap().to_string();
    assert!(
        error.starts_with("a.png (the lens): the lens k1 -3, p1 0.1: the lens folds the picture"),
        "{error}"
    );
}
