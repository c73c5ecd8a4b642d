//! `lit`, `estimate` and `detail` for a frame that follows the model, so that plate and residual
//! are known.

use glam::{DVec3, DVec4, UVec2};
use reference::detail::{DETAIL, NOISE, evidence, separate};
use reference::estimate::{ESTIMATED, Known, complete};
use reference::fill::fill;
use reference::grid::{Cell, Taken, accumulate};
use reference::lit::pool;
use reference::model::{Pictures, Region, Solution};
use reference::raster::{Raster, texels_of};

use crate::references::flat::{grid, region, scatter, truth, two_bulbs};

const SIZE: UVec2 = UVec2::new(61, 37);
const PLATE: DVec3 = DVec3::new(0.4, 0.5, 0.3);

fn is_hidden(at: UVec2) -> bool {
    (20..41).contains(&at.x) && (9..30).contains(&at.y)
}

/// Full light on the left, almost none on the right.
fn visibility(at: UVec2) -> DVec4 {
    if at.x < 31 {
        DVec4::ONE
    } else {
        DVec4::new(0.3, 0.1, 0.0, 0.0)
    }
}

/// A frame of a place whose plate is `plate`, with `residual` on it, and a toy in the centre.
fn scene(plate: impl Fn(UVec2) -> DVec3, residual: impl Fn(UVec2) -> DVec3) -> (Region, Solution, Pictures) {
    let (region, solution) = (region(SIZE, two_bulbs()), truth(2));
    let ambient = 0.95;
    let frame = Raster::from_fn(SIZE, |at| {
        let point = region.receiver_point(at.as_dvec2() + 0.5).unwrap();
        let model = solution.receiver_model(&region, point, ambient, visibility(at));
        let color = solution.gain * plate(at) * (model + residual(at));
        if is_hidden(at) { DVec3::X } else { color }
    });
    let pictures = Pictures {
        frame,
        plate: Raster::from_fn(SIZE, &plate),
        seen: Raster::from_fn(SIZE, |at| f64::from(u8::from(!is_hidden(at)))),
        visibility: Raster::from_fn(SIZE, visibility),
        ambient: Raster::from_fn(UVec2::new(7, 5), |_| ambient),
    };
    (region, solution, pictures)
}

fn texels() -> impl Iterator<Item = UVec2> {
    texels_of(SIZE)
}

/// A uniform place is recovered unchanged, in the light, in shadow, and under the toy.
#[test]
fn a_plate_is_found_again_in_the_frame() {
    let (region, solution, pictures) = scene(|_| PLATE, |_| DVec3::ZERO);
    let grid = grid(SIZE, 4);
    let cells = pool(&region, &pictures, &solution, (0, &grid, Taken::All));
    assert_eq!(cells.at(UVec2::new(7, 4)), Cell::default(), "the toy is there");
    let bright = cells.at(UVec2::ZERO).certainty;
    assert!(
        bright > cells.at(UVec2::new(14, 0)).certainty,
        "shadow counts less"
    );
    let lit = [(grid, fill(&cells))];
    let known = Known {
        pictures: &pictures,
        photographed: &Raster::from_fn(SIZE, |_| 0.0),
        solution: &solution,
        lit: &lit,
    };
    for is_final in [false, true] {
        for texel in texels() {
            let found = complete(&region, &known, is_final, texel);
            let off = (found.truncate() - PLATE).abs().max_element();
            assert!(off < 1e-12 && found.w == ESTIMATED, "{texel}: {found}");
        }
    }
}

/// A texture is recovered where it is visible, in shadow as well.
#[test]
fn a_texture_is_found_where_it_is_seen() {
    let texture = |at: UVec2| DVec3::splat(0.2 + 0.5 * scatter(at.x + SIZE.x * at.y, 0));
    let (region, solution, pictures) = scene(texture, |_| DVec3::ZERO);
    let lit = [(grid(SIZE, 4), Raster::from_fn(UVec2::new(16, 10), |_| PLATE))];
    let of = |is_photographed: f64, is_final: bool, texel: UVec2| {
        let known = Known {
            pictures: &pictures,
            photographed: &Raster::from_fn(SIZE, |_| is_photographed),
            solution: &solution,
            lit: &lit,
        };
        complete(&region, &known, is_final, texel)
    };
    for texel in texels().step_by(7) {
        let seen = of(0.0, true, texel).truncate();
        let expected = if is_hidden(texel) { PLATE } else { texture(texel) };
        assert!((seen - expected).abs().max_element() < 1e-12, "{texel}: {seen}");
        let smooth = of(0.0, false, texel).truncate();
        assert!((smooth - PLATE).abs().max_element() < 1e-12, "{texel}: {smooth}");
        assert_eq!(
            of(1.0, true, texel),
            texture(texel).extend(1.0),
            "a photograph stays"
        );
    }
}

#[test]
fn what_was_known_counts_by_its_certainty_and_at_most_as_much_as_is_kept() {
    let fresh = |certainty| Cell {
        value: DVec3::splat(0.6),
        certainty,
    };
    // Three certain observations of 0.2, and one of 0.6: a quarter of the way.
    let (cell, accumulated) = accumulate(DVec3::splat(0.6).extend(3.0), fresh(1.0));
    assert!(
        (cell.value - 0.3).abs().max_element() < 1e-12 && cell.certainty == 1.0,
        "{cell:?}"
    );
    assert!(
        (accumulated - DVec3::splat(1.2).extend(4.0)).abs().max_element() < 1e-12,
        "{accumulated}"
    );
    let (cell, accumulated) = accumulate(DVec3::splat(1.6).extend(8.0), fresh(1.0));
    assert!(accumulated.w == 8.0 && (accumulated.truncate() / 8.0 - cell.value).abs().max_element() < 1e-12);
    assert_eq!(accumulate(DVec4::ZERO, fresh(0.5)).0, fresh(0.5));
    assert_eq!(
        accumulate(DVec4::ZERO, fresh(0.0)),
        (Cell::default(), DVec4::ZERO)
    );
}

fn separated(residual: impl Fn(UVec2) -> DVec3, texel: UVec2) -> DVec3 {
    let texture = |at: UVec2| DVec3::splat(0.2 + 0.5 * scatter(at.x + SIZE.x * at.y, 0));
    let (region, solution, pictures) = scene(texture, residual);
    let everywhere = Raster::from_fn(SIZE, |_| 1.0);
    let evidence = evidence(&region, &pictures, &everywhere, &solution);
    separate(&evidence, (texel, 0))
}

/// Positions in the light, in shadow, and in shadow at the border, all clear of the toy.
const PLACES: [UVec2; 3] = [UVec2::new(8, 18), UVec2::new(50, 18), UVec2::new(60, 0)];

#[test]
fn a_constant_residual_is_no_noise_and_the_texture_divides_out() {
    let residual = DVec3::new(0.05, -0.02, 0.01);
    for texel in PLACES {
        let found = separated(|_| residual, texel);
        assert!((found - residual).abs().max_element() < 1e-12, "{texel}: {found}");
    }
    assert_eq!(
        separated(|_| residual, UVec2::new(30, 18)),
        DVec3::ZERO,
        "under the toy"
    );
}

#[test]
fn in_shadow_noise_goes_and_detail_stays() {
    // A single pixel differs from its surroundings: smoothing leaves less than this share of it.
    let direct_fraction = 0.2;
    for (height, is_noise) in [(0.5 * NOISE, true), (2.0 * DETAIL, false)] {
        for texel in PLACES {
            let alone = |at: UVec2| {
                if at == texel {
                    DVec3::splat(height)
                } else {
                    DVec3::ZERO
                }
            };
            let found = separated(alone, texel).x / height;
            let is_gone = is_noise && texel.x > 30;
            let expected = if is_gone { 0.0 } else { 1.0 };
            let allowed = if is_gone { direct_fraction } else { 1e-9 };
            assert!(
                (found - expected).abs() < allowed,
                "{texel}: {found} of {height} is left"
            );
        }
    }
}
