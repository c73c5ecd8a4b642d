//! Whether an ICC profile is that of sRGB.
//!
//! There are dozens of profiles of sRGB, so the colours that they stand for are compared, not their bytes or names.
//! Source: ICC.1:2022, sections 7.2, 7.3, 9.2 and 10.

use app_scene::geometry::color::linear_from_srgb;

/// The columns of sRGB's matrix to XYZ under D50, as its profiles have them: red, green, blue.
const SRGB_COLUMNS: [[f64; 3]; 3] = [
    [0.4361, 0.2225, 0.0139],
    [0.3851, 0.7169, 0.0971],
    [0.1431, 0.0606, 0.7141],
];
/// Where profiles of sRGB differ among one another; Display P3's red is 0.08 off.
const SAME_COLUMN: f64 = 0.005;
/// The same of their curves, in linear light. A power of 2.2 is within it, one of 1.8 is 0.06 off.
const SAME_LINEAR: f64 = 0.01;
/// Where curves are compared, besides both ends.
const N_STEPS: u8 = 16;
/// A longer name is cut.
const MOST_NAME_CHARS: usize = 60;

/// The name of a profile whose colours are not sRGB's, or cannot be told; none of one whose are.
pub(super) fn foreign(profile: &[u8]) -> Option<String> {
    let is_srgb = match profile.get(16..20) {
        Some(b"RGB ") => {
            has_columns(profile)
                && [b"rTRC", b"gTRC", b"bTRC"]
                    .iter()
                    .all(|name| has_curve(profile, name))
        }
        Some(b"GRAY") => has_curve(profile, b"kTRC"),
        _ => false,
    };
    (!is_srgb).then(|| name(profile).unwrap_or_else(|| "without a name".to_owned()))
}

fn has_columns(profile: &[u8]) -> bool {
    let names = [b"rXYZ", b"gXYZ", b"bXYZ"];
    names.iter().zip(&SRGB_COLUMNS).all(|(name, expected)| {
        let column = tag(profile, name);
        expected.iter().enumerate().all(|(row, expected)| {
            let value = column.and_then(|column| fixed(column, 8 + 4 * row));
            value.is_some_and(|value| (value - expected).abs() <= SAME_COLUMN)
        })
    })
}

fn has_curve(profile: &[u8], name: &[u8; 4]) -> bool {
    let Some(curve) = tag(profile, name) else {
        return false;
    };
    (0..=N_STEPS).all(|step| {
        let code = f64::from(step) / f64::from(N_STEPS);
        #[allow(clippy::cast_possible_truncation, reason = "a seventeenth of 1")]
        let expected = f64::from(linear_from_srgb(code as f32));
        linear(curve, code).is_some_and(|linear| (linear - expected).abs() <= SAME_LINEAR)
    })
}

/// The data of a tag, its type first.
fn tag<'a>(profile: &'a [u8], name: &[u8; 4]) -> Option<&'a [u8]> {
    let n_tags = usize::try_from(u32_at(profile, 128)?).ok()?;
    let entries = profile.get(132..)?.chunks_exact(12).take(n_tags);
    let entry = entries.into_iter().find(|entry| entry.starts_with(name))?;
    let [start, length] = [4, 8].map(|at| u32_at(entry, at).and_then(|value| usize::try_from(value).ok()));
    let start = start?;
    profile.get(start..start.checked_add(length?)?)
}

/// What a curve makes of a code from 0 to 1.
fn linear(curve: &[u8], code: f64) -> Option<f64> {
    match curve.get(..4)? {
        b"curv" => sampled(curve, code),
        b"para" => parametric(curve, code),
        _ => None,
    }
}

fn sampled(curve: &[u8], code: f64) -> Option<f64> {
    let n_samples = usize::try_from(u32_at(curve, 8)?).ok()?;
    let sample = |index: usize| u16_at(curve, 12 + 2 * index).map(f64::from);
    match n_samples {
        0 => Some(code),
        1 => Some(code.powf(sample(0)? / 256.0)),
        _ => {
            // More cannot be in a file; an index beyond it finds nothing.
            let last = u32::try_from(n_samples - 1).ok()?;
            let at = code * f64::from(last);
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "from 0 to a number of 32 bits"
            )]
            let below = (at.floor() as usize).min(n_samples - 2);
            #[allow(clippy::cast_precision_loss, reason = "below 2^32")]
            let part = at - below as f64;
            Some((sample(below)? * (1.0 - part) + sample(below + 1)? * part) / 65_535.0)
        }
    }
}

fn parametric(curve: &[u8], code: f64) -> Option<f64> {
    let kind = u16_at(curve, 8)?;
    let n_parameters = *[1, 3, 4, 5, 7].get(usize::from(kind))?;
    let mut given = [0.0; 7];
    for (index, value) in given.iter_mut().take(n_parameters).enumerate() {
        *value = fixed(curve, 12 + 4 * index)?;
    }
    let [g, a, b, c, d, e, f] = given;
    let power = |a: f64| (a * code + b).max(0.0).powf(g);
    Some(match kind {
        0 => power(1.0),
        1 if a * code + b >= 0.0 => power(a),
        1 => 0.0,
        2 if a * code + b >= 0.0 => power(a) + c,
        2 => c,
        _ if code >= d => power(a) + e,
        _ => c * code + f,
    })
}

/// The description of a profile: ASCII up to version 2, the first of its translations from version 4.
fn name(profile: &[u8]) -> Option<String> {
    let text = tag(profile, b"desc")?;
    let start = if text.starts_with(b"mluc") {
        u32_at(text, 24)?
    } else {
        12
    };
    let n_bytes = u32_at(text, if text.starts_with(b"mluc") { 20 } else { 8 })?;
    let start = usize::try_from(start).ok()?;
    let bytes = text.get(start..start.checked_add(usize::try_from(n_bytes).ok()?)?)?;
    let name = if text.starts_with(b"mluc") {
        let units: Vec<u16> = bytes
            .as_chunks()
            .0
            .iter()
            .map(|unit| u16::from_be_bytes(*unit))
            .collect();
        String::from_utf16_lossy(&units)
    } else {
        String::from_utf8_lossy(bytes).into_owned()
    };
    let name: String = name
        .chars()
        .filter(|letter| !letter.is_control())
        .take(MOST_NAME_CHARS)
        .collect();
    (!name.is_empty()).then_some(name)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes
        .get(at..)?
        .first_chunk()
        .map(|bytes| u16::from_be_bytes(*bytes))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes
        .get(at..)?
        .first_chunk()
        .map(|bytes| u32::from_be_bytes(*bytes))
}

/// A number of 16 bits before the point and as many behind it.
fn fixed(bytes: &[u8], at: usize) -> Option<f64> {
    let number = bytes
        .get(at..)?
        .first_chunk()
        .map(|bytes| i32::from_be_bytes(*bytes))?;
    Some(f64::from(number) / 65_536.0)
}
