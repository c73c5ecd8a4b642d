//! Conversion of ARKit's conventions and numbers into ours. This is the only file that depends on
//! its axes.
//!
//! Ours: `world` is right-handed, in metres, +Y up. `camera` has +X right, +Y up and looks along -Z
//! in the unrotated sensor image. `camera_rdf` is the same camera with +X right, +Y down, +Z
//! forward. `sensor_px` has its origin at the top left corner of the sensor image, so that the
//! centre of the first pixel is at (0.5, 0.5).

use app_core::app::{ArSession, Permission};
use glam::{DMat3, DMat4, DVec3};

/// Tolerance for ARKit's single precision against a rigid motion, including the roundings of a
/// product.
const RIGID_TOLERANCE: f64 = 1e-3;

/// Our `world_from_camera` from the columns of `ARCamera.transform`, metres.
///
/// ARKit's camera axes belong to the sensor image in landscape and are ours already. `None` if the matrix is not a
/// rotation with a translation, as ARKit may report before it tracks.
pub fn world_from_camera(transform_columns: [[f32; 4]; 4]) -> Option<DMat4> {
    let world_from_camera = DMat4::from_cols_array_2d(&transform_columns.map(|column| column.map(f64::from)));
    let rotation = DMat3::from_mat4(world_from_camera);
    let is_rotation = (rotation.transpose() * rotation).abs_diff_eq(DMat3::IDENTITY, RIGID_TOLERANCE)
        && rotation.determinant() > 0.0;
    let is_affine = world_from_camera.row(3) == glam::DVec4::W;
    (is_rotation && is_affine && world_from_camera.is_finite()).then_some(world_from_camera)
}

/// Our `sensor_px_from_camera_rdf` from the columns of `ARCamera.intrinsics`.
///
/// A column is a `simd_float3` of four lanes; the last lane is undefined and is not read. ARKit
/// puts (0, 0) on the centre of the first pixel, so the principal point moves by half a pixel.
pub fn sensor_px_from_camera_rdf(intrinsics_columns: [[f32; 4]; 3]) -> DMat3 {
    let mut sensor_px_from_camera_rdf = DMat3::from_cols_array_2d(
        &intrinsics_columns.map(|[x, y, z, _unused]| [f64::from(x), f64::from(y), f64::from(z)]),
    );
    sensor_px_from_camera_rdf.z_axis += DVec3::new(0.5, 0.5, 0.0);
    sensor_px_from_camera_rdf
}

/// Exposure of a picture of a lens, relative to the locked one.
const DARK: f64 = 1.0 / 64.0;

/// Duration in seconds and ISO speed of such a dark picture, or of the darkest one that `least` of
/// both allows: the speed is reduced first, then the time. `None` if the camera does not report its
/// exposure.
pub fn darkened(held: [f64; 2], least: [f64; 2]) -> Option<[f64; 2]> {
    let are_numbers = held
        .iter()
        .chain(&least)
        .all(|number| number.is_finite() && *number > 0.0);
    if !are_numbers {
        return None;
    }
    let iso = (DARK * held[1]).max(least[1]).min(held[1]);
    let duration_s = (DARK * held[0] * held[1] / iso).max(least[0]).min(held[0]);
    Some([duration_s, iso])
}

/// The camera's permission from an `AVAuthorizationStatus`. After a refusal iOS does not ask again.
pub fn permission(status: isize) -> Permission {
    match status {
        3 => Permission::Granted,
        0 => Permission::Unknown,
        _ => Permission::Barred,
    }
}

/// Reaction to a failed session of ARKit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AfterFailure {
    /// Run it again without the toy's scan, or without the picture of the card.
    RunWithLess,
    /// Report the state to the app.
    Tell(ArSession),
}

/// Reaction to a session's failure with an `ARErrorCode`, depending on whether its run can do
/// without something.
///
/// One picture or object that ARKit refuses (300, 301, 302) fails the whole run, and each one after
/// it; so may a configuration that the phone does not have (100).
pub fn after_failure(code: isize, can_have_less: bool) -> AfterFailure {
    match code {
        100 | 300..=302 if can_have_less => AfterFailure::RunWithLess,
        code => AfterFailure::Tell(failed_session(code)),
    }
}

/// Clockwise quarter turns between the sensor's picture and a `UIInterfaceOrientation`: the picture
/// is upright if the phone's lower end is at the right.
pub fn quarter_turns(orientation: isize) -> u8 {
    match orientation {
        // Portrait, upside down, landscape with the lower end at the left.
        1 => 1,
        2 => 3,
        4 => 2,
        // The lower end at the right, or an unknown value.
        _ => 0,
    }
}

/// State of a session of ARKit after its failure with an `ARErrorCode`.
pub fn failed_session(code: isize) -> ArSession {
    match code {
        // The phone does not support the configuration.
        100 => ArSession::Unsupported,
        _ => ArSession::Failed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_platforms_numbers_have_their_meanings() {
        use Permission::{Barred, Granted, Unknown};
        assert_eq!([0, 1, 2, 3].map(permission), [Unknown, Barred, Barred, Granted]);
        let [unsupported, failed] = [ArSession::Unsupported, ArSession::Failed];
        assert_eq!(
            [100, 102, 103, 200].map(failed_session),
            [unsupported, failed, failed, failed]
        );
    }

    #[test]
    fn what_arkit_refuses_is_left_out_before_anything_is_said() {
        let tell = |ar_session| AfterFailure::Tell(ar_session);
        for code in [100, 300, 301, 302] {
            assert_eq!(after_failure(code, true), AfterFailure::RunWithLess, "{code}");
        }
        // The run without it failed, too.
        assert_eq!(after_failure(100, false), tell(ArSession::Unsupported));
        assert_eq!(after_failure(300, false), tell(ArSession::Failed));
        // Errors of sensors and of the camera have another cause.
        for code in [101, 102, 103, 200] {
            assert_eq!(after_failure(code, true), tell(ArSession::Failed), "{code}");
        }
    }

    #[test]
    fn the_picture_is_upright_in_all_four_orientations() {
        assert_eq!([0, 1, 2, 3, 4].map(quarter_turns), [0, 1, 3, 0, 2]);
    }

    #[test]
    fn a_dark_picture_has_less_speed_and_then_less_time() {
        let dark = darkened([0.016, 400.0], [1e-5, 50.0]).expect("an exposure");
        assert_eq!(dark, [0.002, 50.0]);
        let amount = |[duration_s, iso]: [f64; 2]| duration_s * iso;
        assert_eq!(amount(dark) * 64.0, amount([0.016, 400.0]));
        assert_eq!(
            darkened([0.016, 50.0], [0.01, 50.0]),
            Some([0.01, 50.0]),
            "as dark as it can be"
        );
        assert_eq!(
            darkened([0.001, 40.0], [0.01, 50.0]),
            Some([0.001, 40.0]),
            "never brighter"
        );
        assert_eq!(darkened([f64::NAN, 50.0], [0.01, 50.0]), None);
        assert_eq!(darkened([0.016, 0.0], [0.01, 50.0]), None);
    }

    /// A quarter turn to the left about the vertical, from a phone at (1, 2, 3).
    const TURNED_LEFT: [[f32; 4]; 4] = [
        [0.0, 0.0, -1.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
        [1.0, 2.0, 3.0, 1.0],
    ];

    #[test]
    fn a_quarter_turn_to_the_left_looks_along_minus_x_from_where_the_phone_is() {
        let world_from_camera = world_from_camera(TURNED_LEFT).expect("a rigid pose");
        assert_eq!(world_from_camera.transform_vector3(DVec3::NEG_Z), DVec3::NEG_X);
        assert_eq!(world_from_camera.transform_vector3(DVec3::X), DVec3::NEG_Z);
        assert_eq!(
            world_from_camera.transform_point3(DVec3::ZERO),
            DVec3::new(1.0, 2.0, 3.0)
        );
    }

    #[test]
    fn what_is_not_a_rigid_motion_is_refused() {
        let with = |column: usize, row: usize, value: f32| {
            let mut columns = TURNED_LEFT;
            columns[column][row] = value;
            world_from_camera(columns)
        };
        assert_eq!(world_from_camera([[0.0; 4]; 4]), None);
        assert_eq!(with(1, 1, -1.0), None, "mirrored");
        assert_eq!(with(1, 1, 1.1), None, "scaled");
        assert_eq!(with(3, 0, f32::NAN), None, "no position");
        assert_eq!(with(0, 3, 0.5), None, "a projection");
    }

    #[test]
    fn the_centre_of_the_first_pixel_moves_to_one_half() {
        let unused = f32::NAN;
        let intrinsics_columns = [
            [1000.0, 0.0, 0.0, unused],
            [0.0, 1000.0, 0.0, unused],
            [960.0, 720.0, 1.0, unused],
        ];
        // ARKit sees this direction at (0, 0): 960 left of and 720 above a principal point at (960, 720).
        let towards_first_pixel = DVec3::new(-0.96, -0.72, 1.0);
        let pixel = sensor_px_from_camera_rdf(intrinsics_columns) * towards_first_pixel;
        assert!(pixel.abs_diff_eq(DVec3::new(0.5, 0.5, 1.0), 1e-9), "{pixel}");
    }
}
