//! Conversion of ARCore's conventions to ours. The only file that knows ARCore's axes.
//!
//! Ours: `world` is right-handed, in metres, +Y up. `camera` has +X right, +Y up and looks along -Z
//! in the unrotated sensor image. `camera_rdf` is the same camera with +X right, +Y down, +Z
//! forward. `sensor_px` has its origin at the top left corner of the sensor image, so that the
//! centre of the first pixel is at (0.5, 0.5).

use app_core::scene::Intrinsics;
use glam::{DMat4, DQuat, DVec2, DVec3};

/// Tolerance of a unit quaternion's squared length in single precision, with room for a few
/// roundings.
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

/// Our intrinsics from an `ArCameraIntrinsics`: focal length and principal point in pixels of the
/// same image stream, `[x, y]` each. `None` unless both lengths are positive and all numbers are
/// finite.
///
/// ARCore does not specify which points of a pixel have integer coordinates. The coordinates are
/// used unchanged; if ARCore counts from pixel centres, they are wrong by half a pixel.
pub fn intrinsics(focal_length_px: [f32; 2], principal_point_px: [f32; 2]) -> Option<Intrinsics> {
    let [fx_px, fy_px] = focal_length_px.map(f64::from);
    let [cx_px, cy_px] = principal_point_px.map(f64::from);
    let is_finite = [fx_px, fy_px, cx_px, cy_px]
        .iter()
        .all(|number| number.is_finite());
    (is_finite && fx_px > 0.0 && fy_px > 0.0).then_some(Intrinsics {
        fx_px,
        fy_px,
        cx_px,
        cy_px,
    })
}

/// A plane from its centre pose and its outline, `x` and `z` in turn, in metres about that centre:
/// the rectangle around the outline, whose own centre becomes the plane's origin. `None` without a
/// finite outline with an area.
pub fn rectangle(world_from_centre: DMat4, outline_m: &[f32]) -> Option<(DMat4, DVec2)> {
    let corners = outline_m
        .chunks_exact(2)
        .map(|corner| DVec2::new(corner[0].into(), corner[1].into()));
    let (low, high) = corners
        .clone()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), corner| {
            (low.min(corner), high.max(corner))
        });
    let (middle, half_extent_m) = (0.5 * (low + high), 0.5 * (high - low));
    let is_finite = corners.clone().all(DVec2::is_finite) && half_extent_m.is_finite();
    (is_finite && half_extent_m.cmpgt(DVec2::ZERO).all()).then(|| {
        let centre_from_plane = DMat4::from_translation(DVec3::new(middle.x, 0.0, middle.y));
        (world_from_centre * centre_from_plane, half_extent_m)
    })
}

/// Clockwise quarter turns from the sensor's picture to the shown one, from the camera's pose in
/// the sensor's axes and in the display's, which differ by a rotation about the line of sight.
/// `None` if they differ otherwise.
#[must_use]
pub fn quarter_turns(of_sensor_raw: [f32; 7], of_display_raw: [f32; 7]) -> Option<u8> {
    let world_from_sensor = world_from_camera(of_sensor_raw)?;
    let sensor_from_display = world_from_sensor.inverse() * world_from_camera(of_display_raw)?;
    // Directions of the display's right and up in the sensor's picture.
    let [right, up] = [DVec3::X, DVec3::Y].map(|axis| sensor_from_display.transform_vector3(axis));
    // After one clockwise turn, the picture's top is at the right.
    let is_along = |one: DVec3, other: DVec3| one.dot(other) > 0.99;
    let turned = [
        (DVec3::X, DVec3::Y),
        (DVec3::Y, DVec3::NEG_X),
        (DVec3::NEG_X, DVec3::NEG_Y),
        (DVec3::NEG_Y, DVec3::X),
    ];
    (0..).zip(turned).find_map(|(turns, (of_right, of_up))| {
        (is_along(right, of_right) && is_along(up, of_up)).then_some(turns)
    })
}

/// The seven numbers of `ArPose_create` for one of our rigid transforms; the inverse of
/// [`world_from_camera`].
#[allow(clippy::cast_possible_truncation, reason = "ARCore takes single precision")]
pub fn pose_raw(rigid: &DMat4) -> [f32; 7] {
    let (_, rotation, translation_m) = rigid.to_scale_rotation_translation();
    let [qx, qy, qz, qw] = rotation.to_array().map(|number| number as f32);
    let [tx, ty, tz] = translation_m.to_array().map(|number| number as f32);
    [qx, qy, qz, qw, tx, ty, tz]
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
        let intrinsics = intrinsics([500.0, 510.0], [320.0, 240.0]).expect("a camera");
        let point_px = intrinsics.pixel_of(DVec3::new(0.2, -0.1, -2.0));
        assert_eq!(point_px, Some(DVec2::new(370.0, 265.5)));
    }

    #[test]
    fn a_plane_is_the_rectangle_round_its_outline() {
        let turned = world_from_camera([0.0, 1.0, 0.0, 0.0, 0.0, -0.5, 0.0]).expect("half a turn about +Y");
        let (world_from_plane, half_extent_m) =
            rectangle(turned, &[0.5, 0.25, -0.25, 0.25, 0.0, -0.75]).expect("a rectangle");
        assert_eq!(half_extent_m, DVec2::new(0.375, 0.5));
        let centre = world_from_plane.transform_point3(DVec3::ZERO);
        assert!(
            centre.abs_diff_eq(DVec3::new(-0.125, -0.5, 0.25), 1e-12),
            "{centre}"
        );
        for without_area in [
            &[][..],
            &[0.0, 0.0, 1.0, 0.0],
            &[0.0, 0.0, f32::NAN, 1.0, 1.0, 1.0],
        ] {
            assert_eq!(rectangle(turned, without_area), None, "{without_area:?}");
        }
    }

    #[test]
    fn a_sensor_lies_in_the_phone_by_quarter_turns() {
        let held = DQuat::from_euler(glam::EulerRot::YXZ, 0.7, -0.4, 0.2);
        let raw = |turned_rad: f64| {
            let rotation = held * DQuat::from_rotation_z(turned_rad);
            pose_raw(&DMat4::from_rotation_translation(rotation, DVec3::X))
        };
        let told = |degrees: f64| quarter_turns(raw(0.0), raw(degrees.to_radians()));
        assert_eq!(
            [0.0, 90.0, 180.0, 270.0].map(told),
            [Some(0), Some(1), Some(2), Some(3)]
        );
        assert_eq!([told(45.0), quarter_turns(raw(0.0), [0.0; 7])], [None, None]);
        // A display whose right is the picture's top shows the picture turned clockwise, as
        // `Display` defines it.
        let display = app_core::camera_frame::Display {
            quarter_turns: 1,
            ..app_core::camera_frame::Display::default()
        };
        let image_from_screen = display.image_from_screen([640, 480], [480, 640]);
        let above = image_from_screen.transform_vector2(DVec2::X);
        assert!(above.abs_diff_eq(DVec2::NEG_Y, 1e-9), "{above}");
    }

    #[test]
    fn a_pose_goes_to_arcore_and_back() {
        let pose = DMat4::from_rotation_translation(
            DQuat::from_euler(glam::EulerRot::YXZ, 1.0, -0.5, 0.25),
            DVec3::new(0.5, -0.25, 2.0),
        );
        let back = world_from_camera(pose_raw(&pose)).expect("a rigid pose");
        assert!(back.abs_diff_eq(pose, 1e-6), "{back}");
    }
}
