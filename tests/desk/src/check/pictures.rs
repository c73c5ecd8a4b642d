//! Picture files that the reader misreads: rotated by a tag, of more than 8 bits, in other colours
//! than sRGB.

use std::collections::HashSet;
use std::io::Cursor;

use app_core::session::{Files, SessionWarning};
use app_session::tags::{exif_orientation, png_chunks};
use image::codecs::{jpeg::JpegDecoder, png::PngDecoder};
use image::{ImageDecoder, Limits};
use serde_json::Value;

use super::icc;

/// Longest picture to read: 16-bit RGBA of the largest allowed size, and room for tags.
const MOST_PICTURE_BYTES: u64 = (8 * 4096 * 3072) + (16 << 20);

/// Values of a PNG's `cICP` chunk: colour primaries, transfer function, matrix, range. Source: ITU-T H.273, tables 2 to 4.
const SRGB_CICP: [u8; 4] = [1, 13, 0, 1];
const DISPLAY_P3_PRIMARIES: u8 = 12;
const BT_2020_PRIMARIES: u8 = 9;
/// A PNG's `gAMA` in 100,000ths: 1 / 2.2, which stands for sRGB's curve as well.
const SRGB_GAMA: u32 = 45_455;
/// A PNG's `cHRM` in 100,000ths: x and y of white, red, green and blue.
const SRGB_CHRM: [u32; 8] = [31_270, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000];
/// Rounding of these values.
const SAME: u32 = 200;

/// The misread pictures of a session's index.
pub(super) fn wrong(session: &dyn Files, index: &Value) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut known = HashSet::new();
    for (field, file) in named(index) {
        if !known.insert(file) {
            continue;
        }
        let bytes = session.read(file, MOST_PICTURE_BYTES).unwrap_or_default();
        let orientation = exif_orientation(&bytes);
        if orientation != 1 {
            let turned = SessionWarning::Turned {
                file: file.to_owned(),
                field: field.clone(),
                orientation,
            };
            wrong.push(turned.to_string());
        }
        // A mask's channels are plain numbers, whatever a profile says, and the reader refuses
        // masks of 16 bits.
        if !field.ends_with("mask") {
            let others = wrong_of_picture(&bytes);
            wrong.extend(others.into_iter().map(|what| format!("{file} ({field}): {what}")));
        }
    }
    wrong
}

/// Each field that names a picture, with the file.
fn named(index: &Value) -> Vec<(String, &str)> {
    let mut named = Vec::new();
    let probe = &index["probe"];
    for (list, entries, keys) in [
        ("backgrounds", &index["backgrounds"], &["image"][..]),
        ("frames", &index["frames"], &["image", "truth", "mask"]),
        ("probe.pictures", &probe["pictures"], &["image"]),
    ] {
        for (number, entry) in entries.as_array().into_iter().flatten().enumerate() {
            for key in keys {
                if let Some(file) = entry[key].as_str() {
                    named.push((format!("{list}[{number}].{key}"), file));
                }
            }
        }
    }
    if let Some(file) = probe["image"].as_str() {
        named.push(("probe.image".to_owned(), file));
    }
    named
}

/// Statements of a photograph's file about its colours that the reader ignores.
#[must_use]
pub fn wrong_of_picture(bytes: &[u8]) -> Vec<String> {
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_PICTURE_BYTES);
    let (n_bits, profile) = if let Ok(mut decoder) = PngDecoder::with_limits(Cursor::new(bytes), limits) {
        (bits(&decoder), decoder.icc_profile())
    } else if let Ok(mut decoder) = JpegDecoder::new(Cursor::new(bytes)) {
        (bits(&decoder), decoder.icc_profile())
    } else {
        // The reader reports it.
        return Vec::new();
    };
    let depth = (n_bits > 8).then(|| {
        format!("{n_bits} bits a channel, which are read as sRGB codes and rounded to 8: save it as sRGB of 8 bits")
    });
    let colours = foreign(bytes, profile.ok().flatten().as_deref())
        .map(|colours| format!("its colours are {colours}, but are read as sRGB: convert it to sRGB"));
    depth.into_iter().chain(colours).collect()
}

fn bits(decoder: &impl ImageDecoder) -> u16 {
    let color = decoder.color_type();
    8 * u16::from(color.bytes_per_pixel()) / u16::from(color.channel_count())
}

/// The colour space of a picture; `None` for sRGB, or if the file does not say.
///
/// Of a PNG's chunks the first of these counts. Source: PNG specification (W3C, third edition),
/// section 4.3.
#[must_use]
pub fn foreign(bytes: &[u8], profile: Option<&[u8]>) -> Option<String> {
    let chunk = |name: &[u8; 4]| {
        png_chunks(bytes)
            .find(|chunk| chunk.0 == *name)
            .map(|chunk| chunk.1)
    };
    if let Some(cicp) = chunk(b"cICP") {
        let primaries = match cicp.first() {
            Some(&DISPLAY_P3_PRIMARIES) => " (Display P3)",
            Some(&BT_2020_PRIMARIES) => " (BT.2020)",
            _ => "",
        };
        return (cicp != SRGB_CICP).then(|| format!("those of cICP {cicp:?}{primaries}"));
    }
    if let Some(profile) = profile {
        return icc::foreign(profile).map(|name| format!("those of the profile {name:?}"));
    }
    if chunk(b"sRGB").is_some() {
        return None;
    }
    let differs = |name, expected: &[u32]| {
        let numbers = chunk(name)?.as_chunks::<4>().0.iter();
        let numbers: Vec<u32> = numbers.map(|number| u32::from_be_bytes(*number)).collect();
        let is_same = numbers.len() == expected.len()
            && numbers
                .iter()
                .zip(expected)
                .all(|(number, expected)| number.abs_diff(*expected) <= SAME);
        (!is_same).then_some(numbers)
    };
    let gama = differs(b"gAMA", &[SRGB_GAMA]).map(|numbers| format!("gAMA {numbers:?}"));
    let chrm = differs(b"cHRM", &SRGB_CHRM).map(|numbers| format!("cHRM {numbers:?}"));
    let both: Vec<String> = gama.into_iter().chain(chrm).collect();
    (!both.is_empty()).then(|| format!("those of {}", both.join(" and ")))
}
