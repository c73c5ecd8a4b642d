//! The work region: it contains the area that toy and shadows reach, and little else.

use std::f64::consts::FRAC_PI_2;

use app_core::scene::Intrinsics;
use app_pipeline::geometry::anchored::AnchoredReceiver;
use app_pipeline::geometry::reach::Reach;
use app_pipeline::geometry::rect::PixelRect;
use app_scene::geometry::bounds::Bounds;
use glam::{DMat4, DQuat, DVec2, DVec3, UVec2};

use crate::plan::rig::{BULB_AT, RECT, Rig, TOY, layout, points_on_plane, shadow, square};

fn assert_holds(rect: &PixelRect, image_px: UVec2, point_px: DVec2, what: &str) {
    let seen_px = point_px.clamp(DVec2::ZERO, image_px.as_dvec2());
    let (min, max) = (
        rect.origin_px.as_dvec2(),
        (rect.origin_px + rect.size_px).as_dvec2(),
    );
    let is_inside = seen_px.cmpge(min - 1e-6).all() && seen_px.cmple(max + 1e-6).all();
    assert!(is_inside, "{what} at {point_px} is not within {min} to {max}");
}

#[test]
fn the_region_holds_the_toy_and_the_shadows_of_its_corners() {
    let rig = Rig::new(DVec3::ZERO);
    let far = DVec3::new(0.5, 0.9, 0.2).normalize();
    let lights = [(rig.bulb(BULB_AT, 0.0), BULB_AT), (rig.sun(far, 0.0), 1e7 * far)];
    for (light, position) in lights {
        let region = rig.region(&TOY, &[light]).unwrap();
        for corner in TOY.corners() {
            assert_holds(&region, rig.image_px, rig.pixel(corner), "a corner");
            assert_holds(
                &region,
                rig.image_px,
                rig.pixel(shadow(corner, position)),
                "a shadow",
            );
        }
        assert!(region.size_px.cmplt(rig.image_px).all(), "no more than needed");
    }
    let both = rig.region(&TOY, &lights.map(|(light, _)| light)).unwrap();
    assert!(
        lights
            .iter()
            .all(|(light, _)| both.contains(&rig.region(&TOY, &[*light]).unwrap()))
    );
}

#[test]
fn the_region_holds_the_penumbra() {
    let mut rig = Rig::new(DVec3::ZERO);
    rig.image_px *= 8;
    rig.intrinsics = Intrinsics {
        fx_px: 4800.0,
        fy_px: 4700.0,
        cx_px: 2500.0,
        cy_px: 2000.0,
    };
    let radius_m = 0.2;
    for light in [
        BULB_AT,
        DVec3::new(0.5, 0.7, 0.4),
        DVec3::new(0.1, 0.8, -0.6),
        DVec3::new(-0.5, 0.6, 0.5),
    ] {
        let region = rig.region(&TOY, &[rig.bulb(light, radius_m)]).unwrap();
        let (across, along) = (light - TOY.centre()).normalize().any_orthonormal_pair();
        for degrees in 0..360 {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let rim = light + radius_m * (cos * across + sin * along);
            for corner in TOY.corners() {
                let at_px = rig.pixel(shadow(corner, rim));
                assert_holds(&region, rig.image_px, at_px, "a shadow from the light's rim");
            }
        }
    }
}

/// The largest distance between shadows from opposite points of a bulb's rim.
fn widest_px(rig: &Rig, point: DVec3, light: DVec3, radius_m: f64) -> f64 {
    let (across, along) = (light - TOY.centre()).normalize().any_orthonormal_pair();
    let seen_px = |degrees: i32| {
        let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
        rig.pixel(shadow(point, light + radius_m * (cos * across + sin * along)))
    };
    let widths_px = (0..180).map(|degrees| seen_px(degrees).distance(seen_px(degrees + 180)));
    widths_px.fold(0.0, f64::max)
}

#[test]
fn a_penumbra_is_as_wide_as_the_widest_of_its_points() {
    let mut rig = Rig::new(DVec3::ZERO);
    rig.image_px *= 8;
    let (view, receivers) = (rig.view(), [rig.receiver()]);
    let (near, radius_m) = (DVec3::new(0.1, 0.8, -0.6), 0.03);
    let points = [TOY.min, TOY.centre(), TOY.centre().with_y(TOY.max.y)];
    let lights = [(BULB_AT, radius_m), (near, radius_m), (near, 0.0)];
    let bulbs = lights.map(|(at, radius_m)| rig.bulb(at, radius_m));
    let mut reach = Reach::new(&view, &TOY, &layout(&receivers, &bulbs));
    points.into_iter().for_each(|point| reach.include(point));
    for ((at, radius_m), found_px) in lights.into_iter().zip(reach.penumbrae_px()) {
        let widths_px = points.map(|point| widest_px(&rig, point, at, radius_m));
        let widest_px = widths_px.into_iter().fold(0.0, f64::max);
        // Two of its diameters are tested.
        let is_near = (0.7 * widest_px..=1.02 * widest_px).contains(found_px);
        assert!(is_near, "{found_px} where {widest_px} is the widest");
    }
    // A bulb no higher than the toy casts a shadow without an end.
    let low = [rig.bulb(DVec3::new(0.4, TOY.max.y, 0.0), radius_m)];
    let mut reach = Reach::new(&view, &TOY, &layout(&receivers, &low));
    reach.include(points[2]);
    assert_eq!(reach.penumbrae_px(), [f64::INFINITY]);
}

#[test]
fn the_region_of_some_points_is_within_that_of_their_box() {
    let rig = Rig::new(DVec3::ZERO);
    let (view, receivers, lights) = (rig.view(), [rig.receiver()], [rig.bulb(BULB_AT, 0.0)]);
    let mut reach = Reach::new(&view, &TOY, &layout(&receivers, &lights));
    assert_eq!(reach.region(), None, "nothing is in reach of nothing");
    let points = [TOY.min, TOY.centre(), TOY.centre().with_y(TOY.max.y)];
    points.into_iter().for_each(|point| reach.include(point));
    let region = reach.region().unwrap();
    for point in points {
        assert_holds(&region, rig.image_px, rig.pixel(point), "a point");
        assert_holds(
            &region,
            rig.image_px,
            rig.pixel(shadow(point, BULB_AT)),
            "a shadow",
        );
    }
    let boxed = rig.region(&TOY, &lights).unwrap();
    assert!(boxed.contains(&region) && !region.contains(&boxed));
}

/// A low light beside the toy casts its shadow on a wall behind it, beyond a small table.
#[test]
fn shadows_on_a_wall_count_where_its_front_is_seen() {
    let mut rig = Rig::new(DVec3::ZERO);
    let light = [rig.bulb(DVec3::new(0.5, 0.3, 0.15), 0.0)];
    let anchor_from_wall =
        DMat4::from_rotation_translation(DQuat::from_rotation_x(FRAC_PI_2), DVec3::new(0.0, 0.0, -0.1));
    let wall = AnchoredReceiver {
        world_from_plane: rig.world_from_plane() * anchor_from_wall,
        ..rig.receiver()
    };
    let table = AnchoredReceiver {
        rect: square(0.1),
        ..rig.receiver()
    };
    let receivers = [table, wall];
    for (z_m, is_before) in [(1.2, true), (-1.2, false)] {
        rig.place_camera(DVec3::new(0.0, 1.0, z_m), DVec3::ZERO);
        let view = rig.view();
        let [alone, both] = [1, 2].map(|n| view.region(&TOY, &layout(&receivers[..n], &light)).unwrap());
        assert!(both.contains(&alone));
        assert_eq!(both != alone, is_before, "{both:?} and {alone:?}");
    }
}

#[test]
fn a_rectangle_grows_as_far_as_the_image_goes() {
    let image_px = UVec2::new(640, 480);
    let rect = PixelRect {
        origin_px: UVec2::new(10, 100),
        size_px: UVec2::new(50, 375),
    };
    let grown = PixelRect {
        origin_px: UVec2::new(0, 68),
        size_px: UVec2::new(92, 412),
    };
    assert_eq!(rect.grown(32, image_px), grown);
    assert_eq!(rect.grown(0, image_px), rect);
}

#[test]
fn without_a_bound_the_region_is_the_image() {
    let mut rig = Rig::new(DVec3::ZERO);
    let whole = Some(PixelRect {
        origin_px: UVec2::ZERO,
        size_px: rig.image_px,
    });
    let low = rig.bulb(DVec3::new(-0.6, 0.15, 0.0), 0.0);
    assert_eq!(
        rig.region(&TOY, &[low]),
        whole,
        "a light lower than the toy casts a shadow without end"
    );
    rig.place_camera(DVec3::new(0.0, 0.1, 0.0), DVec3::new(0.0, 0.1, -1.0));
    assert_eq!(
        rig.region(&TOY, &[rig.bulb(BULB_AT, 0.0)]),
        whole,
        "the camera is inside the toy"
    );
    // Its shadow continues below and in front of the camera.
    rig.place_camera(DVec3::new(0.0, 0.3, -0.2), DVec3::new(0.0, 0.3, -1.0));
    assert_eq!(
        rig.region(&TOY, &[rig.bulb(DVec3::new(0.0, 0.3, 0.6), 0.0)]),
        whole,
        "the toy is behind the camera"
    );
}

#[test]
fn what_is_all_behind_the_camera_has_no_region() {
    let mut rig = Rig::new(DVec3::ZERO);
    rig.place_camera(DVec3::new(0.0, 0.3, -0.2), DVec3::new(0.0, 0.3, -1.0));
    assert_eq!(rig.region(&TOY, &[rig.bulb(BULB_AT, 0.0)]), None);
}

#[test]
fn a_toy_beside_the_picture_has_no_region() {
    let rig = Rig::new(DVec3::ZERO);
    // Along the image's rows, so far that its shadow is outside the picture too.
    let to_the_right = points_on_plane()
        .max_by(|a, b| rig.pixel(*a).x.total_cmp(&rig.pixel(*b).x))
        .unwrap();
    let away = 3.0 * to_the_right.normalize();
    let toy = Bounds {
        min: TOY.min + away,
        max: TOY.max + away,
    };
    assert!(
        toy.corners()
            .all(|corner| rig.depth_m(corner) > 0.1 && rig.pixel(corner).x > 700.0)
    );
    assert_eq!(rig.region(&toy, &[rig.bulb(BULB_AT + away, 0.0)]), None);
    assert!(rig.region(&TOY, &[rig.bulb(BULB_AT, 0.0)]).is_some());
}

#[test]
fn a_rectangle_holds_itself_and_smaller_ones() {
    let smaller = PixelRect {
        origin_px: RECT.origin_px + 1,
        size_px: RECT.size_px - 1,
    };
    assert!(RECT.contains(&RECT) && RECT.contains(&smaller) && !smaller.contains(&RECT));
    let moved = PixelRect {
        origin_px: RECT.origin_px + UVec2::X,
        ..RECT
    };
    assert!(!RECT.contains(&moved) && !moved.contains(&RECT));
}
