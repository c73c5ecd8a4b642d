//! A platform's light estimate, from `capture.json`.

use super::field::at;
use super::record::LightEstimateRecord;
use crate::error::SessionError;
use app_scene::scene::{LightEstimate, check};

pub(super) fn light_estimate(
    field: &str,
    record: &LightEstimateRecord,
) -> Result<LightEstimate, SessionError> {
    let number = |name: &str, value, range| at(&format!("{field}.{name}"), check::number(value, range));
    let direction = record.direction_to_light.map(check::direction).transpose();
    for (index, intensity) in record.intensity.iter().flatten().enumerate() {
        number(&format!("intensity[{index}]"), *intensity, &check::INTENSITY)?;
    }
    for (index, one) in record.spherical_harmonics.iter().flatten().enumerate() {
        number(&format!("spherical_harmonics[{index}]"), *one, &check::HARMONIC)?;
    }
    let optional =
        |name: &str, value: Option<f64>, range| value.map(|value| number(name, value, range)).transpose();
    Ok(LightEstimate {
        direction_to_light_in_world: at(&format!("{field}.direction_to_light"), direction)?,
        intensity: record.intensity,
        ambient_intensity: optional("ambient_intensity", record.ambient_intensity, &check::INTENSITY)?,
        color_temperature_k: optional("color_temperature", record.color_temperature, &check::KELVIN)?,
        spherical_harmonics: record.spherical_harmonics,
    })
}
