//! `fill` on grids of any size and any certainty, without the passes before it.

use glam::{DVec3, DVec4, UVec2};
use reference::fill::fill;
use reference::grid::Cell;
use reference::raster::Raster;

use crate::device::Device;
use crate::errors::{Errors, channels};

/// A cell of a patchwork: known, half known, and holes of all sizes.
fn patchwork(at: UVec2) -> Cell {
    let wave = |k: u32| (0.37 * f64::from(at.x * k) + 0.61 * f64::from(at.y + k)).sin();
    let certainty = (1.5 * wave(1) * wave(2)).clamp(0.0, 1.0);
    Cell {
        value: 0.1 * DVec3::new(wave(3), wave(4), wave(5)),
        certainty,
    }
}

#[test]
fn pull_push() {
    let device = Device::shared();
    for size in [
        UVec2::new(1, 1),
        UVec2::new(1, 64),
        UVec2::new(61, 37),
        UVec2::new(64, 64),
        UVec2::new(5, 3),
    ] {
        for cell in [patchwork, |_| Cell::default()] {
            let cells = Raster::from_fn(size, cell);
            let premultiplied: Vec<[f32; 4]> = cells
                .texels()
                .iter()
                .map(|cell| {
                    (cell.value * cell.certainty)
                        .extend(cell.certainty)
                        .as_vec4()
                        .to_array()
                })
                .collect();
            let actual = device.fill(size, &premultiplied);
            let expected = fill(&cells);
            let pairs = actual
                .iter()
                .zip(expected.texels())
                .flat_map(|(actual, expected)| {
                    channels(DVec4::from(actual.map(f64::from)).truncate(), *expected)
                });
            // Some ten 32-bit roundings of values up to 0.1.
            Errors::between(pairs).check_all(&format!("fill of {size}"), 1e-7);
        }
    }
}
