//! Calibration of alignment's uncertainty: errors of a pose over their claimed deviations.

use app_core::alignment::PoseDeviation;
use app_core::frame::FrameInput;
use glam::DVec3;

use crate::median::median;

/// Number of deviations within which an error counts as expected.
pub(super) const WITHIN: f64 = 2.0;

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

/// The calibration of errors, by their ratios to their claimed deviations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Calibration {
    n: usize,
    /// The fraction within two deviations.
    pub(super) within: f64,
    /// The median ratio.
    pub(super) median: f64,
}

/// `None` without any error.
pub(super) fn calibration(ratios: impl Iterator<Item = f64>) -> Option<Calibration> {
    let ratios: Vec<f64> = ratios.collect();
    let n = ratios.len();
    let n_within = ratios.iter().filter(|ratio| **ratio <= WITHIN).count();
    Some(Calibration {
        n,
        within: n_within as f64 / n as f64,
        median: median(ratios)?,
    })
}

/// A sentence: the fraction of errors within two deviations, and the median of error over
/// deviation. `None` if nothing was applied.
pub(super) fn summary(pulls: impl IntoIterator<Item = Pull>) -> Option<String> {
    let ratios = pulls
        .into_iter()
        .flat_map(|pull| pull.ratios().collect::<Vec<f64>>());
    let Calibration { n, within, median } = calibration(ratios)?;
    Some(format!(
        "{:.0} % of {n} errors of poses are within {WITHIN} claimed deviations; median of error over deviation {median:.2}",
        100.0 * within,
    ))
}
