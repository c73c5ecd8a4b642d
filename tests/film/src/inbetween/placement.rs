//! A print that was put back on its mark: it stands on the same plane, shifted and turned there.
//!
//! An outline constrains a toy's height and lean ten times worse than its place in the picture.
//! Prints on one table share height and lean, so that only two shifts and a turn about the plane's
//! normal are estimated from the picture.

use app_core::scene::{Camera, Receiver};
use glam::{DMat3, DMat4, DQuat, DVec2, DVec3};

/// Rounds of Gauss-Newton; it converges within three.
const N_ROUNDS: usize = 8;
/// Residual of a print that does not stand on the mark's plane: root mean square in pixels.
const MOST_OFF_PX: f64 = 0.4;
/// Largest number of vertices used.
const MOST_POINTS: usize = 2000;

/// A motion in a plane.
#[derive(Clone, Copy, Debug, Default)]
struct Shift {
    /// In metres along the plane's x and z, and in radians about its y.
    numbers: DVec3,
}

/// The pose of a print that was found at `found`, shifted and turned on a plane from `mark` alone;
/// `None` if such a pose does not explain the picture. `points` are those of the print on the mark,
/// in world.
pub(super) fn on_plane(
    [mark, found]: [&DMat4; 2],
    points: &[DVec3],
    camera: &Camera,
    receiver: &Receiver,
) -> Option<DMat4> {
    let found_from_mark = *found * mark.inverse();
    let step = points.len().div_ceil(MOST_POINTS).max(1);
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let fit = Fit {
        camera,
        camera_from_world: camera.world_from_camera.inverse(),
        plane: DMat3::from_mat4(receiver.world_from_plane),
        middle,
    };
    let pairs: Vec<(DVec3, DVec2)> = points
        .iter()
        .step_by(step)
        .filter_map(|point| Some((*point, fit.seen_at(found_from_mark.transform_point3(*point))?)))
        .collect();
    let mut shift = Shift::default();
    for _ in 0..N_ROUNDS {
        shift.numbers += fit.step(&pairs, shift)?;
    }
    let left_px2 = pairs.iter().map(|(point, seen)| {
        let there = fit.seen_at(fit.motion(shift).transform_point3(*point));
        there.map_or(f64::INFINITY, |there| there.distance_squared(*seen))
    });
    let off_px = (left_px2.sum::<f64>() / pairs.len().max(1) as f64).sqrt();
    (off_px < MOST_OFF_PX).then(|| fit.motion(shift) * *mark)
}

struct Fit<'a> {
    camera: &'a Camera,
    camera_from_world: DMat4,
    /// World from the plane's directions.
    plane: DMat3,
    middle: DVec3,
}

impl Fit<'_> {
    fn seen_at(&self, point: DVec3) -> Option<DVec2> {
        self.camera
            .intrinsics
            .pixel_of(self.camera_from_world.transform_point3(point))
    }

    /// The motion of points in world.
    fn motion(&self, shift: Shift) -> DMat4 {
        let [x, z, turn_rad] = shift.numbers.to_array();
        let turn = DQuat::from_axis_angle(self.plane.y_axis, turn_rad);
        let place = self.middle + x * self.plane.x_axis + z * self.plane.z_axis;
        DMat4::from_translation(place) * DMat4::from_quat(turn) * DMat4::from_translation(-self.middle)
    }

    /// The Gauss-Newton step of a shift.
    fn step(&self, pairs: &[(DVec3, DVec2)], shift: Shift) -> Option<DVec3> {
        /// Step of difference quotients, in metres, and for the turn in radians.
        const SMALL: f64 = 1e-6;
        let at = |numbers: DVec3, point: DVec3| {
            self.seen_at(self.motion(Shift { numbers }).transform_point3(point))
        };
        let (mut information, mut pull) = (DMat3::ZERO, DVec3::ZERO);
        for (point, seen) in pairs {
            let now = at(shift.numbers, *point)?;
            let mut slopes = [DVec2::ZERO; 3];
            for (slope, axis) in slopes.iter_mut().zip(DVec3::AXES) {
                *slope = (at(shift.numbers + SMALL * axis, *point)? - now) / SMALL;
            }
            for (slope, residual) in [
                (slopes.map(|slope| slope.x), seen.x - now.x),
                (slopes.map(|slope| slope.y), seen.y - now.y),
            ] {
                let slope = DVec3::from_array(slope);
                information += DMat3::from_cols(slope * slope.x, slope * slope.y, slope * slope.z);
                pull += residual * slope;
            }
        }
        let step = information.try_inverse()? * pull;
        step.is_finite().then_some(step)
    }
}
