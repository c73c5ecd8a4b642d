//! Depth maps of the toy from near and distant lights, in the 32 bits of shaders.

use app_pipeline::geometry::shadow_atlas::ShadowAtlas;
use app_scene::geometry::bounds::Sphere;
use glam::{DVec3, Vec4};

const TOY: Sphere = Sphere {
    centre: DVec3::new(0.02, 0.1, -0.03),
    radius_m: 0.12,
};
/// Largest error of a depth, for tile texels of a thousandth of the toy; measured: 2e-7.
const MAX_ERROR: f64 = 1e-5;

#[test]
fn depths_span_the_toy_however_far_the_light() {
    let towards = DVec3::new(0.48, 0.6, 0.64);
    for distance_m in [0.5, 10.0, 1e3, 1e5, 1e6, 1e9] {
        let light: Vec4 = (TOY.centre + distance_m * towards).extend(1.0).as_vec4();
        let tiles = ShadowAtlas::new(vec![1], 256).tiles(&[&[light]], &TOY);
        let atlas_from_anchor = tiles[0].atlas_from_anchor.as_mat4();
        for along in [-1.0, -0.5, 0.0, 0.25, 1.0] {
            let clip = atlas_from_anchor
                * (TOY.centre + along * TOY.radius_m * towards)
                    .as_vec3()
                    .extend(1.0);
            let actual = f64::from(clip.z / clip.w);
            // From 0 behind the toy to 1 in front of it, by similar triangles.
            let ratio = TOY.radius_m / distance_m;
            let expected = 0.5 * (1.0 + along) * (1.0 - ratio) / (1.0 - along * ratio);
            assert!(
                (actual - expected).abs() < MAX_ERROR,
                "{distance_m} m, {along}: {actual}, not {expected}"
            );
        }
    }
}
