//! Depths of Stray Scanner.

use app_core::session::Session;
use desk::import::Format;
use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma};
use std::io::Cursor;

use crate::imported::small::{Small, grey, lacking};

const ODOMETRY: &str = "timestamp, frame, x, y, z, qx, qy, qz, qw\n\
0.0, 000000, 0, 0.3, 0.3, 1, 0, 0, 0\n0.1, 000001, 0, 0.3, 0.3, 1, 0, 0, 0\n";
const MATRIX: &str = "170, 0, 96\n0, 170, 54\n0, 0, 1\n";

fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Two frames; the first one has depths.
fn recording(name: &str, [width, height]: [u32; 2]) -> Small {
    let small = Small::new(name);
    small.file("odometry.csv", ODOMETRY.as_bytes());
    small.file("camera_matrix.csv", MATRIX.as_bytes());
    for frame in 0..2 {
        small.picture(&format!("rgb/00000{frame}.png"), &grey([192, 108]));
    }
    let depths = ImageBuffer::from_fn(width, height, |x, _| Luma([300 + u16::try_from(x).unwrap()]));
    small.file("depth/000000.png", &png(DynamicImage::ImageLuma16(depths)));
    let confidences = GrayImage::from_fn(width, height, |x, _| Luma([u8::try_from(x % 3).unwrap()]));
    small.file("confidence/000000.png", &png(confidences));
    small
}

#[test]
fn depths_come_along_without_those_of_low_confidence() {
    let small = recording("depths", [16, 9]);
    let capture = small.import(Format::StrayScanner, &lacking()).unwrap().capture;
    let depth = capture.frame(0).unwrap().depth.unwrap();
    assert_eq!(depth.size_px().to_array(), [16, 9]);
    assert_eq!(depth.depths_mm()[..6], [0, 301, 302, 0, 304, 305]);
    assert!(capture.frame(1).unwrap().depth.is_none());
}

#[test]
fn depths_of_another_shape_are_refused() {
    let small = recording("depths-turned", [9, 16]);
    let error = small
        .import(Format::StrayScanner, &lacking())
        .err()
        .unwrap()
        .to_string();
    assert!(
        error.contains("frames[0].depth") && error.contains("9 x 16 px, which is not the shape"),
        "{error}"
    );
    assert!(!small.folder.0.join("session").exists());
}
