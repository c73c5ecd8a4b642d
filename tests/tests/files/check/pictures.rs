//! Files whose pixels are not in the format that the reader assumes are reported, and other
//! descriptions of sRGB are accepted.

use std::fs;

use desk::files::SESSION_FILE;
use harness::temporary::Temporary;
use image::codecs::{jpeg::JpegEncoder, png::PngEncoder};
use image::{DynamicImage, ImageEncoder};
use serde_json::{Value, json};

use crate::check::wrong;

/// Columns of matrices to XYZ under D50: sRGB's as in the profile of IEC 61966-2-1, and Display
/// P3's as Apple's.
const SRGB: [[f64; 3]; 3] = [
    [0.4361, 0.2225, 0.0139],
    [0.3851, 0.7169, 0.0971],
    [0.1431, 0.0606, 0.7141],
];
const DISPLAY_P3: [[f64; 3]; 3] = [
    [0.5151, 0.2412, -0.0011],
    [0.2919, 0.6922, 0.0419],
    [0.1572, 0.0666, 0.7841],
];
/// sRGB's curve as in profiles of version 4: exponent, then the end of the linear part.
const CURVE: [f64; 5] = [2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045];

fn fixed(value: f64) -> [u8; 4] {
    #[expect(clippy::cast_possible_truncation, reason = "constants below 3")]
    let number = (value * 65_536.0).round() as i32;
    number.to_be_bytes()
}

fn number(length: usize) -> [u8; 4] {
    u32::try_from(length).unwrap().to_be_bytes()
}

fn parametric(curve: &[f64]) -> Vec<u8> {
    let kind = if curve.len() == 1 { 0 } else { 3 };
    let parameters: Vec<u8> = curve.iter().copied().flat_map(fixed).collect();
    [&b"para\0\0\0\0\0"[..], &[kind, 0, 0], &parameters].concat()
}

/// A curve as 1,024 samples.
fn sampled() -> Vec<u8> {
    let sample = |index: u16| {
        let linear = app_scene::geometry::color::linear_from_srgb(f32::from(index) / 1023.0);
        #[expect(clippy::cast_possible_truncation, reason = "from 0 to 65,535")]
        let sample = (65_535.0 * linear).round() as u16;
        sample.to_be_bytes()
    };
    let samples: Vec<u8> = (0..1024).flat_map(sample).collect();
    [&b"curv\0\0\0\0"[..], &number(1024), &samples].concat()
}

/// A profile of a matrix and one curve.
fn icc(name: &str, columns: &[[f64; 3]; 3], curve: Vec<u8>) -> Vec<u8> {
    let column = |column: &[f64; 3]| [&b"XYZ \0\0\0\0"[..], &column.map(fixed).concat()].concat();
    let units: Vec<u8> = name.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let name = [
        &b"mluc\0\0\0\0"[..],
        &number(1),
        &number(12),
        b"enUS",
        &number(units.len()),
        &number(28),
        &units,
    ]
    .concat();
    let [red, green, blue] = [0, 1, 2].map(|index| column(&columns[index]));
    let tags = [
        (b"desc", name),
        (b"rXYZ", red),
        (b"gXYZ", green),
        (b"bXYZ", blue),
        (b"rTRC", curve.clone()),
        (b"gTRC", curve.clone()),
        (b"bTRC", curve),
    ];
    let mut table = number(tags.len()).to_vec();
    let mut data = Vec::new();
    for (tag, bytes) in &tags {
        table.extend(
            [
                &tag[..],
                &number(128 + 4 + 12 * tags.len() + data.len()),
                &number(bytes.len()),
            ]
            .concat(),
        );
        data.extend(bytes);
    }
    let mut header = vec![0; 128];
    header[8] = 4;
    header[12..24].copy_from_slice(b"mntrRGB XYZ ");
    header[36..40].copy_from_slice(b"acsp");
    [header, table, data].concat()
}

/// EXIF of one entry: turned to the right.
const TURNED: &[u8] = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";

fn photo() -> DynamicImage {
    DynamicImage::new_rgb8(2, 2)
}

fn png(photo: &DynamicImage, profile: Option<Vec<u8>>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = PngEncoder::new(&mut bytes);
    if let Some(profile) = profile {
        encoder.set_icc_profile(profile).unwrap();
    }
    photo.write_with_encoder(encoder).unwrap();
    bytes
}

fn jpeg(profile: Option<Vec<u8>>, exif: Option<&[u8]>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new(&mut bytes);
    if let Some(profile) = profile {
        encoder.set_icc_profile(profile).unwrap();
    }
    if let Some(exif) = exif {
        encoder.set_exif_metadata(exif.to_vec()).unwrap();
    }
    photo().write_with_encoder(encoder).unwrap();
    bytes
}

/// A PNG with chunks before its pixels; the last of them comes first.
fn with_chunks(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut bytes = png(&photo(), None);
    for (name, data) in chunks {
        let named = [&name[..], data].concat();
        let chunk = [
            &number(data.len())[..],
            &named,
            &crc32fast::hash(&named).to_be_bytes(),
        ]
        .concat();
        // After the header.
        bytes.splice(33..33, chunk);
    }
    bytes
}

/// The warnings for a session with these pictures as its frames, except for those about the missing
/// toy.
fn said(pictures: &[(&str, Vec<u8>)]) -> Vec<String> {
    let entries: Vec<_> = pictures
        .iter()
        .map(|(name, _)| json!({ "image": name }))
        .collect();
    said_of(&json!({ "frames": entries }), pictures)
}

/// The same for an index that names them.
fn said_of(index: &Value, pictures: &[(&str, Vec<u8>)]) -> Vec<String> {
    let session = Temporary::new("pictures");
    fs::write(session.0.join(SESSION_FILE), index.to_string()).unwrap();
    for (name, bytes) in pictures {
        fs::write(session.0.join(name), bytes).unwrap();
    }
    let mut wrong = wrong(&session.0);
    wrong.retain(|line| !line.starts_with(SESSION_FILE));
    wrong
}

#[test]
fn what_is_not_read_as_meant_is_named_with_its_file() {
    let wide = icc("Display P3", &DISPLAY_P3, parametric(&CURVE));
    let chrm: Vec<u8> = [31_270, 32_900, 68_000, 32_000, 26_500, 69_000, 15_000, 6_000]
        .into_iter()
        .flat_map(u32::to_be_bytes)
        .collect();
    #[rustfmt::skip] // One case a line.
    let cases: [(&str, Vec<u8>, &[&str]); 8] = [
        ("turned.jpg", jpeg(None, Some(TURNED)), &["orientation is 6", "turn its pixels"]),
        ("deep.png", png(&DynamicImage::new_rgb16(2, 2), None), &["16 bits a channel", "8 bits"]),
        ("wide.jpg", jpeg(Some(wide.clone()), None), &["\"Display P3\"", "convert it to sRGB"]),
        ("wide.png", png(&photo(), Some(wide)), &["\"Display P3\""]),
        ("power.png", png(&photo(), Some(icc("old", &SRGB, parametric(&[1.8])))), &["\"old\""]),
        ("cicp.png", with_chunks(&[(b"cICP", &[12, 13, 0, 1])]), &["Display P3"]),
        ("gama.png", with_chunks(&[(b"gAMA", &100_000_u32.to_be_bytes())]), &["gAMA [100000]"]),
        ("chrm.png", with_chunks(&[(b"cHRM", &chrm)]), &["cHRM [31270, 32900, 68000"]),
    ];
    let pictures: Vec<(&str, Vec<u8>)> = cases
        .iter()
        .map(|(name, bytes, _)| (*name, bytes.clone()))
        .collect();
    let said = said(&pictures);
    assert_eq!(said.len(), cases.len(), "{said:#?}");
    for (index, ((name, _, expected), line)) in cases.iter().zip(&said).enumerate() {
        assert!(
            line.starts_with(&format!("{name} (frames[{index}].image): ")),
            "{line}"
        );
        assert!(expected.iter().all(|expected| line.contains(expected)), "{line}");
    }
}

#[test]
fn every_picture_of_a_probe_is_looked_at() {
    let index =
        json!({ "probe": { "image": "a.jpg", "pictures": [{ "image": "b.jpg" }, { "image": "c.png" }] } });
    let pictures = [
        ("a.jpg", jpeg(None, Some(TURNED))),
        ("b.jpg", jpeg(None, Some(TURNED))),
        ("c.png", png(&DynamicImage::new_rgb16(2, 2), None)),
    ];
    let mut said = said_of(&index, &pictures);
    said.sort();
    let expected = [
        "a.jpg (probe.image): its EXIF orientation is 6",
        "b.jpg (probe.pictures[0].image): its EXIF orientation is 6",
        "c.png (probe.pictures[1].image): 16 bits a channel",
    ];
    assert_eq!(said.len(), expected.len(), "{said:#?}");
    for (line, expected) in said.iter().zip(expected) {
        assert!(line.starts_with(expected), "{line}");
    }
}

#[test]
fn what_is_srgb_in_other_words_is_not() {
    let gama = |value: u32| value.to_be_bytes();
    #[rustfmt::skip] // One picture a line.
    let pictures = [
        ("plain.png", png(&photo(), None)),
        ("plain.jpg", jpeg(None, None)),
        ("upright.jpg", jpeg(None, Some(&[&TURNED[..19], &[1], &TURNED[20..]].concat()))),
        ("parametric.jpg", jpeg(Some(icc("mine", &SRGB, parametric(&CURVE))), None)),
        ("sampled.png", png(&photo(), Some(icc("mine", &SRGB, sampled())))),
        ("power.png", png(&photo(), Some(icc("mine", &SRGB, parametric(&[2.2]))))),
        ("gama.png", with_chunks(&[(b"gAMA", &gama(45_455))])),
        // The first in the order of the specification counts.
        ("srgb.png", with_chunks(&[(b"gAMA", &gama(100_000)), (b"sRGB", &[0])])),
        ("cicp.png", with_chunks(&[(b"cICP", &[1, 13, 0, 1]), (b"gAMA", &gama(100_000))])),
    ];
    assert_eq!(said(&pictures), Vec::<String>::new());
}

#[test]
fn a_profile_that_is_cut_anywhere_is_foreign_and_no_panic() {
    let whole = icc("mine", &SRGB, parametric(&CURVE));
    let cut: Vec<(String, Vec<u8>)> = (1..whole.len())
        .step_by(37)
        .map(|length| {
            (
                format!("{length}.jpg"),
                jpeg(Some(whole[..length].to_vec()), None),
            )
        })
        .collect();
    let pictures: Vec<(&str, Vec<u8>)> = cut
        .iter()
        .map(|(name, bytes)| (name.as_str(), bytes.clone()))
        .collect();
    let said = said(&pictures);
    assert_eq!(said.len(), pictures.len(), "{said:#?}");
}
