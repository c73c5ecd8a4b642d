//! Pictures from nearly black to clipped, and noisy ones.

use glam::DVec3;

use super::{evenly, findings, moment};
use crate::photographer::{Films, Sensor, Shot, ToyFile};
use crate::stability::exact::small;
use crate::stability::lab::{Lab, Label};
use crate::stability::row::Findings;

fn sensed(
    lab: &mut Lab,
    label: Label,
    along: &'static str,
    sensors: impl IntoIterator<Item = (f64, Sensor)>,
) -> anyhow::Result<Findings> {
    let world = small();
    let films = Films::of(&world);
    let mut moments = Vec::new();
    for (at, sensor) in sensors {
        let shot = Shot::described(&world, &films.develop(&sensor), &ToyFile::default())?;
        moments.push(moment(lab, at, &shot)?);
    }
    findings(label, along, moments, None)
}

/// Plate and frame with one gain; the same world is photographed for each step.
pub(super) fn brightness(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let sensors = evenly(41, 0.005f64.log10(), 8f64.log10()).map(|power| {
        let gain = DVec3::splat(10f64.powf(power));
        let sensor = Sensor {
            plate_gain: gain,
            frame_gain: gain,
            ..Sensor::default()
        };
        (power, sensor)
    });
    sensed(lab, label, "decimal logarithm of the gain", sensors)
}

/// The same noise with growing amplitude; the truth has none.
pub(super) fn noise(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let sensors = evenly(25, 0.0, 12.0).map(|noise_codes| {
        let sensor = Sensor {
            noise_codes,
            ..Sensor::default()
        };
        (noise_codes, sensor)
    });
    sensed(lab, label, "noise, codes", sensors)
}
