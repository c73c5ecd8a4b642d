//! Frames whose cost and errors are measured are those that the core draws: at their own place, in
//! other sizes, the first that is retargeted.

use std::fs;

use app_core::depth::Depth;
use app_core::frame::FrameInput;
use app_core::people::People;
use app_core::preset::Preset;
use app_core::session::{Capture, Session};
use desk::alignment::{Lights, Ratio};
use desk::files::Folder;
use glam::{DMat4, DVec3, UVec2};
use harness::temporary::Temporary;
use harness::{bundled_session, open_core};
use image::imageops::FilterType;
use measure::bench::{Draw, Options, PoseAndLightErrors, basin_table, bench, file_names};
use measure::moved::first_moved;
use measure::sized::{sized_input, sized_scene};
use serde_json::{Value, json};

use crate::check::changed;

fn opened(folder: &Temporary) -> Capture {
    Capture::open(Folder::open(&folder.0).unwrap()).unwrap()
}

fn moved(matrix: &Value) -> Value {
    let columns: Vec<f64> = serde_json::from_value(matrix.clone()).unwrap();
    let moved = DMat4::from_translation(DVec3::new(0.02, 0.0, 0.01)) * DMat4::from_cols_slice(&columns);
    json!(moved.to_cols_array())
}

/// The side of the bundled session's pictures over that of small ones.
const SMALLER: u32 = 4;

/// The first frame of the bundled session with small pictures, and with another change.
fn small(change: impl Fn(&mut Value)) -> Temporary {
    let folder = changed("small", |index| {
        index["frames"].as_array_mut().unwrap().truncate(1);
        for side in ["width", "height"] {
            index[side] = json!(index[side].as_u64().unwrap() / u64::from(SMALLER));
        }
        for key in ["fx", "fy", "cx", "cy"] {
            let px = index["intrinsics"][key].as_f64().unwrap();
            index["intrinsics"][key] = json!(px / f64::from(SMALLER));
        }
        change(index);
    });
    for entry in fs::read_dir(&folder.0).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "png") {
            let picture = image::open(&path).unwrap();
            let [width, height] = [picture.width(), picture.height()].map(|px| px / SMALLER);
            let smaller = picture.resize_exact(width, height, FilterType::Nearest);
            smaller.save(&path).unwrap();
        }
    }
    folder
}

/// The shadow's error with exact visibility.
fn exact_rmse(session: &Capture) -> f64 {
    let options = Options {
        presets: vec![Preset::Balanced],
        with_front: false,
        n_repeats: 1,
        frames: (0..1).into(),
        size_px: None,
        as_planes: false,
        with_exact: true,
        is_aligned: false,
        ratio: Ratio::Given,
        lights: Lights::Given,
    };
    let rows = bench(session, &mut open_core(), &options).unwrap();
    let exact = rows.iter().find(|row| row.preset == "balanced+exact").unwrap();
    exact.scores.unwrap().shadow.rmse
}

/// As in sessions that are aligned, or recorded by a phone.
#[test]
fn exact_shadows_belong_to_the_frames_own_place() {
    let own_place = small(|index| {
        let place = index["toy"]["world_from_object"].take();
        index["toy"]["world_from_object"] = moved(&place);
        index["frames"][0]["world_from_object"] = place;
    });
    let [expected, found] = [small(|_| ()), own_place].map(|folder| exact_rmse(&opened(&folder)));
    assert!((found - expected).abs() < 0.02, "{found} instead of {expected}");
}

#[test]
fn depths_and_masks_of_the_pictures_shape_are_not_in_another_size() {
    let session = bundled_session();
    let input = FrameInput::from(&session.frame(0).unwrap())
        .with_depth(Depth::new(UVec2::new(64, 36), vec![500; 64 * 36]))
        .with_people(People::new(UVec2::new(64, 36), vec![0; 64 * 36]));
    input.check().unwrap();
    let sized = sized_input(&input, [300, 300]);
    sized.check().unwrap();
    assert_eq!(sized.image.size_px(), [300, 300]);
    assert_eq!(sized_scene(session.scene(), [300, 300]).width_px, 300);
}

#[test]
fn a_frame_that_shows_the_toy_elsewhere_is_retargeted() {
    let still = |change: fn(&mut Value)| {
        let folder = changed("still", |index| {
            let physical = index["toy"]["physical_pose"].clone();
            for frame in index["frames"].as_array_mut().unwrap() {
                frame["animation"] = physical.clone();
            }
            change(index);
        });
        first_moved(&opened(&folder)).unwrap()
    };
    assert!(still(|_| ()).is_none());
    let elsewhere = |index: &mut Value| {
        index["frames"][2]["world_from_shown"] = moved(&index["toy"]["world_from_object"]);
    };
    let first = still(elsewhere).unwrap();
    assert!(first.world_from_shown.is_some() && first.lights.is_none());
    // Without a list the lights are found, as they are for every picture.
    let unlit = still(|index| {
        index["frames"][0]["world_from_shown"] = moved(&index["toy"]["world_from_object"]);
        index["lights"] = json!([]);
    });
    assert_eq!(unlit.unwrap().lights.unwrap().len(), 1);
}

#[test]
fn the_median_of_two_is_between_them() {
    let off = |pose_mm: f64| PoseAndLightErrors {
        pose_mm,
        pose_deg: 1.0,
        light_deg: None,
    };
    // Rows of two.
    let draws = [1.0, 3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0].map(|end_mm| Draw {
        start: off(9.0),
        end: off(end_mm),
        pull: None,
    });
    let table = basin_table(&draws);
    let first: Vec<&str> = table.lines().nth(1).unwrap().split_whitespace().collect();
    assert_eq!(first[..2], ["2", "9.00"], "{table}");
    assert_eq!(first[4..6], ["2.00", "3.00"], "{table}");
    assert_eq!(table.lines().count(), 5, "{table}");
}

#[test]
fn files_of_variants_of_a_session_have_names_of_their_own() {
    let folder = Temporary::new("variants");
    let sessions = ["sharp/llama", "soft/llama", "llama-2", "llama.mcap"].map(|path| folder.0.join(path));
    sessions[..3]
        .iter()
        .for_each(|path| fs::create_dir_all(path).unwrap());
    fs::write(&sessions[3], "").unwrap();
    let names = file_names(&sessions).unwrap();
    assert_eq!(names, ["llama", "llama-2", "llama-2-2", "llama-3"]);
}
