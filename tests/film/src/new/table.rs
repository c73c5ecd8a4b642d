//! Estimates the table's height from the toy's shadow.
//!
//! A model's lowest points are rarely within a tenth of a millimetre of the real contact with the
//! table, and a hard shadow shows such a difference. A lower table moves all of the shadow equally;
//! a change of the light moves the shadow of a high part more. So both can be estimated: the loss
//! with the best lights is close to a parabola of the height.

use std::thread;

use app_core::alignment::{Aligner, Alignment};
use app_core::frame::FrameInput;
use app_core::scene::{Light, Scene};
use glam::{DMat4, DVec3};

/// Distance of the compared heights, over the diagonal of the toy's box.
const STEP: f64 = 0.002;
/// Largest distance of the parabola's vertex, in steps.
const MOST_STEPS: f64 = 1.5;
/// Smallest relative fall of the loss.
const LEAST_FALL: f64 = 0.04;

/// Height of the table above the scene's, in metres; `None` if the shadow does not constrain it.
pub(super) fn higher_m(
    scene: &Scene,
    input: &FrameInput,
    lights: &[Light],
    diagonal_m: f64,
) -> anyhow::Result<Option<f64>> {
    let step_m = STEP * diagonal_m;
    let loss = |height_m: f64| -> anyhow::Result<Option<f64>> {
        Ok(aligned_at(scene, input, lights, height_m)?
            .report
            .light_errors
            .map(|[_, found]| found))
    };
    let losses = thread::scope(|threads| {
        let others = [-step_m, step_m].map(|height_m| threads.spawn(move || loss(height_m)));
        let own = loss(0.0);
        let [lower, higher] =
            others.map(|thread| thread.join().map_err(|_| anyhow::anyhow!("a thread ended early")));
        anyhow::Ok([lower??, own?, higher??])
    })?;
    let [Some(lower), Some(own), Some(higher)] = losses else {
        return Ok(None);
    };
    Ok(vertex([lower, own, higher])
        .filter(|(steps, fall)| steps.abs() <= MOST_STEPS && *fall >= LEAST_FALL)
        .map(|(steps, _)| steps * step_m))
}

/// Aligns with the table at another height: lights start as listed, and the toy stays in place.
pub(super) fn aligned_at(
    scene: &Scene,
    input: &FrameInput,
    lights: &[Light],
    height_m: f64,
) -> anyhow::Result<Alignment> {
    let mut scene = scene
        .clone()
        .with_lights(lights.to_vec())
        .with_resting(Some(false));
    for receiver in &mut scene.receivers {
        receiver.world_from_plane = DMat4::from_translation(height_m * DVec3::Y) * receiver.world_from_plane;
    }
    Ok(Aligner::new(scene).align(input)?)
}

/// Place of the minimum of a parabola through values at -1, 0 and 1, and its relative fall below
/// the middle value; `None` if there is no minimum.
fn vertex([lower, own, higher]: [f64; 3]) -> Option<(f64, f64)> {
    let curvature = lower - 2.0 * own + higher;
    let slope = 0.5 * (higher - lower);
    if !(curvature > 0.0 && own > 0.0) {
        return None;
    }
    let at = -slope / curvature;
    Some((at, 0.5 * slope * slope / curvature / own))
}
