//! Fits that the photographs do not constrain: the result is finite, and a warning reports it.

use app_core::frame::Warning;
use bytemuck::cast_slice;
use glam::DVec3;

use super::case::{Case, Scope};
use super::exact::small;
use super::lab::{Lab, Label};
use super::row::{Bound, Findings};
use crate::photographer::world::{camera, toward};
use crate::photographer::{Lamp, Sensor, Shot, World};
use desk::metrics::score;

const FINITE: Bound = Bound {
    limit: 0.0,
    unit: "numbers",
    meaning: "numbers of the fit that are not finite",
};
const WARNED: Bound = Bound {
    limit: 0.0,
    unit: "warnings",
    meaning: "warnings that are due and missing",
};
const SILENT: Bound = Bound {
    limit: 0.0,
    unit: "warnings",
    meaning: "warnings of a fit that nothing is wrong with",
};
const WORSE: Bound = Bound {
    limit: 1.0,
    unit: "codes",
    meaning: "shadow's RMSE, less that of the camera frame as it is",
};
const GROUP: &str = "ill-posed";

/// The group's cases.
pub(super) const CASES: &[Case] = &[
    Case::new(GROUP, "well-posed", Scope::Whole, well_posed),
    Case::new(GROUP, "two-near-parallel", Scope::Whole, |lab, label| {
        near_parallel(lab, label, 2)
    }),
    Case::new(GROUP, "four-near-parallel", Scope::Whole, |lab, label| {
        near_parallel(lab, label, 4)
    }),
    Case::new(GROUP, "two-at-one-place", Scope::Quick, two_at_one_place),
    Case::new(GROUP, "shadow-hidden", Scope::Whole, shadow_hidden),
    Case::new(GROUP, "shadow-out-of-frame", Scope::Whole, shadow_out_of_frame),
    Case::new(GROUP, "saturated", Scope::Whole, |lab, label| {
        exposed(lab, label, 12.0)
    }),
    Case::new(GROUP, "dark", Scope::Whole, |lab, label| {
        exposed(lab, label, 0.004)
    }),
];

/// Whether a warning says that the visible pixels do not constrain the fit.
fn is_of_the_fit(warning: &Warning) -> bool {
    !matches!(warning, Warning::Outlier(_) | Warning::PlatePartial { .. })
}

fn judge(lab: &mut Lab, label: Label, world: &World, is_due: bool) -> anyhow::Result<Findings> {
    let shot = Shot::of(world)?;
    let picture = lab.picture(&shot)?;
    let scores = score(&picture, &shot.truth)?;
    let warnings = lab.warnings()?;
    let said: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    let fit = lab.fit()?;
    let n_not_finite = fit.as_ref().map_or(0, |fit| {
        let numbers: &[f32] = cast_slice(bytemuck::bytes_of(fit));
        numbers.iter().filter(|number| !number.is_finite()).count()
    });
    let mut finite = label.row("fit", FINITE, n_not_finite as f64);
    finite.note = fit.map_or_else(
        || "no fit: the frame passes through".to_owned(),
        |fit| format!("clipped {:.4}", fit.receivers[0].clipped[1]),
    );
    let n_of_fit = warnings.iter().filter(|warning| is_of_the_fit(warning)).count();
    let mut warned = if is_due {
        label.row("warning", WARNED, if n_of_fit == 0 { 1.0 } else { 0.0 })
    } else {
        let n = n_of_fit as f64;
        label.row("warning", SILENT, n)
    };
    warned.note = said.join("; ");
    let floor = score(shot.input.image.rgba(), &shot.truth)?;
    let mut shadow = label.row("picture", WORSE, scores.shadow.rmse - floor.shadow.rmse);
    shadow.note = format!(
        "shadow {:.2} after {:.2}, toy {:.2}",
        scores.shadow.rmse, floor.shadow.rmse, scores.toy.rmse
    );
    Ok(vec![finite, warned, shadow].into())
}

/// A shadow that falls towards the camera.
fn well_posed(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let lamp = Lamp::bulb(toward(50.0, 200.0), 0.01, 0.75);
    judge(lab, label, &small().lit_by(vec![lamp]), false)
}

/// Bulbs within millimetres of each other.
fn near_parallel(lab: &mut Lab, label: Label, n_lights: u8) -> anyhow::Result<Findings> {
    let brightness = 0.75 / f64::from(n_lights);
    let lamps = (0..n_lights).map(|light| {
        let place = toward(50.0, 35.0) + 0.003 * f64::from(light) * DVec3::X;
        Lamp::bulb(place, 0.01, brightness)
    });
    judge(lab, label, &small().lit_by(lamps.collect()), true)
}

fn two_at_one_place(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let lamp = Lamp::bulb(toward(50.0, 35.0), 0.01, 0.375);
    judge(lab, label, &small().lit_by(vec![lamp; 2]), true)
}

/// A point light at the camera: the shadow is hidden behind the toy.
fn shadow_hidden(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = small();
    let eye = world.camera.world_from_camera.w_axis.truncate();
    let lamp = Lamp::bulb(eye, 0.0, 0.75 * eye.length_squared());
    judge(lab, label, &world.lit_by(vec![lamp]), true)
}

/// The camera shows the toy's upper part and the table beyond; the shadow falls towards the camera.
fn shadow_out_of_frame(lab: &mut Lab, label: Label) -> anyhow::Result<Findings> {
    let world = small();
    let eye = DVec3::new(0.06, 0.24, 0.36);
    let camera = camera(world.size_px, eye, DVec3::new(-0.06, 0.14, -0.2));
    let lamp = Lamp::bulb(toward(35.0, 200.0), 0.01, 0.75);
    judge(lab, label, &World { camera, ..world }.lit_by(vec![lamp]), true)
}

fn exposed(lab: &mut Lab, label: Label, gain: f64) -> anyhow::Result<Findings> {
    let mut world = small();
    world.sensor = Sensor {
        plate_gain: DVec3::splat(gain),
        frame_gain: DVec3::splat(gain),
        ..Sensor::default()
    };
    judge(lab, label, &world, true)
}
