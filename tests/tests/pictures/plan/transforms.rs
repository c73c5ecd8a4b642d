//! Maps between image and plane compared with projections by hand, in the core's f64 and in the
//! shaders' f32.

use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::passes::globals::Globals;
use glam::{DMat3, DVec2, DVec3, Mat3, Mat4, UVec2, Vec3, Vec4};

use crate::plan::rig::{BULB_AT, RECT, Rig, TOY, points_on_plane};

const TEN_KM: DVec3 = DVec3::new(10_000.0, -7_000.0, 12_000.0);

fn plane_of(homography: &DMat3, region_px: DVec2) -> DVec2 {
    let at = *homography * region_px.extend(1.0);
    at.truncate() / at.z
}

#[test]
fn pixels_and_plane_are_inverse() {
    let rig = Rig::new(DVec3::ZERO);
    let plane_from_region_px = rig.view().plane_from_region_px(&RECT, &rig.world_from_plane());
    for point in points_on_plane() {
        let region_px = rig.pixel(point) - RECT.origin_px.as_dvec2();
        let there = plane_of(&plane_from_region_px, region_px);
        assert!(
            (there - DVec2::new(point.x, point.z)).length() < 1e-9,
            "{point} came back as {there}"
        );
        let inverse_depth = (plane_from_region_px * region_px.extend(1.0)).z;
        assert!(
            (inverse_depth * rig.depth_m(point) - 1.0).abs() < 1e-9,
            "w is 1 / depth"
        );
    }
}

#[test]
fn clip_space_is_the_region_with_reversed_depth() {
    let rig = Rig::new(DVec3::ZERO);
    let clip_from_anchor = rig.view().clip_from(&RECT, &rig.world_from_plane());
    for point in points_on_plane().chain(TOY.corners()) {
        let clip = clip_from_anchor * point.extend(1.0);
        let ndc = clip.truncate() / clip.w;
        let px = (ndc.truncate() * DVec2::new(0.5, -0.5) + 0.5) * RECT.size_px.as_dvec2();
        assert!((px + RECT.origin_px.as_dvec2() - rig.pixel(point)).length() < 1e-9);
        assert!((clip.w - rig.depth_m(point)).abs() < 1e-12);
        assert!(
            (ndc.z - 1e-6 / rig.depth_m(point)).abs() < 1e-15,
            "1 at a micrometre, 0 at infinity"
        );
    }
}

#[test]
fn the_camera_is_where_it_was_put() {
    let mut rig = Rig::new(DVec3::ZERO);
    let eye = DVec3::new(0.3, 0.7, -0.5);
    rig.place_camera(eye, DVec3::ZERO);
    assert!((rig.view().camera_in(&rig.world_from_plane()) - eye).length() < 1e-12);
}

/// The shaders compute in f32, and at ten kilometres from the world's origin steps of f32 are a
/// millimetre.
#[test]
fn far_from_the_origin_nothing_changes() {
    let (near, far) = (Rig::new(DVec3::ZERO), Rig::new(TEN_KM));
    let lights = |rig: &Rig| [rig.bulb(BULB_AT, 0.02), rig.sun(DVec3::new(0.5, 0.9, 0.2), 0.01)];
    let region = near.region(&TOY, &lights(&near)).unwrap();
    assert_eq!(far.region(&TOY, &lights(&far)), Some(region));
    let (a, b) = (
        near.globals(&region, &lights(&near)),
        far.globals(&region, &lights(&far)),
    );
    let px = |globals: &Globals, point: DVec3| {
        let clip = Mat4::from_cols_array_2d(&globals.clip_from_anchor) * point.as_vec3().extend(1.0);
        clip.truncate().truncate() / clip.w * 0.5 * region.size_px.as_vec2()
    };
    for point in points_on_plane().chain(TOY.corners()) {
        assert!((px(&a, point) - px(&b, point)).length() < 1e-3, "{point}");
    }
    let lights = |globals: &Globals| {
        let of_plane = globals.receivers[0].lights;
        globals.lights.into_iter().chain(of_plane).collect::<Vec<_>>()
    };
    for (here, there) in lights(&a).into_iter().zip(lights(&b)) {
        assert!((Vec4::from(here) - Vec4::from(there)).length() < 1e-6);
    }
    assert!((Vec3::from(a.camera_in_anchor) - Vec3::from(b.camera_in_anchor)).length() < 1e-6);
}

#[test]
fn the_shaders_homographies_are_exact_to_a_hundredth_of_a_pixel() {
    let rig = Rig::new(TEN_KM);
    let globals = rig.globals(&RECT, &[]);
    let truncated = |columns: [[f32; 4]; 3]| Mat3::from_cols_array_2d(&columns.map(|[x, y, z, _]| [x, y, z]));
    let plane_from_region_px = truncated(globals.receivers[0].plane_from_region_px);
    let clip_from_plane = truncated(globals.receivers[0].clip_from_plane);
    for point in points_on_plane() {
        let expected_px = rig.pixel(point) - RECT.origin_px.as_dvec2();
        let at = plane_from_region_px * expected_px.as_vec2().extend(1.0);
        let at = at.truncate() / at.z;
        let there_px = rig.pixel(DVec3::new(at.x.into(), 0.0, at.y.into())) - RECT.origin_px.as_dvec2();
        assert!(
            (there_px - expected_px).length() < 0.01,
            "{}",
            (there_px - expected_px).length()
        );

        let clip = clip_from_plane * Vec3::new(point.as_vec3().x, point.as_vec3().z, 1.0);
        let ndc = (clip.truncate() / clip.z).as_dvec2();
        let px = (ndc * DVec2::new(0.5, -0.5) + 0.5) * RECT.size_px.as_dvec2();
        assert!(
            (px - expected_px).length() < 0.01,
            "{}",
            (px - expected_px).length()
        );
    }
}

#[test]
fn the_fade_is_at_inner_borders_alone() {
    let rig = Rig::new(DVec3::ZERO);
    let whole = PixelRect {
        origin_px: UVec2::ZERO,
        size_px: rig.image_px,
    };
    assert_eq!(rig.globals(&whole, &[]).border_px, [0.0; 4]);
    let top_left = PixelRect {
        origin_px: UVec2::ZERO,
        size_px: rig.image_px - 1,
    };
    let [left, top, right, bottom] = rig.globals(&top_left, &[]).border_px;
    assert!(left == 0.0 && top == 0.0 && right > 0.0 && bottom > 0.0);
    assert!(
        rig.globals(&RECT, &[])
            .border_px
            .into_iter()
            .all(|width_px| width_px > 0.0)
    );
}
