//! Triangles that face a light or the camera.

use std::f32::consts::TAU;

use app_pipeline::geometry::silhouette::Viewers;
use glam::{Vec3, Vec4, Vec4Swizzles};

/// A closed ball about the origin, of radius 1: positions, and corners counter-clockwise seen from outside.
fn ball(n_around: u32, n_along: u32) -> (Vec<Vec3>, Vec<u32>) {
    let at = |ring: u32, step: u32| {
        let (polar, turn) = (
            0.5 * TAU * ring as f32 / n_along as f32,
            TAU * step as f32 / n_around as f32,
        );
        Vec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin())
    };
    let positions = (0..=n_along).flat_map(|ring| (0..n_around).map(move |step| (ring, step)));
    let positions = positions.map(|(ring, step)| at(ring, step)).collect();
    let corner = |ring: u32, step: u32| ring * n_around + step % n_around;
    let squares = (0..n_along).flat_map(|ring| (0..n_around).map(move |step| (ring, step)));
    let corners = squares.flat_map(|(ring, step)| {
        let [a, b, c, d] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(r, s)| corner(ring + r, step + s));
        [a, b, c, b, d, c]
    });
    (positions, corners.collect())
}

/// Whether one of the points is on the outer side, by its definition.
fn is_seen([a, b, c]: [Vec3; 3], points: &[Vec4]) -> bool {
    let normal = (b - a).cross(c - a);
    points
        .iter()
        .any(|point| normal.dot(point.xyz() - point.w * a) > 0.0)
}

#[test]
fn what_a_point_sees_stays_and_about_half_of_a_ball_goes() {
    let (positions, corners) = ball(40, 21);
    let lamp = |x: f32, y: f32| Vec4::new(2.0 + x, 3.0, y, 1.0);
    let cases = [
        ("the camera", vec![Vec4::new(0.5, 2.0, 4.0, 1.0)], 0.45),
        ("the sun", vec![Vec4::new(0.6, 0.8, 0.0, 0.0)], 0.55),
        (
            "a lamp",
            vec![lamp(0.3, 0.0), lamp(-0.3, 0.0), lamp(0.0, 0.3), lamp(0.0, -0.3)],
            0.55,
        ),
    ];
    for (name, points, most) in cases {
        let viewers = Viewers::around(&points).expect("points of one kind");
        let facing = viewers.facing(&positions, &corners);
        let kept: Vec<&[u32; 3]> = facing.as_chunks().0.iter().collect();
        for triangle in corners.as_chunks::<3>().0 {
            let places = triangle.map(|corner| positions[corner as usize]);
            let is_kept = kept.contains(&triangle);
            assert!(
                is_kept || !is_seen(places, &points),
                "{name}: {triangle:?} is lost"
            );
        }
        let part = facing.len() as f64 / corners.len() as f64;
        assert!(part < most, "{name}: {part} of all is kept");
    }
}

#[test]
fn points_and_directions_at_once_see_no_side_alone() {
    assert_eq!(Viewers::around(&[]), None);
    assert_eq!(Viewers::around(&[Vec4::W, Vec4::Y]), None);
}
