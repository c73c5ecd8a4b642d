//! The cost of frames is constant outside the region, and grows at most in proportion to its
//! content.

use measure::scaling::{by_area, by_lights, by_picture, by_triangles};
use measure::stability::Sweep;

type Points = [[f64; 2]];

/// Largest cost over smallest.
fn spread(points: &Points) -> f64 {
    let costs = points.iter().map(|point| point[1]);
    costs.clone().fold(0.0, f64::max) / costs.fold(f64::INFINITY, f64::min)
}

/// Largest distance from a straight line through the ends, over the largest cost.
fn bend(points: &Points) -> f64 {
    let ([x0, y0], [x1, y1]) = (points[0], points[points.len() - 1]);
    let off = points
        .iter()
        .map(|[x, y]| (y - (y0 + (x - x0) / (x1 - x0) * (y1 - y0))).abs());
    off.fold(0.0, f64::max) / y0.max(y1)
}

/// Ratio of the cost's growth from the first point to the last to a proportional one.
fn excess(points: &Points) -> f64 {
    let ([x0, y0], [x1, y1]) = (points[0], points[points.len() - 1]);
    (y1 / y0) / (x1 / x0)
}

fn assert_each(sweep: &Sweep, measure: fn(&Points) -> f64, most: f64) {
    assert_eq!(sweep.lines.len(), 3, "a line of each kind of frame");
    for (line, points) in &sweep.lines {
        let found = measure(points);
        assert!(
            points.len() > 3 && found <= most,
            "{}, {line}: {found}, {points:?}",
            sweep.name
        );
    }
}

#[test]
fn cost_is_flat_outside_of_the_region() {
    assert_each(&by_picture().unwrap(), spread, 1.03);
}

#[test]
fn cost_is_linear_in_area_and_lights() {
    assert_each(&by_area().unwrap(), bend, 0.05);
    assert_each(&by_lights().unwrap(), bend, 0.05);
}

#[test]
fn cost_grows_no_faster_than_triangles() {
    assert_each(&by_triangles().unwrap(), excess, 1.0);
}

#[test]
fn what_is_not_linear_is_found() {
    let quadratic: Vec<[f64; 2]> = [1.0, 2.0, 3.0, 4.0].map(|x| [x, x * x]).into();
    assert!(spread(&quadratic) > 1.03 && bend(&quadratic) > 0.05 && excess(&quadratic) > 1.0);
}
