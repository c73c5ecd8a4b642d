//! Classification of residuals.

use app_core::frame::Outlier;
use app_pipeline::model::diagnostics::outliers::outliers;

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
        assert_eq!(outliers(&cells(residual, 12)), expected, "{residual:?}");
    }
}

#[test]
fn a_cell_or_two_are_no_thing() {
    assert_eq!(outliers(&cells([0.6, 0.6, 0.6], 2)), []);
    assert_eq!(outliers(&[]), []);
    let uncertain = vec![[0.1, 0.1, 0.1, 0.2]; 50];
    assert_eq!(outliers(&uncertain), []);
}
