//! The parts of a light and of the sky that a rectangle hides, against rays.

use app_scene::geometry::disc::{ambient_directions, vogel_disc};
use app_scene::geometry::opaque::{UNLIT_FACE, darkness_of_faces, hidden_light, hidden_sky};
use app_scene::scene::Light;
use glam::{DMat4, DQuat, DVec2, DVec3};

/// A book's top in its own space: its smallest and largest (x, z).
const TOP: [DVec2; 2] = [DVec2::new(-0.06, -0.04), DVec2::new(0.06, 0.04)];
const HEIGHT_M: f64 = 0.03;
/// Faces without any light of their own.
const BLACK: [f64; 4] = [1.0; 4];

/// Whether a ray that rises from a point beside the book meets it.
fn meets_book(from: DVec3, along: DVec3) -> bool {
    meets_solid(DVec3::Y, from, along)
}

/// The same for the solid from the top down against `up`.
fn meets_solid(up: DVec3, from: DVec3, along: DVec3) -> bool {
    // Points of a vertical line differ in their height over the top alone.
    let sheared = |at: DVec3| at - up * (at.y / up.y) + DVec3::Y * at.y;
    let [from, along] = [from, along].map(sheared);
    let low = DVec3::new(TOP[0].x, f64::NEG_INFINITY, TOP[0].y);
    let high = DVec3::new(TOP[1].x, 0.0, TOP[1].y);
    let [a, b] = [low, high].map(|end| (end - from) / along);
    a.min(b).max_element().max(0.0) < a.max(b).min_element()
}

/// Points beside the book and below its top, in the space of the top.
fn places() -> impl Iterator<Item = DVec3> {
    let places = [
        [0.065, 0.0],
        [0.1, 0.02],
        [0.075, 0.06],
        [-0.02, 0.05],
        [-0.2, -0.1],
    ];
    places.into_iter().map(|[x, z]| DVec3::new(x, -HEIGHT_M, z))
}

/// A book, and a box that is taller than deep: light meets their faces, too.
#[test]
fn light_behind_a_thing() {
    for height_m in [HEIGHT_M, 0.15] {
        check_light(height_m);
    }
}

fn check_light(height_m: f64) {
    let lights = [
        Light::sphere(DVec3::new(-0.3, 0.4, 0.05), 0.03),
        Light::sphere(DVec3::new(0.1, 0.5, -0.6), 0.08),
        Light::directional(DVec3::new(-0.6, 0.64, -0.48), 0.1),
    ];
    let (mut n_part, mut largest) = (0, [0.0_f64; 2]);
    for light in lights {
        let along = (1..814).map(|i| DVec3::new(TOP[1].x + 0.00025 * f64::from(i), 0.0, 0.03));
        for from in places().chain(along) {
            let from = DVec3::new(from.x, -height_m, from.z);
            let [hidden, part] = parts(from, DVec3::Y, light);
            n_part += usize::from(part > 0.1 && part < 0.9);
            let is_near = from.x < TOP[1].x + AT_FACE_M;
            let largest = &mut largest[usize::from(is_near)];
            *largest = largest.max((hidden - part).abs());
        }
    }
    assert!(n_part > 30, "{n_part} points are in a penumbra");
    // Each line cuts the disc by itself. Measured: 0.031.
    assert!(largest[0] < 0.04, "off by {}", largest[0]);
    // There the edge of a face and the side of the thing both cut the disc, which counts as if they cut
    // it one by one. Measured: 0.099.
    assert!(largest[1] < 0.105, "off by {} at a face", largest[1]);
}

/// Distance from a face up to which its edge and the thing's side both cut a light's disc.
const AT_FACE_M: f64 = 0.0035;

/// The part of a light that is hidden, and that part by rays.
fn parts(from: DVec3, up: DVec3, light: Light) -> [f64; 2] {
    let centre = light.centre_in(&DMat4::IDENTITY);
    let to_light = centre.truncate() - centre.w * from;
    let (across, along) = to_light.normalize().any_orthonormal_pair();
    let points: Vec<DVec2> = vogel_disc(2000).collect();
    let to = |at: &DVec2| to_light + light.radius() * (at.x * across + at.y * along);
    let met = points.iter().filter(|at| meets_solid(up, from, to(at)));
    let part = met.count() as f64 / points.len() as f64;
    [hidden_light(from, up, centre, light.radius(), TOP), part]
}

/// A ramp of 30 degrees, whose low edge is on the ground: one light is behind its high edge, 25
/// degrees high and so below the plane of its top, one is opposite, and two are beside it.
#[test]
fn light_behind_a_ramp() {
    let tilt = DQuat::from_rotation_z(-std::f64::consts::FRAC_PI_6);
    let up = tilt * DVec3::Y;
    let lights = [
        // Small, since it grazes the top: its disc is projected as if the top were far from it.
        ([1.0, 0.466, 0.0], 0.015),
        ([-1.0, 0.7, 0.1], 0.06),
        ([0.3, 0.8, 0.7], 0.06),
        ([0.6, 0.9, -0.5], 0.06),
    ];
    let (mut n_part, mut n_above, mut largest) = (0, 0, 0.0_f64);
    for (to_light, radius) in lights {
        let light = Light::directional(tilt * DVec3::from(to_light).normalize(), radius);
        let line = (0..400)
            .map(|i| [-0.25 + 0.00125 * f64::from(i), 0.002, 0.06])
            .map(|[x, z, beside]| {
                let is_below = x.abs() < 0.06;
                [x, if is_below { z - beside } else { z }]
            });
        for [x, z] in line {
            let from = tilt * DVec3::new(x, -0.03, z);
            let [hidden, part] = parts(from, up, light);
            n_part += usize::from(part > 0.1 && part < 0.9);
            n_above += usize::from(from.y > 0.0);
            largest = largest.max((hidden - part).abs());
        }
    }
    assert!(
        n_part > 20 && n_above > 300,
        "{n_part} in a penumbra, {n_above} above the top's plane"
    );
    // Measured: 0.043.
    assert!(largest < 0.05, "off by {largest}");
}

#[test]
fn light_before_a_rectangle_is_not_hidden() {
    let light = Light::sphere(DVec3::new(0.0, 0.4, 0.0), 0.01).centre_in(&DMat4::IDENTITY);
    assert_eq!(
        hidden_light(DVec3::new(0.0, 0.1, 0.0), DVec3::Y, light, 0.01, TOP),
        0.0
    );
    // A light below the top, and one as high as it.
    let below = DVec3::new(0.0, -0.02, 0.0);
    for y in [-0.01, 0.0] {
        let light = Light::sphere(DVec3::new(0.0, y, 0.0), 0.01).centre_in(&DMat4::IDENTITY);
        assert_eq!(hidden_light(below, DVec3::Y, light, 0.01, TOP), 0.0, "{y}");
    }
    let point = Light::sphere(DVec3::new(0.0, 0.4, 0.0), 0.0).centre_in(&DMat4::IDENTITY);
    assert_eq!(hidden_light(below, DVec3::Y, point, 0.0, TOP), 1.0);
    // Below the top no pixel shows the table, but a side, which a light beside the top may reach.
    let beside = Light::sphere(DVec3::new(0.3, 0.1, 0.0), 0.0).centre_in(&DMat4::IDENTITY);
    let at_side = DVec3::new(0.055, -0.02, 0.0);
    assert_eq!(hidden_light(at_side, DVec3::Y, beside, 0.0, TOP), 0.0);
}

#[test]
fn sky_behind_a_book() {
    let directions = ambient_directions(20_000);
    // The table is turned below the book.
    let table_from_top =
        DMat4::from_rotation_translation(DQuat::from_rotation_y(0.4), DVec3::new(0.3, HEIGHT_M, -0.2));
    for from in places() {
        let met = directions
            .iter()
            .filter(|along| meets_book(from, along.truncate().as_dvec3()));
        let part = met.count() as f64 / directions.len() as f64;
        let at = table_from_top.transform_point3(from);
        let hidden = hidden_sky(DVec2::new(at.x, at.z), &table_from_top, TOP, BLACK);
        assert!((hidden - part).abs() < 2e-3, "{from}: {hidden} for {part}");
    }
    let at = |x: f64| {
        hidden_sky(
            DVec2::new(x, 0.0),
            &DMat4::from_translation(HEIGHT_M * DVec3::Y),
            TOP,
            BLACK,
        )
    };
    assert!(at(0.061) > 0.4, "beside the book: {}", at(0.061));
    // Neither a wall nor what is below hides any.
    let wall = DMat4::from_rotation_x(std::f64::consts::FRAC_PI_2);
    assert_eq!(hidden_sky(DVec2::new(0.1, 0.0), &wall, TOP, BLACK), 0.0);
    let below = DMat4::from_translation(-HEIGHT_M * DVec3::Y);
    assert_eq!(hidden_sky(DVec2::new(0.1, 0.0), &below, TOP, BLACK), 0.0);
}

/// A light is before the face with the largest x, and behind the others.
#[test]
fn a_face_that_a_light_meets_is_dark() {
    let unlit = f64::from(UNLIT_FACE);
    let beside = DVec3::new(1.0, 0.4, 0.0);
    for light in [beside.extend(1.0), beside.normalize().extend(0.0)] {
        assert_eq!(darkness_of_faces(TOP, &[light]), [unlit, 1.0, unlit, unlit]);
    }
    let above = DVec3::new(0.0, 0.4, 0.0).extend(1.0);
    assert_eq!(darkness_of_faces(TOP, &[above]), [unlit; 4]);
    assert_eq!(
        darkness_of_faces(TOP, &[above, DVec3::new(-1.0, 0.1, -1.0).extend(1.0)]),
        [1.0, unlit, unlit, 1.0]
    );
}
