//! Classification of residuals.

use app_core::frame::Outlier;
use app_pipeline::model::diagnostics::outliers::{ReceiverCells, outliers};

/// Number of cells in a row.
const WIDTH: usize = 4;

/// Outliers among cells of the first receiver, which are a centimetre wide.
fn of_first(accumulated: &[[f32; 4]]) -> Vec<Outlier> {
    of_cells((accumulated, WIDTH), 0.01)
}

fn of_cells((accumulated, width): (&[[f32; 4]], usize), cell_m: f32) -> Vec<Outlier> {
    outliers(&ReceiverCells {
        accumulated,
        width,
        cell_m,
    })
}

/// Some cells with the same residual from a few frames, among many without any.
fn cells(residual: [f32; 3], n_cells: usize) -> Vec<[f32; 4]> {
    let [r, g, b] = residual.map(|value| 3.0 * value);
    let told = std::iter::repeat_n([r, g, b, 3.0], n_cells);
    told.chain(std::iter::repeat_n([0.01, 0.02, 0.0, 2.0], 200))
        .chain(std::iter::repeat_n([0.0; 4], 200))
        .collect()
}

#[test]
fn a_shadow_is_darker_in_all_channels_alike() {
    for (residual, expected) in [
        ([-0.4, -0.35, -0.25], vec![Outlier::Shadow]),
        ([0.5, 0.2, 0.1], vec![Outlier::Object]),
        ([-0.5, -0.4, 0.05], vec![Outlier::Object]),
        ([-0.6, -0.5, -0.05], vec![Outlier::Object]),
        ([-0.2, -0.2, -0.2], vec![Outlier::Shadow]),
        ([-0.1, -0.1, -0.1], vec![]),
        ([0.2, 0.2, 0.2], vec![]),
    ] {
        assert_eq!(of_first(&cells(residual, 12)), expected, "{residual:?}");
    }
}

#[test]
fn a_cell_or_two_are_no_thing() {
    assert_eq!(of_first(&cells([0.6, 0.6, 0.6], 2)), []);
    assert_eq!(of_first(&[]), []);
    let uncertain = vec![[0.1, 0.1, 0.1, 0.2]; 50];
    assert_eq!(of_first(&uncertain), []);
}

/// On the side of a book the toy's shadow ends some millimetres beside its place: a band of two or
/// three cells, however wide the table's are.
#[test]
fn a_narrow_band_is_a_misplaced_edge() {
    let dark = [-0.9, -0.9, -0.8, 2.0];
    let band = |width: usize| {
        let row = |y: usize| (0..20).map(move |x| (y / 3..y / 3 + width).contains(&x));
        let cells: Vec<_> = (0..20)
            .flat_map(row)
            .map(|is_dark| if is_dark { dark } else { [0.0, 0.0, 0.0, 2.0] })
            .collect();
        cells
    };
    assert_eq!(of_cells((&band(3), 20), 0.0025), []);
    assert_eq!(of_cells((&band(7), 20), 0.0025), [Outlier::Shadow]);
    assert_eq!(of_cells((&band(1), 20), 0.01), []);
    assert_eq!(of_cells((&band(3), 20), 0.01), [Outlier::Shadow]);
}
