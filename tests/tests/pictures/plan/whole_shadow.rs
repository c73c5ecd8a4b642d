//! The test for a complete shadow, compared with the shadows of many points of a ball.

use app_pipeline::geometry::seen::Caster as ShadowCaster;
use glam::{DVec3, DVec4, Vec3, Vec4};

const NEAR_M: f32 = 0.05;
/// Depth of the receiver's point (x, z, 1) in metres: a camera at z = 1.5 that looks down on it.
const DEPTH: Vec3 = Vec3::new(0.05, -0.8, 1.2);

/// Points all over a ball.
fn points(caster: ShadowCaster) -> impl Iterator<Item = DVec3> {
    let around = (0..24).flat_map(|turn| (0..=12).map(move |tilt| (f64::from(turn), f64::from(tilt))));
    around.map(move |(turn, tilt)| {
        let (turn, tilt) = (turn * 15_f64.to_radians(), tilt * 15_f64.to_radians());
        let out = DVec3::new(tilt.sin() * turn.cos(), tilt.cos(), tilt.sin() * turn.sin());
        caster.centre.as_dvec3() + f64::from(caster.radius_m) * out
    })
}

/// Margin of a point's shadow before it is clipped: the light above the point, and the shadow
/// beyond the near plane.
fn margin(point: DVec3, light: DVec4) -> f64 {
    let above = light.y - light.w * point.y;
    if above <= 0.0 {
        return above;
    }
    let shadow = (light.y * point - point.y * light.truncate()) / above;
    let depth_m = DEPTH.as_dvec3().dot(DVec3::new(shadow.x, shadow.z, 1.0));
    above.min(depth_m - f64::from(NEAR_M))
}

#[test]
fn a_shadow_is_whole_where_that_of_every_point_is() {
    let lights = [
        Vec4::new(0.4, 1.0, 0.2, 1.0),
        Vec4::new(-0.8, 0.3, -0.6, 1.0),
        Vec4::new(0.1, 0.4, -2.0, 1.0),
        Vec3::new(0.3, 0.8, -0.5).normalize().extend(0.0),
        Vec3::new(0.0, 0.1, -1.0).normalize().extend(0.0),
        // Behind the receiver.
        Vec4::new(0.2, -0.5, 0.3, 1.0),
    ];
    let casters = (0..6).flat_map(|radius| {
        (-3..=3).flat_map(move |z| {
            (0..6).map(move |y| ShadowCaster {
                centre: Vec3::new(0.1, 0.12 * y as f32, 0.3 * z as f32),
                radius_m: 0.02 + 0.07 * radius as f32,
            })
        })
    });
    let [mut n_whole, mut n_cut] = [0; 2];
    for caster in casters {
        for light in lights {
            let least = points(caster).map(|point| margin(point, light.as_dvec4()));
            let least = least.fold(f64::INFINITY, f64::min);
            let is_whole = caster.has_whole_shadow(light, DEPTH, NEAR_M);
            let what = format!("{caster:?} in {light}: {least} m");
            assert!(!is_whole || least > 0.0, "{what}, yet whole");
            // The points do not cover the whole ball.
            assert!(is_whole || least < 0.05, "{what}, yet cut");
            [n_whole, n_cut] = [n_whole + u32::from(is_whole), n_cut + u32::from(!is_whole)];
        }
    }
    assert!(n_whole > 300 && n_cut > 300, "{n_whole} and {n_cut}");
}
