//! Whether an ICC profile is that of sRGB.
//!
//! There are dozens of profiles of sRGB, so the profiles' colours are compared, not their bytes or
//! names.

use app_scene::geometry::color::linear_from_srgb;
use moxcms::{ColorProfile, DataColorSpace, ProfileText, ToneReprCurve};

/// Largest difference among profiles of sRGB; Display P3's red is 0.08 off.
const SAME_COLUMN: f64 = 0.005;
/// The same for their curves, in linear light. A power of 2.2 is within it, one of 1.8 is 0.06 off.
const SAME_LINEAR: f32 = 0.01;
/// Number of points at which curves are compared, besides both ends.
const N_STEPS: u8 = 16;
/// Longer names are cut.
const MOST_NAME_CHARS: usize = 60;

/// The name of a profile whose colours are not sRGB's, or are unknown; `None` for sRGB.
pub(super) fn foreign(profile: &[u8]) -> Option<String> {
    let profile = ColorProfile::new_from_slice(profile).ok();
    if profile.as_ref().is_some_and(is_srgb) {
        return None;
    }
    let name = profile.and_then(|profile| name(&profile));
    Some(name.unwrap_or_else(|| "without a name".to_owned()))
}

fn is_srgb(profile: &ColorProfile) -> bool {
    match profile.color_space {
        DataColorSpace::Rgb => {
            has_columns(profile)
                && [&profile.red_trc, &profile.green_trc, &profile.blue_trc]
                    .into_iter()
                    .all(|curve| has_curve(curve.as_ref()))
        }
        DataColorSpace::Gray => has_curve(profile.gray_trc.as_ref()),
        _ => false,
    }
}

/// Whether the matrix to XYZ under D50 is sRGB's.
fn has_columns(profile: &ColorProfile) -> bool {
    let [own, expected] = [profile, &ColorProfile::new_srgb()].map(|profile| profile.colorant_matrix().v);
    let pairs = own.as_flattened().iter().zip(expected.as_flattened());
    pairs
        .map(|(own, expected)| (own - expected).abs())
        .all(|off| off <= SAME_COLUMN)
}

fn has_curve(curve: Option<&ToneReprCurve>) -> bool {
    let Some(Ok(curve)) = curve.map(ToneReprCurve::make_linear_evaluator) else {
        return false;
    };
    (0..=N_STEPS).all(|step| {
        let code = f32::from(step) / f32::from(N_STEPS);
        (curve.evaluate_value(code) - linear_from_srgb(code)).abs() <= SAME_LINEAR
    })
}

/// The description of a profile, the first of its translations.
#[must_use]
pub fn name(profile: &ColorProfile) -> Option<String> {
    let name = match profile.description.as_ref()? {
        ProfileText::PlainString(text) => text,
        ProfileText::Localizable(texts) => &texts.first()?.value,
        ProfileText::Description(text) => &text.ascii_string,
    };
    let letters = name.chars().filter(|letter| !letter.is_control());
    let name: String = letters.take(MOST_NAME_CHARS).collect();
    (!name.is_empty()).then_some(name)
}
