//! Uncertainty of given values, from `capture.json`.

use std::f64::consts::PI;

use super::field::at;
use super::record::{PoseUncertaintyRecord, UncertaintyRecord};
use crate::error::SessionError;
use app_scene::scene::{LightUncertainty, PoseUncertainty, Uncertainty, check};

/// Radians that do not exceed half a turn by rounding.
fn radians(degrees: f64) -> f64 {
    degrees.to_radians().min(PI)
}

pub(super) fn uncertainty(field: &str, record: &UncertaintyRecord) -> Result<Uncertainty, SessionError> {
    let number = |name: &str, value: Option<f64>, range| {
        let value = value.map(|value| at(&format!("{field}.{name}"), check::number(value, range)));
        value.transpose()
    };
    let pose = |name: &str, record: Option<&PoseUncertaintyRecord>| {
        let Some(record) = record else {
            return Ok(PoseUncertainty::default());
        };
        let position = number(
            &format!("{name}.position"),
            record.position,
            &check::UNCERTAINTY_M,
        )?;
        let rotation = number(
            &format!("{name}.rotation_deg"),
            record.rotation_deg,
            &check::UNCERTAINTY_DEG,
        )?;
        Ok(PoseUncertainty {
            position_m: position,
            rotation_rad: rotation.map(radians),
        })
    };
    let lights = match &record.lights {
        None => LightUncertainty::default(),
        Some(lights) => LightUncertainty {
            direction_rad: number(
                "lights.direction_deg",
                lights.direction_deg,
                &check::UNCERTAINTY_DEG,
            )?
            .map(radians),
            distance_ratio: number(
                "lights.distance_ratio",
                lights.distance_ratio,
                &check::UNCERTAINTY_RATIO,
            )?,
            size_ratio: number("lights.size_ratio", lights.size_ratio, &check::UNCERTAINTY_RATIO)?,
        },
    };
    Ok(Uncertainty {
        toy: pose("toy", record.toy.as_ref())?,
        camera: pose("camera", record.camera.as_ref())?,
        lights,
        are_receivers_guessed: record.receivers_guessed.unwrap_or(false),
    })
}
