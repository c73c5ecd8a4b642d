//! `tint` compared with its known properties.

use app_pipeline::model::state::tints::TintGrid;
use glam::{DVec3, UVec3};
use reference::tint::{SeenPaint, Volume, tints};

const SIDE: u32 = 16;
const GRID: TintGrid = TintGrid {
    corner_in_anchor: [-0.1, 0.0, 0.2],
    cell_m: 0.01,
    n_materials: 2,
    _pad_0: 0,
    _pad_1: [0; 2],
};
const EXPECTED: DVec3 = DVec3::new(0.3, 0.2, 0.1);
const PAINT: DVec3 = DVec3::new(1.5, 0.5, 1.0);

/// Many pixels in the centre of a cell.
fn seen(cell: UVec3, material: usize, paint: DVec3) -> Vec<SeenPaint> {
    let corner = DVec3::new(-0.1, 0.0, 0.2);
    let pixel = SeenPaint {
        in_anchor: corner + 0.01 * (cell.as_dvec3() + 0.5),
        material,
        seen: paint * EXPECTED,
        shown: paint * EXPECTED,
        expected: EXPECTED,
        weight: 1.0,
    };
    vec![pixel; 100]
}

fn tint(volume: &Volume, cell: UVec3) -> DVec3 {
    volume.at(cell).truncate()
}

fn assert_near(actual: DVec3, expected: DVec3, what: &str) {
    assert!(actual.abs_diff_eq(expected, 0.02), "{what}: {actual}");
}

#[test]
fn one_paint_is_that_of_all_hidden_parts_of_its_material() {
    let volumes = tints(&GRID, &seen(UVec3::new(3, 9, 12), 0, PAINT));
    for cell in [UVec3::ZERO, UVec3::new(3, 9, 12), UVec3::splat(SIDE - 1)] {
        assert_near(tint(&volumes[0], cell), PAINT, "its own material");
        assert_near(
            tint(&volumes[1], cell),
            DVec3::ONE,
            "a material that was never seen",
        );
    }
}

#[test]
fn of_two_paints_the_nearer_counts() {
    let (low, high) = (UVec3::new(1, 8, 8), UVec3::new(14, 8, 8));
    let mut both = seen(low, 0, PAINT);
    both.extend(seen(high, 0, 1.0 / PAINT));
    let volume = &tints(&GRID, &both)[0];
    assert_near(tint(volume, low), PAINT, "where it was seen");
    assert_near(tint(volume, high), 1.0 / PAINT, "where it was seen");
    let reds: Vec<f64> = (1..15).map(|x| tint(volume, UVec3::new(x, 7, 8)).x).collect();
    let mean = 0.5 * (PAINT.x + 1.0 / PAINT.x);
    assert!(reds[0] > mean + 0.1 && reds[13] < mean - 0.1, "{reds:?}");
    assert!(reds.windows(2).all(|pair| pair[1] <= pair[0]), "{reds:?}");
}

#[test]
fn what_is_clipped_or_nearly_black_tells_nothing() {
    let cell = UVec3::splat(5);
    let clipped = seen(cell, 0, DVec3::ONE / EXPECTED);
    assert_near(tint(&tints(&GRID, &clipped)[0], cell), DVec3::ONE, "clipped");
    let black = SeenPaint {
        seen: DVec3::splat(1e-5),
        shown: DVec3::splat(1e-5),
        expected: DVec3::splat(2e-4),
        ..seen(cell, 0, PAINT)[0]
    };
    let tint = tint(&tints(&GRID, &[black; 100])[0], cell);
    assert!((0.9..1.0).contains(&tint.x), "{tint}");
}
