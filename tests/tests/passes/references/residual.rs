//! Known residuals, pooled and filled.

use glam::{DVec3, DVec4, UVec2};
use reference::fill::fill;
use reference::grid::Cell;
use reference::model::Pictures;
use reference::raster::Raster;
use reference::residual::pool;

use crate::references::flat::{grid, region, scatter, truth, two_bulbs};

/// Neither side is a multiple of the other, of a power of two or of a cell.
const SIZE: UVec2 = UVec2::new(61, 37);

fn known(residual: DVec3) -> Cell {
    Cell {
        value: residual,
        certainty: 1.0,
    }
}

/// Whether a cell lies under a toy in the centre.
fn is_hidden(at: UVec2) -> bool {
    (20..41).contains(&at.x) && (9..30).contains(&at.y)
}

#[test]
fn constant_residual_is_pooled_as_it_is() {
    let region = region(SIZE, two_bulbs());
    let solution = truth(2);
    // Small enough that the weights stay full, or the hidden pixels would have an effect.
    let residual = DVec3::new(0.004, -0.003, 0.002);
    let visibility = DVec4::new(0.8, 0.4, 0.0, 0.0);
    let texture = |at: UVec2| DVec3::splat(0.3) + 0.4 * scatter(at.x + 61 * at.y, 0);
    let mut pictures = Pictures {
        plate: Raster::from_fn(SIZE, texture),
        frame: Raster::from_fn(SIZE, texture),
        seen: Raster::from_fn(SIZE, |at| if is_hidden(at) { 0.0 } else { 1.0 }),
        visibility: Raster::from_fn(SIZE, |_| visibility),
        ambient: Raster::from_fn(UVec2::new(7, 5), |_| 0.9),
    };
    pictures.frame = Raster::from_fn(SIZE, |at| {
        let point = region.receiver_point(at.as_dvec2() + 0.5).unwrap();
        let model = solution.receiver_model(&region, point, 0.9, visibility);
        if is_hidden(at) {
            DVec3::ONE
        } else {
            solution.gain * pictures.plate.at(at) * (model + residual)
        }
    });
    let cells = pool(&region, &pictures, &solution, (0, &grid(SIZE, 4)));
    assert_eq!(cells.size(), UVec2::new(16, 10));
    let full = cells.at(UVec2::ZERO);
    assert!((full.certainty - 1.0).abs() < 1e-12, "{full:?}");
    let hidden = cells.at(UVec2::new(7, 4));
    assert_eq!(hidden, Cell::default());
    for value in fill(&cells).texels() {
        assert!((value - residual).abs().max_element() < 1e-12, "{value}");
    }
}

#[test]
fn hidden_patch_of_a_slope_stays_within_its_surroundings() {
    let slope = |at: UVec2| DVec3::new(f64::from(at.x), f64::from(at.y), f64::from(at.x + at.y)) * 0.01;
    let cells = Raster::from_fn(SIZE, |at| {
        if is_hidden(at) {
            Cell::default()
        } else {
            known(slope(at))
        }
    });
    let filled = fill(&cells);
    let mut worst = 0.0_f64;
    for at in Raster::from_fn(SIZE, |at| at).texels() {
        let error = filled.at(*at) - slope(*at);
        if is_hidden(*at) {
            let (low, high) = (slope(UVec2::ZERO), slope(SIZE - 1));
            assert!(
                filled.at(*at).cmpge(low).all() && filled.at(*at).cmple(high).all(),
                "{at}"
            );
            worst = worst.max(error.abs().max_element());
        } else {
            assert!(error.abs().max_element() < 1e-12, "a known cell changed at {at}");
        }
    }
    // The steepest channel changes by 0.42 across the patch, so that the nearest known cell would
    // differ by 0.21. Measured: 0.024.
    assert!(worst < 0.05, "off by {worst}");
}

#[test]
fn nothing_known_is_zero_and_little_known_is_finite() {
    for size in [UVec2::ONE, UVec2::new(1, 64), SIZE, UVec2::splat(64)] {
        let nothing = Raster::from_fn(size, |_| Cell::default());
        assert!(
            fill(&nothing).texels().iter().all(|value| *value == DVec3::ZERO),
            "{size}"
        );
        let little = Raster::from_fn(size, |at| Cell {
            value: DVec3::splat(0.1),
            certainty: if at == UVec2::ZERO { 1e-6 } else { 0.0 },
        });
        let within = |value: &DVec3| value.is_finite() && (0.0..=0.1).contains(&value.x);
        assert!(fill(&little).texels().iter().all(within), "{size}");
    }
}
