//! Depths of Stray Scanner and of Record3D.

use app_core::session::Session;
use desk::import::{Format, Lacking, Source, read, write};
use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma};
use std::fs;
use std::io::{Cursor, Write};

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

#[test]
fn depths_of_plates_and_of_no_frame_are_not_written() {
    let small = recording("depths-plates", [16, 9]);
    let lacking = Lacking {
        plates: Some("0-0".to_owned()),
        ..lacking()
    };
    let capture = small.import(Format::StrayScanner, &lacking).unwrap().capture;
    assert_eq!((capture.n_frames(), capture.scene().plates.len()), (1, 1));
    assert!(!small.folder.0.join("session/depth").exists());
}

/// Metadata of two frames, with depths of 8 x 6.
const METADATA: &str = r#"{"w": 96, "h": 72, "dw": 8, "dh": 6, "fps": 30, "K": [85, 0, 0, 0, 85, 0, 48, 36, 1],
    "poses": [[0, 0, 0, 1, 0, 0.3, 0.3], [0, 0, 0, 1, 0, 0.3, 0.3]]}"#;

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    lzfse_rust::encode_bytes(bytes, &mut packed).unwrap();
    packed
}

/// The depths of a frame: rising along the rows, two of them unknown.
fn metres() -> Vec<u8> {
    let mut metres: Vec<f32> = (0..48_u8).map(|index| 0.3 + 0.001 * f32::from(index)).collect();
    (metres[1], metres[2]) = (f32::NAN, 0.0);
    metres.iter().flat_map(|metres| metres.to_le_bytes()).collect()
}

/// Files of Record3D. The second frame has no confidences, and its depths are not compressed.
fn record3d() -> Vec<(&'static str, Vec<u8>)> {
    let mut confidences = [2; 48];
    confidences[3] = 0;
    let picture = || {
        let mut bytes = Cursor::new(Vec::new());
        let image = DynamicImage::new_rgb8(96, 72);
        image.write_to(&mut bytes, ImageFormat::Jpeg).unwrap();
        bytes.into_inner()
    };
    vec![
        ("metadata", METADATA.as_bytes().to_vec()),
        ("rgbd/0.jpg", picture()),
        ("rgbd/0.depth", packed(&metres())),
        ("rgbd/0.conf", packed(&confidences)),
        ("rgbd/1.jpg", picture()),
        ("rgbd/1.depth", metres()),
    ]
}

fn assert_depths(capture: &impl Session) {
    let [first, second] = [0, 1].map(|index| capture.frame(index).unwrap().depth.unwrap());
    assert_eq!(first.size_px().to_array(), [8, 6]);
    assert_eq!(first.depths_mm()[..6], [300, 0, 0, 0, 304, 305]);
    assert_eq!(second.depths_mm()[..6], [300, 0, 0, 303, 304, 305]);
    assert_eq!(second.depths_mm()[47], 347);
}

#[test]
fn record3d_has_compressed_depths() {
    let small = Small::new("record3d-depths");
    for (path, bytes) in record3d() {
        small.file(path, &bytes);
    }
    let written = small.import(Format::Record3d, &lacking()).unwrap();
    assert_depths(&written.capture);
    assert!(written.notes.is_empty(), "{:?}", written.notes);
}

#[test]
fn record3d_is_read_from_its_archive() {
    let small = Small::new("record3d-archive");
    let path = small.folder.0.join("a.r3d");
    let mut archive = zip::ZipWriter::new(fs::File::create(&path).unwrap());
    let methods = [zip::CompressionMethod::Stored, zip::CompressionMethod::Deflated];
    for ((name, bytes), method) in record3d().iter().zip(methods.into_iter().cycle()) {
        let options = zip::write::SimpleFileOptions::default().compression_method(method);
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    // No name leads out of the session.
    archive
        .start_file("../rgbd/2.jpg", zip::write::SimpleFileOptions::default())
        .unwrap();
    archive.finish().unwrap();
    let source = Source::open(&path).unwrap();
    let paths = source.paths().unwrap();
    assert_eq!(paths.len(), 6, "{paths:?}");
    let imported = read(Format::Record3d, &source, &paths, None).unwrap();
    let out = small.folder.0.join("session");
    assert_depths(&write("a", &source, &imported, &lacking(), &out).unwrap().capture);

    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let error = Source::open(&path).err().unwrap();
    let error = format!("{error:#}");
    assert!(
        error.contains("a.r3d: neither a folder nor a ZIP archive"),
        "{error}"
    );
}

#[test]
fn depths_that_are_not_of_the_stated_size_are_refused() {
    let four = packed(&metres()[..16]);
    let endless = packed(&vec![0; 1 << 20]);
    let cut = packed(&metres());
    let wrong: [&[u8]; 4] = [&four, &endless, &cut[..cut.len() / 2], b"bvx-"];
    for (case, bytes) in wrong.into_iter().enumerate() {
        for file in ["rgbd/0.depth", "rgbd/0.conf"] {
            let small = Small::new(&format!("record3d-wrong-{case}"));
            for (path, good) in record3d() {
                small.file(path, if path == file { bytes } else { &good });
            }
            let error = small
                .import(Format::Record3d, &lacking())
                .err()
                .unwrap()
                .to_string();
            assert!(error.contains(file) && error.contains("dw x dh"), "{error}");
        }
    }
}

#[test]
fn depths_without_a_size_are_left_out_and_told() {
    let small = Small::new("record3d-no-size");
    for (path, bytes) in record3d() {
        small.file(path, &bytes);
    }
    small.file("metadata", METADATA.replace("\"dw\": 8, ", "").as_bytes());
    let written = small.import(Format::Record3d, &lacking()).unwrap();
    assert!(written.capture.frame(0).unwrap().depth.is_none());
    assert!(
        written.notes.iter().any(|note| note.contains("dw and dh")),
        "{:?}",
        written.notes
    );
}
