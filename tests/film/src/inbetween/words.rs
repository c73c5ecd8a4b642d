//! The corrections of keys, in sentences.

use super::keys::{Found, Keys, PoseDifference};

/// Smaller differences are not reported.
const LEAST_PRINT_M: f64 = 1e-4;
const LEAST_PRINT_RAD: f64 = 0.001_75;
/// Channels that differ by more than this, as a fraction of the light, are reported one by one.
const ONE_COLOR: f64 = 0.005;

/// A sentence for each thing that differs from key to key, with the number of the key, from 0.
#[must_use]
pub fn findings(keys: &Keys) -> Vec<String> {
    let mut lines = Vec::new();
    for (index, key) in keys.keys.iter().enumerate() {
        let found = &key.found;
        let said = [camera(found), print(found, keys.is_mark), exposure(found)];
        lines.extend(
            said.into_iter()
                .flatten()
                .map(|line| format!("key {index}: {line}")),
        );
        lines.extend(
            found
                .warnings
                .iter()
                .map(|warning| format!("key {index}: warning: {warning}")),
        );
    }
    if !keys.is_mark {
        lines.push(
            "the prints stand far from the mark; all frames show the toy where print 0 stands".to_owned(),
        );
    }
    if lines.is_empty() {
        lines.push("all keys have one camera, one exposure and one place of the toy".to_owned());
    }
    lines
}

fn camera(found: &Found) -> Option<String> {
    let PoseDifference {
        moved_px,
        moved_m,
        turned_rad,
    } = found.camera?;
    Some(format!(
        "the camera moved by {moved_px:.1} px at the corners ({:.2} mm, {:.3} degrees) from the reference; corrected",
        1e3 * moved_m,
        turned_rad.to_degrees()
    ))
}

fn print(found: &Found, is_mark: bool) -> Option<String> {
    let off = found.print?;
    if off.moved_m < LEAST_PRINT_M && off.turned_rad < LEAST_PRINT_RAD {
        return None;
    }
    let place = if is_mark { "its mark" } else { "print 0" };
    Some(format!(
        "the print stands {:.1} mm and {:.1} degrees off {place} ({:.1} px); corrected",
        1e3 * off.moved_m,
        off.turned_rad.to_degrees(),
        off.moved_px
    ))
}

fn exposure(found: &Found) -> Option<String> {
    let [red, green, blue] = found.gains;
    if found.gains == [1.0; 3] {
        return None;
    }
    let spread = red.max(green).max(blue) - red.min(green).min(blue);
    if spread < ONE_COLOR {
        let change = 100.0 / green - 100.0;
        let word = if change < 0.0 { "darker" } else { "brighter" };
        return Some(format!(
            "the photograph is {:.1} % {word} than the reference; corrected",
            change.abs()
        ));
    }
    let [red, green, blue] = found.gains.map(|gain| 100.0 / gain - 100.0);
    Some(format!(
        "the photograph's red is {red:+.1} %, its green {green:+.1} % and its blue {blue:+.1} % off the reference; corrected"
    ))
}
