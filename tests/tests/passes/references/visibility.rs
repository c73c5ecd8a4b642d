//! Shadows with a closed form: of a half plane, of a square and of a disc, all level.

use std::f64::consts::{PI, TAU};

use app_core::scene::Light;
use app_scene::geometry::disc::ambient_directions;
use glam::{DMat4, DVec2, DVec3, DVec4, UVec2};
use reference::occlusion::{Caster, Occluder};
use reference::real::Real;
use reference::visibility::{exact_visibility, visibility_map};

use crate::references::flat;

/// Height of the light over the centre of the square.
const LIGHT_M: f64 = 1.0;
const RADIUS_M: f64 = 0.05;
/// Height of the square, and half its side.
const HEIGHT_M: f64 = 0.25;
const HALF_SIDE_M: f64 = 0.3;
/// Position of the shadow's edge, and half the width of the penumbra there: the light's edge is at
/// plus and minus R, and the occluder's edge mirrors it by h / (d - h).
const EDGE_M: f64 = HALF_SIDE_M * LIGHT_M / (LIGHT_M - HEIGHT_M);
const HALF_PENUMBRA_M: f64 = RADIUS_M * HEIGHT_M / (LIGHT_M - HEIGHT_M);

pub(crate) fn square<R: Real>() -> Occluder<R> {
    let corner = |x: f64, z: f64| HALF_SIDE_M * DVec3::new(x, 0.0, z) + HEIGHT_M * DVec3::Y;
    let corners = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    Occluder::new(&corners, &[0, 1, 2, 0, 2, 3])
}

pub(crate) fn bulb() -> Light {
    Light::Sphere {
        position_in_world: DVec3::new(0.0, LIGHT_M, 0.0),
        radius_m: RADIUS_M,
    }
}

/// Share of a disc that lies beyond a straight edge at `offset` radii from its centre.
pub(crate) fn disc_beyond(offset: f64) -> f64 {
    let c = offset.clamp(-1.0, 1.0);
    (c.acos() - c * (1.0 - c * c).sqrt()) / PI
}

fn share_hidden(occluder: &Occluder, at: DVec2, points: &[DVec4]) -> f64 {
    let n_hidden = points.iter().filter(|point| occluder.hides(at, **point)).count();
    f64::from(u32::try_from(n_hidden).unwrap()) / f64::from(u32::try_from(points.len()).unwrap())
}

#[test]
fn penumbra_of_an_edge_follows_the_circle_segment() {
    let occluder = square::<f64>();
    let points: Vec<DVec4> = bulb()
        .points_in(&DMat4::IDENTITY, DVec3::ZERO, 4096)
        .iter()
        .map(|point| point.as_dvec4())
        .collect();
    for step in -12..=12 {
        let across = f64::from(step) / 10.0;
        let at = DVec2::new(EDGE_M + across * HALF_PENUMBRA_M, 0.01);
        // Outwards of the edge's centre, the far part of the light becomes visible.
        let expected = 1.0 - disc_beyond(across);
        let from_points = 1.0 - share_hidden(&occluder, at, &points);
        // The error of a sunflower of n points is about n^-3/4.
        assert!(
            (from_points - expected).abs() < 2e-3,
            "{across}: {from_points}, not {expected}"
        );
    }
}

#[test]
fn penumbra_of_a_bulb_follows_its_distance_from_the_plane_through_the_edge() {
    for step in -12..=12 {
        let at_m = EDGE_M + 0.1 * f64::from(step) * HALF_PENUMBRA_M;
        let past_edge = DVec2::new(HALF_SIDE_M - at_m, HEIGHT_M).normalize();
        let to_bulb = DVec2::new(-at_m, LIGHT_M);
        let expected = 1.0 - disc_beyond(past_edge.perp_dot(to_bulb) / -RADIUS_M);
        let actual = exact_visibility(&square::<f64>(), DVec2::new(at_m, 0.01), &bulb(), 4096);
        // The bulb's lower side has less weight by its cosine, which changes by tan 22 degrees
        // times R / d over a radius; at half shadow the centroids of both halves are 0.42 radii
        // from the centre: 0.5 0.42 0.4 0.05 or 4e-3 in all, in addition to the sunflower's 2e-3.
        assert!(
            (actual - expected).abs() < 6e-3,
            "{at_m} m: {actual}, not {expected}"
        );
    }
}

#[test]
fn umbra_is_dark_and_everything_beyond_the_penumbra_is_lit() {
    let occluder = square::<f64>();
    // The bulb is seen 22 degrees from the side, which widens its outline by 1 / cos 22 degrees.
    for (at_m, expected) in [
        (0.0, 0.0),
        (EDGE_M - 1.15 * HALF_PENUMBRA_M, 0.0),
        (EDGE_M + 1.15 * HALF_PENUMBRA_M, 1.0),
        (5.0, 1.0),
    ] {
        let visibility = exact_visibility(&occluder, DVec2::new(at_m, 0.0), &bulb(), 1024);
        assert!((visibility - expected).abs() < 1e-12, "{at_m} m: {visibility}");
    }
}

#[test]
fn directional_light_has_the_penumbra_of_its_angle() {
    let angular_radius_rad = 0.02_f64;
    let light = Light::Directional {
        direction_to_light_in_world: DVec3::Y,
        angular_radius_rad,
    };
    for across in [-1.1, -0.5, 0.0, 0.3, 0.9, 1.1] {
        let at = DVec2::new(HALF_SIDE_M + across * HEIGHT_M * angular_radius_rad.tan(), 0.0);
        let visibility = exact_visibility(&square::<f64>(), at, &light, 4096);
        let expected = 1.0 - disc_beyond(across);
        assert!(
            (visibility - expected).abs() < 3e-3,
            "{across}: {visibility}, not {expected}"
        );
    }
}

#[test]
fn what_is_above_the_light_hides_nothing() {
    let below = Light::Sphere {
        position_in_world: DVec3::new(0.0, 0.9 * HEIGHT_M, 0.0),
        radius_m: 0.0,
    };
    assert!((exact_visibility(&square::<f64>(), DVec2::ZERO, &below, 16) - 1.0).abs() < 1e-12);
}

#[test]
fn disc_hides_its_form_factor_of_the_ambient_light() {
    let n_corners = 720_u32;
    for (radius_m, height_m) in [(0.1, 0.1), (0.2, 0.1), (0.1, 0.4)] {
        let rim = (0..n_corners).map(|i| {
            let at = radius_m * DVec2::from_angle(TAU * f64::from(i) / f64::from(n_corners));
            DVec3::new(at.x, height_m, at.y)
        });
        let corners: Vec<DVec3> = rim.chain([DVec3::new(0.0, height_m, 0.0)]).collect();
        let fan: Vec<u32> = (0..n_corners)
            .flat_map(|i| [n_corners, i, (i + 1) % n_corners])
            .collect();
        let directions: Vec<DVec4> = ambient_directions(4096).iter().map(|d| d.as_dvec4()).collect();
        let hidden = share_hidden(&Occluder::new(&corners, &fan), DVec2::ZERO, &directions);
        let expected = radius_m * radius_m / (radius_m * radius_m + height_m * height_m);
        // The directions of a centred disc are the first ones of the sunflower: the error is at
        // most one of 4096, and that of the polygon 1e-5 of the disc.
        assert!(
            (hidden - expected).abs() < 3e-4,
            "{radius_m} m at {height_m} m: {hidden}, not {expected}"
        );
    }
}

#[test]
fn map_looks_through_the_four_positions_of_a_pixel() {
    // One light straight above each point, and a square that ends within a pixel.
    let region = flat::region(UVec2::splat(80), vec![DVec4::Y]);
    let end_m = HALF_SIDE_M - 0.5 * flat::PIXEL_M;
    let corner = |x: f64, z: f64| DVec3::new(end_m * x, HEIGHT_M, end_m * z);
    let corners = [
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
    ];
    let caster: Caster = Caster {
        occluder: Occluder::new(&corners, &[0, 1, 2, 0, 2, 3]),
        light_points: vec![DVec4::Y; 4],
    };
    let map = visibility_map(&[caster], &region, region.size_px);
    // The edge is in the centre of column 69: two of four positions are on each side.
    for (column, expected) in [(68, 0.0), (69, 0.5), (70, 1.0)] {
        let visibility = map.at(UVec2::new(column, 40));
        assert!(
            (visibility - expected).abs() < 1e-12,
            "column {column}: {visibility}"
        );
    }
}
