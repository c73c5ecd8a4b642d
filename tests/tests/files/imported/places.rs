//! Pictures that an index names otherwise: on another machine, in another order, counted from 1, or
//! missing.

use desk::import::{Format, ImportError, Imported, parse};

fn transforms(names: &[&str]) -> String {
    let frames: Vec<String> = (0..)
        .zip(names)
        .map(|(place, name)| {
            let name = name.replace('\\', "\\\\");
            format!(
                r#"{{"file_path":"{name}","transform_matrix":[[1,0,0,{place}],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}}"#
            )
        })
        .collect();
    format!(
        r#"{{"fl_x":500,"cx":320,"cy":240,"frames":[{}]}}"#,
        frames.join(",")
    )
}

fn nerfstudio(names: &[&str], there: &[&str]) -> Result<Imported, ImportError> {
    let there: Vec<String> = there.iter().map(|path| (*path).to_owned()).collect();
    parse(Format::Nerfstudio, [transforms(names).as_bytes(), b""], &there)
}

fn images(imported: &Imported) -> Vec<&str> {
    imported.frames.iter().map(|frame| frame.image.as_str()).collect()
}

#[test]
fn frames_are_in_the_order_of_their_names_as_people_count() {
    let names = ["images/10.png", "images/9.png", "images/2.png", "images/1.png"];
    let imported = nerfstudio(&names, &names).unwrap();
    assert_eq!(
        images(&imported),
        ["images/1.png", "images/2.png", "images/9.png", "images/10.png"]
    );
    // Each frame has its own pose.
    let poses: Vec<f64> = imported
        .frames
        .iter()
        .map(|frame| frame.recorded_from_camera.w_axis.x)
        .collect();
    assert_eq!(poses, [3.0, 2.0, 1.0, 0.0]);
}

#[test]
fn times_win_over_names() {
    let text = transforms(&["a1.png", "a2.png"]).replacen("{\"file_path\"", "{\"time\":1.5,\"file_path\"", 1);
    let text = text.replacen("{\"file_path\"", "{\"time\":0.5,\"file_path\"", 1);
    let there = ["a1.png", "a2.png"].map(str::to_owned);
    let imported = parse(Format::Nerfstudio, [text.as_bytes(), b""], &there).unwrap();
    assert_eq!(images(&imported), ["a2.png", "a1.png"]);
}

#[test]
fn paths_of_other_machines_are_found_by_their_ends() {
    let there = ["images/1.png", "images_4/2.jpg"];
    for name in [
        "images\\1.png",
        "C:\\data\\shoot one\\images\\1.png",
        "/home/someone/shoot/images/1.png",
        "../shoot/./images/1",
    ] {
        let imported = nerfstudio(&[name], &there).unwrap();
        assert_eq!(images(&imported), ["images/1.png"], "{name}");
    }
    assert_eq!(
        images(&nerfstudio(&["images/2.jpg"], &there).unwrap()),
        ["images_4/2.jpg"]
    );
    let error = nerfstudio(&["D:\\masks\\3.png"], &there)
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.ends_with(r#"the first is looked for as "D:\\masks\\3.png""#),
        "{error}"
    );
}

#[test]
fn two_names_of_one_picture_are_refused() {
    let error = nerfstudio(&["left/1.png", "right/1.png"], &["1.png"]);
    let error = error.err().unwrap().to_string();
    assert!(
        error.starts_with("transforms.json (frames[1].file_path): this picture is found at \"1.png\""),
        "{error}"
    );
    // A still camera's picture may occur twice.
    assert_eq!(
        nerfstudio(&["1.png", "1.png"], &["1.png"]).unwrap().frames.len(),
        2
    );
}

#[test]
fn frames_without_a_picture_are_counted() {
    let imported = nerfstudio(&["1.png", "2.png", "3.png"], &["2.png"]).unwrap();
    assert_eq!(
        imported.notes,
        ["2 of 3 frames have no picture and are skipped; the first is \"1.png\""]
    );
    assert!(nerfstudio(&["1.png"], &["1.png"]).unwrap().notes.is_empty());
}

fn stray(pictures: std::ops::Range<u32>) -> Result<Imported, ImportError> {
    let row = |frame| format!("1.{frame}, {frame:06}, 0.{frame}, 0, 0, 1, 0, 0, 0\n");
    let odometry = "timestamp, frame, x, y, z, qx, qy, qz, qw\n".to_owned();
    let odometry = odometry + &(0..6).map(row).collect::<String>();
    let there: Vec<String> = pictures.map(|number| format!("rgb/{number:06}.jpg")).collect();
    let matrix = b"1600, 0, 960\n0, 1600, 720\n0, 0, 1\n";
    parse(Format::StrayScanner, [odometry.as_bytes(), matrix], &there)
}

/// Camera position of each picture.
fn places(imported: &Imported) -> Vec<(&str, f64)> {
    let frames = imported.frames.iter();
    frames
        .map(|frame| (frame.image.as_str(), frame.recorded_from_camera.w_axis.x))
        .collect()
}

#[test]
fn pictures_are_counted_from_0_or_1_by_how_many_there_are() {
    let from_0 = stray(0..6).unwrap();
    let from_1 = stray(1..7).unwrap();
    assert_eq!(
        places(&from_0)[..2],
        [("rgb/000000.jpg", 0.0), ("rgb/000001.jpg", 0.1)]
    );
    assert_eq!(
        places(&from_1)[..2],
        [("rgb/000001.jpg", 0.0), ("rgb/000002.jpg", 0.1)]
    );
    assert_eq!([from_0.frames.len(), from_1.frames.len()], [6, 6]);
    assert!(from_0.notes.is_empty());
    assert_eq!(
        from_1.notes,
        ["the pictures in rgb/ are counted from 1, the frames from 0"]
    );
    // The last pictures may be missing if the first one is known.
    assert_eq!(stray(0..4).unwrap().notes.len(), 1);
    for ambiguous in [1..6, 1..4] {
        let error = stray(ambiguous).err().unwrap().to_string();
        assert!(error.contains("ffmpeg -start_number 0"), "{error}");
    }
}

#[test]
fn record3d_is_counted_so_too() {
    let metadata =
        r#"{"w":4,"h":4,"fps":10,"K":[6,0,0,0,6,0,2,2,1],"poses":[[0,0,0,1,0,0,0],[0,0,0,1,1,0,0]]}"#;
    let there = |numbers: [u32; 2]| numbers.map(|number| format!("rgbd/{number}.jpg"));
    for numbers in [[0, 1], [1, 2]] {
        let imported = parse(Format::Record3d, [metadata.as_bytes(), b""], &there(numbers)).unwrap();
        assert_eq!(imported.frames[1].image, there(numbers)[1]);
        assert_eq!(imported.frames[1].recorded_from_camera.w_axis.x, 1.0);
        assert_eq!(imported.frames[1].size_px, Some([4.0; 2]));
    }
}
