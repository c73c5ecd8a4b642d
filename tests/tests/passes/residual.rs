//! `residual` with `fill`, for the light that the device fitted.

use reference::fill::fill;
use reference::model::{ReceiverPoint, centre_px};
use reference::raster::texels_of;
use reference::residual::pool;

use crate::device::Device;
use crate::errors::{Errors, channels};
use crate::photo::photograph;
use crate::run::{Run, runs};
use crate::setups::{BOOK, PILE};
use crate::stand::Stand;

#[test]
fn pooled_and_filled() {
    runs().iter().for_each(check_residuals);
}

/// A book hides light and sky from the table beside it.
#[test]
fn beside_a_book() {
    let (device, stand) = (Device::shared(), Stand::new(BOOK));
    let pictures = photograph(&stand);
    check_residuals(&Run::new(stand, pictures, &device.decoded()).unwrap());
}

/// What several books hide is not added up: some of the sky is left, and no share of no light.
#[test]
fn beside_a_pile_of_books() {
    let (device, stand) = (Device::shared(), Stand::new(PILE));
    let pictures = photograph(&stand);
    let run = Run::new(stand, pictures, &device.decoded()).unwrap();
    let points = texels_of(run.region.size_px).filter_map(|at| run.region.receiver_point(centre_px(at)));
    let sum = |point: &ReceiverPoint| {
        let tops = run.region.receivers[1..].iter();
        tops.map(|top| run.region.sky_hidden_by(top, *point)).sum::<f64>()
    };
    let n_dark = points
        .filter(|point| point.receiver == 0 && run.region.falloff(0, *point) == 0.0 && sum(point) > 1.0);
    assert!(n_dark.count() > 20, "all points see a light, or too much sky");
    // The books between are hardly seen: their fits are not compared.
    assert!(
        run.solution
            .receivers
            .iter()
            .all(|receiver| receiver.bounce.is_finite())
    );
    let mut shares = run.direct_fraction.texels().iter();
    assert!(shares.all(|share| share.is_finite()));
}

pub(crate) fn check_residuals(run: &Run) {
    for (receiver, (actual, grid)) in run.residuals.iter().zip(&run.grids).enumerate() {
        let cells = pool(&run.region, &run.pictures, &run.solution, (receiver, grid));
        assert_eq!(cells.size(), actual.size());
        let n_hidden = cells.texels().iter().filter(|cell| cell.certainty == 0.0).count();
        assert!(n_hidden > 0, "the toy hides no cell");
        let expected = fill(&cells);
        let pairs = actual
            .texels()
            .iter()
            .zip(expected.texels())
            .flat_map(|(actual, expected)| channels(actual.truncate(), *expected));
        let largest = expected
            .texels()
            .iter()
            .fold(0.0_f64, |most, value| most.max(value.abs().max_element()));
        assert!(largest > 0.005, "there is no residual: {largest}");
        // A graphics card's bilinear filter has weights of 8 bits, 1/512 of the difference of two
        // texels of the ambient map, which is 0.3 at a contact; and a cell's point within rounding
        // of two pixels may read the other one. Measured in software, which filters in 32 bits:
        // 2e-7 without such a point, 2.3e-4 with one.
        Errors::between(pairs).check_all(&format!("{}, residual on {receiver}", run.stand.setup.name), 5e-4);
    }
}
