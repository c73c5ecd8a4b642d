//! Width of the penumbra against shadows from opposite points of the light's rim.

use app_core::scene::Light;
use glam::DVec3;

use crate::rig::{BULB_AT, Rig, TOY, shadow};

/// Widest distance between shadows of one point from opposite points of the light's rim.
fn penumbra_m(toy_height_m: f64, light: DVec3, radius_m: f64) -> f64 {
    let top = TOY.centre().with_y(toy_height_m);
    let (across, along) = (light - top).normalize().any_orthonormal_pair();
    let widths = (0..180).map(|degrees| {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        let offset = radius_m * (cos * across + sin * along);
        (shadow(top, light + offset) - shadow(top, light - offset)).length()
    });
    widths.fold(0.0, f64::max)
}

#[test]
fn the_penumbra_is_as_wide_as_similar_triangles_make_it() {
    let rig = Rig::new(DVec3::ZERO);
    let view = rig.view();
    let world_from_plane = rig.world_from_plane();
    let measured_px = |light: &Light| view.penumbra_px(light, &world_from_plane, &TOY);
    let px_per_m = rig.intrinsics.fx_px.max(rig.intrinsics.fy_px) / rig.depth_m(TOY.centre());
    for to_light in [
        DVec3::Y,
        DVec3::new(0.6, 0.8, 0.0),
        DVec3::new(0.3, 0.4, 0.9).normalize(),
    ] {
        let radius_rad: f64 = 0.01;
        let far = TOY.centre().with_y(TOY.max.y) + 1000.0 * to_light;
        let expected_px = px_per_m * penumbra_m(TOY.max.y, far, 1000.0 * radius_rad.tan());
        for light in [
            rig.bulb(far, 1000.0 * radius_rad.tan()),
            rig.sun(to_light, radius_rad),
        ] {
            let px = measured_px(&light);
            assert!(
                (px / expected_px - 1.0).abs() < 0.01,
                "{light:?}: {px} instead of {expected_px}"
            );
        }
    }
    assert_eq!(measured_px(&rig.bulb(BULB_AT, 0.0)), 0.0);
    assert_eq!(
        measured_px(&rig.bulb(DVec3::new(0.5, 0.1, 0.0), 0.01)),
        f64::INFINITY
    );
}
