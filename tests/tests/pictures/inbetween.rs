//! Frames between two prints of the bundled llama: its photographs in two poses of one clip, and
//! the ground truth between them.

use std::fs;

use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::session::{FileError, Files, Folder, GroundTruth, Session};
use desk::metrics::score;
use film::ease::Ease;
use film::inbetween::light::LightPicture;
use film::inbetween::resample::resampled;
use film::inbetween::shot::Shot;
use film::inbetween::timing::Rate;
use film::inbetween::{Options, PictureNames, findings, make};
use glam::{DMat3, DVec2};
use harness::bundled_session;
use harness::temporary::Temporary;
use serde_json::{Value, json};

use crate::core::bundled::core;

/// The bundled session's folder with an additional photograph.
struct WithPhotograph {
    folder: Folder,
    png: Vec<u8>,
}

impl Files for WithPhotograph {
    fn read(&self, path: &str, max_bytes: u64) -> Result<Vec<u8>, FileError> {
        match path {
            "nudged.png" => Ok(self.png.clone()),
            path => self.folder.read(path, max_bytes),
        }
    }
}

const SESSION: &str = "sessions/llama";
/// Disturbance of the second photograph: pixels to the left, and factors for the light.
const NUDGE_PX: f64 = 1.3;
const BRIGHTER: f32 = 1.04;

/// Two prints: the head turned away, and the toy as authored, which is the end of the clip.
fn shot(temporary: &Temporary) -> Shot {
    let session = bundled_session();
    let photograph = session.frame(4).unwrap().image;
    let nudge = DMat3::from_translation(DVec2::new(NUDGE_PX, 0.0));
    let mut nudged = resampled(&LightPicture::of(&photograph), &nudge);
    for pixel in &mut nudged.rgb {
        *pixel = pixel.map(|light| BRIGHTER * light);
    }
    let path = temporary.0.join("nudged.png");
    desk::output::write_png(&path, &nudged.encoded()).unwrap();
    let index = fs::read(format!("{SESSION}/capture.json")).unwrap();
    let mut index: Value = serde_json::from_slice(&index).unwrap();
    index["format"] = json!("shadow-shot");
    index["keys"] = json!([
        { "image": "truth_0000.png", "time": 0.6, "physical_pose": { "clip": "Look", "time": 0.6 } },
        { "image": "nudged.png", "time": 2.4, "physical_pose": { "clip": "Look", "time": 2.4 } },
    ]);
    let files = WithPhotograph {
        folder: Folder::open(SESSION).unwrap(),
        png: fs::read(path).unwrap(),
    };
    Shot::read(&serde_json::to_vec(&index).unwrap(), files).unwrap()
}

fn read_png(path: &std::path::Path) -> Image {
    let picture = image::open(path).unwrap().to_rgba8();
    Image {
        width_px: picture.width(),
        height_px: picture.height(),
        rgba8: picture.into_raw(),
    }
}

#[test]
fn a_frame_between_two_prints_is_near_its_truth_though_camera_and_lamp_were_disturbed() {
    let temporary = Temporary::new("inbetween");
    let shot = shot(&temporary);
    let options = Options {
        out: temporary.0.join("film"),
        preset: Preset::Balanced,
        rate: Rate::Between(2),
        ease: Ease::Linear,
        hold: 1,
        names: PictureNames {
            prefix: "frame_".to_owned(),
            first: 1,
        },
        keeps_keys: false,
        has_onion: false,
    };
    let film = make(&shot, &core(), &options, &mut |_, _| {}).unwrap();
    assert_eq!(film.n_frames, 4);

    let found = &film.keys.keys[1].found;
    for gain in found.gains {
        assert!(
            (gain * f64::from(BRIGHTER) - 1.0).abs() < 3e-3,
            "{:?}",
            found.gains
        );
    }
    let said = findings(&film.keys).join("\n");
    assert!(said.contains("key 1: the camera moved by"), "{said}");
    assert!(!said.contains("key 0: the camera"), "{said}");

    // The head at two thirds of the way.
    let session = bundled_session();
    let truth = session.truth(1).unwrap().unwrap();
    let scores = |picture: &Image| {
        let scores = score(picture, &truth).unwrap();
        [scores.shadow.rmse, scores.toy.rmse, scores.edge.rmse]
    };
    let ours = scores(&read_png(&options.out.join("frame_0003.png")));
    let photographs = [
        session.truth(0).unwrap().unwrap().image,
        (*session.frame(4).unwrap().image).clone(),
    ];
    let [first, second] = photographs.map(|photograph| LightPicture::of(&photograph));
    let mut faded = first.clone();
    for (faded, second) in faded.rgb.iter_mut().zip(&second.rgb) {
        *faded = [0, 1, 2].map(|channel| (faded[channel] + 2.0 * second[channel]) / 3.0);
    }
    let faded = scores(&faded.encoded());
    for (ours, faded) in ours.iter().zip(faded) {
        assert!(5.0 * ours < faded, "{ours} of {faded}");
    }
}
