//! Points over a light and directions over the hemisphere, compared with the moments of disc and
//! hemisphere.

use app_core::preset::{Preset, Settings};
use app_core::scene::Light;
use app_scene::geometry::disc::ambient_directions;
use glam::{DMat4, DQuat, DVec2, DVec3, Vec4};

/// Relative rounding of a result in f32.
const F32: f64 = 1e-6;
const N_POINTS: [usize; 5] = [4, 16, 32, 48, 64];

const BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(-0.7, 0.9, 0.2),
    radius_m: 0.05,
};
const TOY: DVec3 = DVec3::new(0.1, 0.08, -0.3);

/// A receiver that is neither level nor at the origin.
fn plane_from_world() -> DMat4 {
    DMat4::from_rotation_translation(
        DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 0.2),
        DVec3::new(0.4, 0.5, -0.2),
    )
}

/// Points of the bulb around its centre, across the line to the toy, in units of its outline's
/// radius there.
fn bulb_disc(n_points: usize) -> Vec<DVec2> {
    let plane_from_world = plane_from_world();
    let centre = plane_from_world.transform_point3(BULB.position_in_world().unwrap());
    let distance_m = centre.distance(TOY);
    let outline_m = distance_m * (BULB.radius() / distance_m).asin().tan();
    let axis = (centre - TOY).normalize();
    let (x, y) = axis.any_orthonormal_pair();
    BULB.points_in(&plane_from_world, TOY, n_points)
        .into_iter()
        .map(|point| {
            assert_eq!(point.w, 1.0);
            let at = (point.truncate().as_dvec3() - centre) / outline_m;
            assert!(at.dot(axis).abs() < 1e-4, "the disc faces the toy");
            DVec2::new(at.dot(x), at.dot(y))
        })
        .collect()
}

fn mean<T: Copy + std::iter::Sum<T> + std::ops::Div<f64, Output = T>>(values: &[T]) -> T {
    let n = values.len() as f64;
    values.iter().copied().sum::<T>() / n
}

/// Mean of x^2, y^2 and x y.
fn second_moments(points: &[DVec2]) -> [f64; 3] {
    let of = |f: fn(&DVec2) -> f64| mean(&points.iter().map(f).collect::<Vec<_>>());
    [of(|p| p.x * p.x), of(|p| p.y * p.y), of(|p| p.x * p.y)]
}

#[test]
fn light_points_have_the_moments_of_a_disc() {
    for n_points in N_POINTS {
        let disc = bulb_disc(n_points);
        assert_eq!(disc.len(), n_points);
        assert!(disc.iter().all(|p| p.length() < 1.0));
        let [xx, yy, xy] = second_moments(&disc);
        // Equal areas: the mean of r^2 is exactly 1/2, half of it on each axis.
        assert!((xx + yy - 0.5).abs() < 1e-4, "{n_points}: {xx} + {yy}");
        let tolerance = 1.0 / f64::from(u32::try_from(n_points).unwrap());
        assert!(
            (xx - 0.25).abs() < tolerance && xy.abs() < tolerance,
            "{n_points}: {xx} {yy} {xy}"
        );
        assert!(mean(&disc).length() < tolerance, "{n_points}: {}", mean(&disc));
    }
}

/// Step in columns and rows from one point's position within a pixel to the next one's, as in
/// `occlusion`.
const POSITION_STEPS: [usize; 2] = [47, 53];

/// Whether each quarter of a pixel has points from the whole light: in each quarter of it, with a
/// centre near its own, and with a mean squared radius no farther from 1/2 than that of the same
/// number of random points on average (its variance is 1/12).
fn is_seen_from_each_quarter(n_points: usize) -> bool {
    let disc = bulb_disc(n_points);
    let random = (1.0 / (12.0 * (n_points / 4) as f64)).sqrt();
    let quarter = |point: usize| {
        let [right, lower] = POSITION_STEPS.map(|step| point * step % n_points >= n_points / 2);
        usize::from(right) + 2 * usize::from(lower)
    };
    (0..4).all(|class| {
        let points = (0..n_points).filter(|point| quarter(*point) == class);
        let own: Vec<DVec2> = points.map(|point| disc[point]).collect();
        let [xx, yy, _] = second_moments(&own);
        let quadrants = own.iter().fold([0; 4], |mut n, p| {
            n[usize::from(p.x > 0.0) + 2 * usize::from(p.y > 0.0)] += 1;
            n
        });
        (xx + yy - 0.5).abs() < random && mean(&own).length() < 0.2 && quadrants.iter().all(|n| *n > 0)
    })
}

/// An edge through a pixel separates its positions, and the points on either side must be a sample
/// of the whole light.
#[test]
fn each_quarter_of_a_pixel_gets_points_from_all_over_the_light() {
    for preset in Preset::ALL {
        if let Settings::Model(settings) = preset.settings() {
            for n_points in [settings.n_light_points, settings.n_narrow_light_points] {
                assert!(is_seen_from_each_quarter(n_points), "{preset}");
            }
        }
    }
    // With 16 there are too few, and with 48 a position's column correlates with its distance from
    // the light's centre.
    assert!(!is_seen_from_each_quarter(16) && !is_seen_from_each_quarter(48));
}

/// A large bulb close by is seen along rays that touch it, not as a disc of its radius.
#[test]
fn a_wide_bulb_fills_the_cone_that_touches_it() {
    let bulb = Light::Sphere {
        position_in_world: DVec3::new(0.0, 1.0, 0.0),
        radius_m: 0.5,
    };
    let angles_rad = bulb
        .points_in(&DMat4::IDENTITY, DVec3::ZERO, 4096)
        .into_iter()
        .map(|point| point.truncate().as_dvec3().angle_between(DVec3::Y));
    let widest_deg = angles_rad.fold(0.0, f64::max).to_degrees();
    assert!((29.9..30.0).contains(&widest_deg), "{widest_deg} degrees");
    // From inside there is no such cone.
    let around = bulb.points_in(&DMat4::IDENTITY, DVec3::new(0.0, 0.6, 0.0), 16);
    assert!(around.iter().all(|point| point.is_finite()));
}

#[test]
fn a_point_light_is_one_point() {
    let bulb = Light::Sphere {
        position_in_world: DVec3::new(-0.7, 0.9, 0.2),
        radius_m: 0.0,
    };
    let centre = bulb.centre_in(&plane_from_world()).as_vec4();
    let points = bulb.points_in(&plane_from_world(), TOY, 4);
    assert_eq!(points, [centre; 4]);
    // A light inside the toy has no direction to face; its points are numbers all the same.
    let inside = BULB.points_in(&DMat4::IDENTITY, DVec3::new(-0.7, 0.9, 0.2), 16);
    assert!(inside.iter().all(|point| point.is_finite()));
}

#[test]
fn the_sun_is_a_cone_of_unit_directions() {
    let to_light = DVec3::new(0.3, 0.8, -0.5).normalize();
    let radius_rad: f64 = 0.2;
    let sun = Light::Directional {
        direction_to_light_in_world: to_light,
        angular_radius_rad: radius_rad,
    };
    let plane_from_world = plane_from_world();
    let axis = plane_from_world.transform_vector3(to_light);
    assert!((sun.centre_in(&plane_from_world).truncate() - axis).length() < 1e-12);
    let tangents: Vec<f64> = sun
        .points_in(&plane_from_world, TOY, 64)
        .into_iter()
        .map(|direction| {
            assert_eq!(direction.w, 0.0);
            let direction = direction.truncate().as_dvec3();
            assert!((direction.length() - 1.0).abs() < F32);
            direction.angle_between(axis).tan()
        })
        .collect();
    assert!(tangents.iter().all(|t| *t < radius_rad.tan()));
    // Points of equal area on the disc that the cone cuts out: the mean of tan^2 is half of the
    // largest.
    let squares: Vec<f64> = tangents.iter().map(|t| t * t).collect();
    assert!((mean(&squares) - 0.5 * radius_rad.tan().powi(2)).abs() < 1e-5);
}

#[test]
fn ambient_directions_are_cosine_weighted() {
    for n_directions in [16, 32, 48, 64] {
        let directions: Vec<DVec3> = ambient_directions(n_directions)
            .into_iter()
            .map(|direction: Vec4| {
                assert_eq!(direction.w, 0.0);
                direction.truncate().as_dvec3()
            })
            .collect();
        assert!(
            directions
                .iter()
                .all(|d| d.y > 0.0 && (d.length() - 1.0).abs() < F32)
        );
        let tolerance = 1.0 / f64::from(u32::try_from(n_directions).unwrap());
        let mean_direction = mean(&directions);
        // With density cos / pi: the mean of the cosine is 2/3, of its square 1/2, and sideways it
        // is zero.
        assert!(
            (mean_direction.y - 2.0 / 3.0).abs() < 0.1 * tolerance,
            "{n_directions}: {mean_direction}"
        );
        assert!(
            mean_direction.x.hypot(mean_direction.z) < tolerance,
            "{n_directions}: {mean_direction}"
        );
        let squares: Vec<f64> = directions.iter().map(|d| d.y * d.y).collect();
        assert!((mean(&squares) - 0.5).abs() < F32);
    }
}
