//! ARCore's conventions turned into ours. The only file of this shell that knows platform axes.
//!
//! Ours: `world` is right-handed, in metres, +Y up. `camera` has +X right, +Y up and looks along -Z in the unrotated
//! sensor image. `camera_rdf` is the same camera with +X right, +Y down, +Z forward. `sensor_px` has its origin at the
//! top left corner of the sensor image, so that the centre of the first pixel is at (0.5, 0.5).

use glam::{DMat3, DMat4, DQuat, DVec3};

/// How far a unit quaternion in single precision may be from length one (squared), with room for a few roundings.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Our `world_from_camera` from the seven numbers of `ArPose_getPoseRaw`: `qx qy qz qw tx ty tz`, metres.
///
/// The pose must come from `ArCamera_getPose`, whose axes follow the sensor image and are ours already; the
/// display-oriented pose is turned by quarter turns. `None` if a number is not finite or the quaternion is not a
/// rotation, as ARCore may report before it tracks.
pub fn world_from_camera(pose_raw: [f32; 7]) -> Option<DMat4> {
    let [qx, qy, qz, qw, tx, ty, tz] = pose_raw.map(f64::from);
    let rotation = DQuat::from_xyzw(qx, qy, qz, qw);
    let translation_m = DVec3::new(tx, ty, tz);
    let is_rotation = (rotation.length_squared() - 1.0).abs() < UNIT_TOLERANCE;
    (is_rotation && translation_m.is_finite())
        .then(|| DMat4::from_rotation_translation(rotation.normalize(), translation_m))
}

/// Our `sensor_px_from_camera_rdf` from an `ArCameraIntrinsics`: focal length and principal point in pixels of the
/// same image stream, `[x, y]` each.
///
/// ARCore does not state where in a pixel its coordinates are whole. They are taken as given, which is half a pixel
/// off should ARCore count from pixel centres.
pub fn sensor_px_from_camera_rdf(focal_length_px: [f32; 2], principal_point_px: [f32; 2]) -> DMat3 {
    let [fx, fy] = focal_length_px.map(f64::from);
    let [cx, cy] = principal_point_px.map(f64::from);
    DMat3::from_cols(
        DVec3::new(fx, 0.0, 0.0),
        DVec3::new(0.0, fy, 0.0),
        DVec3::new(cx, cy, 1.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_x_looks_up_from_where_the_phone_is() {
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let world_from_camera =
            world_from_camera([half, 0.0, 0.0, half, 1.0, 2.0, 3.0]).expect("a rigid pose");
        let forward_in_world = world_from_camera.transform_vector3(DVec3::NEG_Z);
        let up_in_world = world_from_camera.transform_vector3(DVec3::Y);
        let origin_in_world = world_from_camera.transform_point3(DVec3::ZERO);
        assert!(
            forward_in_world.abs_diff_eq(DVec3::Y, 1e-12),
            "{forward_in_world}"
        );
        assert!(up_in_world.abs_diff_eq(DVec3::Z, 1e-12), "{up_in_world}");
        assert_eq!(origin_in_world, DVec3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn a_pose_before_tracking_is_refused() {
        assert_eq!(world_from_camera([0.0; 7]), None);
        assert_eq!(world_from_camera([0.0, 0.0, 0.0, 1.0, f32::NAN, 0.0, 0.0]), None);
        assert_eq!(
            world_from_camera([f32::INFINITY, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
            None
        );
    }

    #[test]
    fn a_point_to_the_right_and_below_the_axis_lands_right_and_below_the_principal_point() {
        let sensor_px_from_camera_rdf = sensor_px_from_camera_rdf([500.0, 510.0], [320.0, 240.0]);
        let point_px = sensor_px_from_camera_rdf * DVec3::new(0.2, 0.1, 2.0) / 2.0;
        assert_eq!(point_px, DVec3::new(370.0, 265.5, 1.0));
    }

    #[test]
    fn the_manifest_names_the_library_that_cargo_builds() {
        let library_name = format!("android:value=\"{}\"", env!("CARGO_PKG_NAME").replace('-', "_"));
        assert!(include_str!("../AndroidManifest.xml").contains(&library_name));
    }
}
