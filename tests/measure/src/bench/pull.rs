//! Calibration of alignment's uncertainty: errors of a pose over their claimed deviations.

use app_core::alignment::PoseDeviation;
use app_core::frame::FrameInput;
use glam::DVec3;

/// Number of deviations within which an error counts as expected.
const WITHIN: f64 = 2.0;

/// An error of a pose, and its claimed deviation: along the view and lateral in millimetres, of the
/// turn in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Absolute values.
    pub errors: [f64; 3],
    /// Reported standard deviations.
    pub claimed: [f64; 3],
}

impl Pull {
    /// Errors of the toy's centre in millimetres and of its turn in degrees, as the recorded camera
    /// sees them.
    pub(super) fn of(
        recorded: &FrameInput,
        [there, here]: [DVec3; 2],
        turn_deg: f64,
        claimed: &PoseDeviation,
    ) -> Self {
        let camera_from_world = recorded.camera.world_from_camera.inverse();
        let moved = camera_from_world.transform_vector3(here - there);
        Self {
            errors: [1e3 * moved.z.abs(), 1e3 * moved.truncate().length(), turn_deg],
            claimed: [
                1e3 * claimed.depth_m,
                1e3 * claimed.lateral_m,
                claimed.rotation_rad.to_degrees(),
            ],
        }
    }

    fn ratios(&self) -> impl Iterator<Item = f64> {
        let ratio = |(error, claimed): (f64, f64)| error / claimed;
        self.errors.into_iter().zip(self.claimed).map(ratio)
    }
}

/// A sentence: the fraction of errors within two deviations, and the median of error over
/// deviation. `None` if nothing was applied.
pub(super) fn summary(pulls: &[Pull]) -> Option<String> {
    let mut ratios: Vec<f64> = pulls.iter().flat_map(Pull::ratios).collect();
    ratios.sort_by(f64::total_cmp);
    let median = ratios.get(ratios.len() / 2)?;
    let n_within = ratios.iter().filter(|ratio| **ratio <= WITHIN).count();
    Some(format!(
        "{:.0} % of {} errors of poses are within {WITHIN} claimed deviations; median of error over deviation {median:.2}",
        100.0 * n_within as f64 / ratios.len() as f64,
        ratios.len(),
    ))
}
