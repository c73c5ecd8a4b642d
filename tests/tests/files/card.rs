//! The printed card: its lengths, its pattern, its file.

#![expect(clippy::cast_possible_truncation, reason = "dots of a page")]

use app_core::card::{Gray, PATTERN_M, REFERENCE_PX, reference};
use app_session::tags::png_chunks;
use desk::card::{CROSSES_M, DOTS_PER_M, Paper, page, png};
use glam::DVec2;

/// The position to which a position of a square picture is turned or mirrored, in dots; the second
/// argument is the last index of a side.
type Turn = fn([usize; 2], usize) -> [usize; 2];

fn code(gray: &Gray, [x, y]: [usize; 2]) -> f64 {
    f64::from(gray.codes[y * gray.size_px[0] as usize + x])
}

/// Correlation of two pictures' codes.
fn correlation(gray: &Gray, other: impl Fn([usize; 2]) -> [usize; 2]) -> f64 {
    let side = gray.size_px[0] as usize;
    let n = gray.codes.len() as f64;
    let mean = gray.codes.iter().map(|code| f64::from(*code)).sum::<f64>() / n;
    let (mut product, mut square) = (0.0, 0.0);
    for y in 0..side {
        for x in 0..side {
            let a = code(gray, [x, y]) - mean;
            product += a * (code(gray, other([x, y])) - mean);
            square += a * a;
        }
    }
    product / square
}

#[test]
fn a_page_states_its_size_and_the_crosses_are_where_a_ruler_finds_them() {
    for paper in Paper::ALL {
        let page = page(paper);
        let png = png(&page).unwrap();
        let (_, density) = png_chunks(&png).find(|(name, _)| name == b"pHYs").unwrap();
        let dots = u32::from_be_bytes(density[..4].try_into().unwrap());
        assert_eq!((dots, density[8]), (DOTS_PER_M, 1));
        let read = image::load_from_memory(&png).unwrap().to_luma8();
        assert_eq!([read.width(), read.height()], page.size_px);
        assert_eq!(read.as_raw(), &page.codes);
        let size_m = DVec2::from(page.size_px.map(f64::from)) / f64::from(dots);
        assert!(
            (size_m - paper.size_m()).abs().max_element() < 1e-4,
            "{paper:?}: {size_m}"
        );
        // Centres of the black columns and rows through each cross.
        let found = paper.crosses_m().map(|cross| {
            let dot = |at: f64| (at * f64::from(dots)).floor() as usize;
            // A row beside the centre, with only one of the two lines.
            let middle = |is_across: bool| {
                let black = (0..80).map(|i| i + dot(if is_across { cross.x } else { cross.y }) - 40);
                let off = dot(if is_across { cross.y } else { cross.x } + 0.003);
                let black = black.filter(|at| {
                    let at = if is_across { [*at, off] } else { [off, *at] };
                    code(&page, at) == 0.0
                });
                let black: Vec<usize> = black.collect();
                assert!(!black.is_empty() && black.len() < 8, "{paper:?}: {black:?}");
                black.iter().map(|at| *at as f64 + 0.5).sum::<f64>() / black.len() as f64
            };
            DVec2::new(middle(true), middle(false)) / f64::from(dots)
        });
        let apart = found[3] - found[0];
        assert!(
            (apart - CROSSES_M).abs().max_element() < 1e-4,
            "{paper:?}: {apart}"
        );
        // Printers leave a margin of some 6 mm.
        for cross in found {
            let margin = cross.min(size_m - cross).min_element() - 0.005;
            assert!(margin > 0.008, "{paper:?}: {margin}");
        }
    }
}

#[test]
fn the_pattern_looks_like_none_of_its_turns_and_has_edges_everywhere() {
    let pattern = reference();
    assert_eq!(pattern.size_px, [REFERENCE_PX; 2]);
    let last = REFERENCE_PX as usize - 1;
    let turns: [Turn; 7] = [
        |[x, y], last| [last - y, x],
        |[x, y], last| [last - x, last - y],
        |[x, y], last| [y, last - x],
        |[x, y], last| [last - x, y],
        |[x, y], last| [x, last - y],
        |[x, y], _| [y, x],
        |[x, y], last| [last - y, last - x],
    ];
    for (n, turn) in turns.into_iter().enumerate() {
        let alike = correlation(&pattern, |at| turn(at, last));
        assert!(alike.abs() < 0.2, "turn {n}: {alike}");
    }
    // A pattern that is the same when turned would be found.
    assert!(correlation(&pattern, |at| at) > 0.999);
    // In each centimetre there is dark and bright.
    let n_cells = (PATTERN_M / 0.01).round() as usize;
    let cell = REFERENCE_PX as usize / n_cells;
    for i in 0..n_cells * n_cells {
        let codes = (0..cell * cell).map(|at| {
            let [x, y] = [i % n_cells * cell + at % cell, i / n_cells * cell + at / cell];
            code(&pattern, [x, y])
        });
        let [darkest, brightest] = codes.fold([255.0_f64, 0.0_f64], |[low, high], code| {
            [low.min(code), high.max(code)]
        });
        assert!(brightest - darkest >= 90.0, "cell {i}: {darkest} to {brightest}");
    }
}

#[test]
fn it_is_the_same_each_time_and_the_reference_shows_what_is_printed() {
    assert_eq!(reference(), reference());
    let (page, pattern) = (page(Paper::A4), reference());
    let at = Paper::A4.crosses_m()[0] + DVec2::new(0.0, 0.008);
    let n_alike = (0..REFERENCE_PX * REFERENCE_PX).filter(|i| {
        let [x, y] = [i % REFERENCE_PX, i / REFERENCE_PX];
        let within = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) * PATTERN_M / f64::from(REFERENCE_PX);
        let dot = ((at + within) * f64::from(DOTS_PER_M)).floor();
        code(&page, [dot.x as usize, dot.y as usize]) == code(&pattern, [x as usize, y as usize])
    });
    let share = n_alike.count() as f64 / f64::from(REFERENCE_PX * REFERENCE_PX);
    assert!(share > 0.95, "{share}");
}
