//! Names and numbers of pictures.

use std::fs;
use std::path::Path;

use film::animate::frame_files::{FrameRange, NamePattern};
use film::photograph::{Photograph, PhotographReason};
use film::video::{Video, is_video};
use harness::temporary::Temporary;

#[test]
fn a_number_stands_where_the_signs_are() {
    let file = |pattern: &str, number| pattern.parse::<NamePattern>().unwrap().file(number);
    assert_eq!(file("shot_####", 7), "shot_0007.png");
    assert_eq!(file("a#b.png", 1001), "a1001b.png");
    assert_eq!(file("######", 12), "000012.png");
    assert_eq!(
        NamePattern::of_session("llama: best/of").file(1),
        "llama__best_of_0001.png"
    );
    for refused in ["shot", "a#b#", "../a#", "a/b#", "-#", ".#", "a#\\b", ""] {
        assert!(refused.parse::<NamePattern>().is_err(), "{refused}");
    }
}

#[test]
fn ranges_are_of_the_films_own_numbers() {
    let all = 1001..1049;
    let within = |text: &str| text.parse::<FrameRange>().unwrap().within(&all);
    assert_eq!(within("1003"), Some(1003..1004));
    assert_eq!(within("1003.."), Some(1003..1049));
    assert_eq!(within("..1003"), Some(1001..1003));
    assert_eq!(within("1010..1020"), Some(1010..1020));
    assert_eq!(
        [within("0..3"), within("1049"), within("1040..1050")],
        [None, None, None]
    );
    for refused in ["", "a", "5..5", "6..5", "1-2", "..x"] {
        let parsed = refused.parse::<FrameRange>();
        assert!(parsed.is_err(), "{refused}");
    }
}

#[test]
fn a_video_is_known_by_its_ending_and_leaves_nothing_if_it_cannot_be_read() {
    let named = ["walk.MP4", "walk.mov", "walk.png", "mp4"].map(|name| is_video(Path::new(name)));
    assert_eq!(named, [true, true, false, false]);

    let folder = Temporary::new("video");
    let (video, pictures) = (folder.0.join("walk.mp4"), folder.0.join("pictures"));
    fs::create_dir_all(&folder.0).unwrap();
    fs::write(&video, "no video").unwrap();
    // This holds with ffmpeg, and without.
    let error = Video::open(&video, &pictures, 1).unwrap_err();
    assert!(format!("{error:#}").contains("walk.mp4: "), "{error:#}");
    assert!(!pictures.exists());
    fs::create_dir(&pictures).unwrap();
    let error = Video::open(&video, &pictures, 1).unwrap_err().to_string();
    assert!(error.contains("was interrupted: remove it"), "{error}");
    assert!(pictures.exists(), "it is another run's");
}

#[test]
fn a_photograph_that_was_cut_off_is_refused() {
    let folder = Temporary::new("cut-short");
    let mut bytes = Vec::new();
    let noise = image::RgbImage::from_fn(128, 128, |x, y| {
        image::Rgb([x, y, x ^ y].map(|code| u8::try_from(code).unwrap()))
    });
    let mut encoder = image::codecs::jpeg::JpegEncoder::new(&mut bytes);
    encoder.encode_image(&noise).unwrap();
    let path = folder.0.join("photo.jpg");
    fs::write(&path, &bytes).unwrap();
    assert!(Photograph::read(&path).is_ok());
    fs::write(&path, &bytes[..bytes.len() - 100]).unwrap();
    let error = Photograph::read(&path).unwrap_err();
    assert!(matches!(error.reason, PhotographReason::CutShort), "{error}");
}
