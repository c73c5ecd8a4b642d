//! Whether alignment knows how well it knows: errors of a pose over the deviations that are claimed for them.

use app_core::alignment::PoseDeviation;
use app_core::frame::FrameInput;
use glam::{DMat4, DVec3};

/// An error within that number of deviations is as claimed.
const WITHIN: f64 = 2.0;

/// An error of a pose, and the deviation that was claimed for it: along the view and beside it in millimetres, of the turn in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Not below 0.
    pub errors: [f64; 3],
    /// As reported.
    pub claimed: [f64; 3],
}

impl Pull {
    /// Of the toy's middle, by what is recorded.
    pub(super) fn of(
        recorded: &FrameInput,
        found: &FrameInput,
        middle: DVec3,
        claimed: &PoseDeviation,
    ) -> Self {
        let camera_from_world = recorded.camera.world_from_camera.inverse();
        let place = |pose: &DMat4| camera_from_world.transform_point3(pose.transform_point3(middle));
        let moved = place(&found.world_from_object) - place(&recorded.world_from_object);
        let [there, here] =
            [recorded, found].map(|input| input.world_from_object.to_scale_rotation_translation().1);
        let turn_rad = (here * there.inverse()).to_scaled_axis().length();
        Self {
            errors: [
                1e3 * moved.z.abs(),
                1e3 * moved.truncate().length(),
                turn_rad.to_degrees(),
            ],
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

/// A sentence: how many errors lie within two deviations, and the median of error over deviation. None where nothing was applied.
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
