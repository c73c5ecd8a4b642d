//! The table's height, by the toy's shadow.
//!
//! A model's lowest points are rarely where the real toy touches the table to a tenth of a millimetre, and that is what a hard shadow shows.
//! A table that is lower moves all of the shadow by the same; a light that is elsewhere moves what a high part casts by more. So both are
//! found: the loss that the best lights leave is close to a parabola of the height.

use std::thread;

use app_core::alignment::{Aligner, Alignment};
use app_core::frame::FrameInput;
use app_core::scene::{Light, Scene};
use glam::{DMat4, DVec3};

/// Between heights that are compared, over the diagonal of the toy's box.
const STEP: f64 = 0.002;
/// The vertex of the parabola may be that many steps away.
const MOST_STEPS: f64 = 1.5;
/// The loss has to fall by that part.
const LEAST_FALL: f64 = 0.04;

/// By how far the table is higher than a scene has it, in metres; none if the shadow does not say.
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

/// Aligns with the table elsewhere: lights start where they are listed, and the toy floats where it is.
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

/// Where a parabola through values at -1, 0 and 1 is least, and by which part of the middle one it is less there; none if it is nowhere.
fn vertex([lower, own, higher]: [f64; 3]) -> Option<(f64, f64)> {
    let curvature = lower - 2.0 * own + higher;
    let slope = 0.5 * (higher - lower);
    if !(curvature > 0.0 && own > 0.0) {
        return None;
    }
    let at = -slope / curvature;
    Some((at, 0.5 * slope * slope / curvature / own))
}
