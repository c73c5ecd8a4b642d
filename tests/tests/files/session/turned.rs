//! A picture with an orientation tag is read as stored, and a warning reports that.

use app_core::session::{Session, SessionWarning};
use image::codecs::{jpeg::JpegEncoder, png::PngEncoder};
use image::{DynamicImage, ImageEncoder};
use serde_json::json;

use crate::session::parts::Parts;

/// EXIF of one entry, the orientation, in either byte order.
fn exif(orientation: u8, is_big: bool) -> Vec<u8> {
    let ordered = |mut bytes: Vec<u8>| {
        if !is_big {
            bytes.reverse();
        }
        bytes
    };
    let number = |number: u16| ordered(number.to_be_bytes().to_vec());
    let long = |number: u32| ordered(number.to_be_bytes().to_vec());
    let magic = if is_big { b"MM" } else { b"II" };
    let value = number(u16::from(orientation));
    [
        &magic[..],
        &number(42),
        &long(8),
        &number(1),
        &number(0x112),
        &number(3),
        &long(1),
        &value,
        &[0; 6],
    ]
    .concat()
}

fn photo() -> DynamicImage {
    let mut photo = DynamicImage::new_rgb8(2, 2).into_rgb8();
    photo.put_pixel(1, 0, image::Rgb([200, 200, 200]));
    photo.into()
}

fn jpeg(orientation: u8) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new(&mut bytes);
    encoder.set_exif_metadata(exif(orientation, true)).unwrap();
    photo().write_with_encoder(encoder).unwrap();
    bytes
}

/// A PNG whose tag is before or after the pixels.
fn png(orientation: u8, is_behind: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    let exif = exif(orientation, false);
    if is_behind {
        photo().write_with_encoder(encoder).unwrap();
        let named = [&b"eXIf"[..], &exif].concat();
        let length = u32::try_from(exif.len()).unwrap().to_be_bytes();
        let chunk = [&length[..], &named, &crc32fast::hash(&named).to_be_bytes()].concat();
        // Before the end, which is a chunk of 12 bytes.
        let end = bytes.len() - 12;
        bytes.splice(end..end, chunk);
    } else {
        encoder.set_exif_metadata(exif).unwrap();
        photo().write_with_encoder(encoder).unwrap();
    }
    bytes
}

#[test]
fn a_turned_picture_is_taken_as_stored_and_said_to_be() {
    let plain = png(1, false);
    let upright = {
        let mut parts = Parts::good();
        parts.files.insert("frame.png".to_owned(), plain);
        let capture = parts.open().unwrap();
        let frame = capture.frame(0).unwrap();
        assert!(capture.warnings().is_empty() && frame.warnings.is_empty());
        frame.image
    };
    for orientation in 2..=8 {
        for is_behind in [false, true] {
            let mut parts = Parts::good();
            parts
                .files
                .insert("frame.png".to_owned(), png(orientation, is_behind));
            parts.files.insert("plate.jpg".to_owned(), jpeg(orientation));
            let capture = parts.open().unwrap();
            let turned = |file: &str, field: &str| SessionWarning::Turned {
                file: file.to_owned(),
                field: field.to_owned(),
                orientation,
            };
            // Plate and both pictures of the probe, then each frame, whether or not its picture was
            // read for another.
            let expected = [
                turned("plate.jpg", "backgrounds[0].image"),
                turned("frame.png", "probe.image"),
                turned("frame.png", "probe.pictures[0].image"),
            ];
            assert_eq!(capture.warnings(), expected);
            for index in [0, 1, 0] {
                let frame = capture.frame(index).unwrap();
                assert_eq!(
                    frame.warnings,
                    [turned("frame.png", &format!("frames[{index}].image"))]
                );
                assert_eq!(frame.image, upright);
            }
        }
    }
}

#[test]
fn what_is_no_orientation_is_none() {
    for orientation in [0, 9, 255] {
        let mut parts = Parts::good();
        parts.files.insert("plate.jpg".to_owned(), jpeg(orientation));
        parts.set("frames[0].image", json!("plate.jpg"));
        let capture = parts.open().unwrap();
        assert!(capture.warnings().is_empty() && capture.frame(0).unwrap().warnings.is_empty());
    }
}
