//! `soften` on pictures full of detail, with taps along axes of any direction.

use app_core::wgpu;
use bytemuck::{Pod, Zeroable};
use glam::{DVec4, UVec2};
use reference::raster::Raster;
use reference::soften::{Taps, soften};

use crate::alone::{Bindings, Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::number;

const SIZE: UVec2 = UVec2::new(67, 41);
/// Colours are up to 2; between texels, drivers interpolate in steps of 1/256.
const ALLOWED: f64 = 4e-3;

/// The taps in the shader's form.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct OnDevice {
    first_px: [f32; 2],
    second_px: [f32; 2],
    spacing: [f32; 2],
    pad: [f32; 2],
}

/// A round blur, an oblique one, motions, and none.
fn grids() -> [Taps; 4] {
    let taps = |first: [f64; 2], second: [f64; 2], spacing: [f64; 2], n_beside: u32| Taps {
        steps_px: [first.into(), second.into()],
        spacing: spacing.into(),
        n_beside,
    };
    [
        taps([1.5, 0.0], [0.0, 1.5], [0.75, 0.75], 3),
        taps([0.9, -1.2], [0.4, 0.3], [0.4, 0.4], 6),
        taps([0.3, 1.1], [0.5, -0.1], [0.0, 0.75], 3),
        taps([0.0, 0.0], [0.0, 0.0], [0.75, 0.75], 3),
    ]
}

/// Colours in steps of 1/256, times an alpha of a half or zero: patches were not photographed.
#[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
fn plate() -> Raster<[u8; 4]> {
    Raster::from_fn(SIZE, |at| {
        if number(at / 9, 160) < 0.2 {
            return [0; 4];
        }
        let color = [161, 162, 163].map(|seed| (255.0 * number(at, seed)) as u8);
        [color[0], color[1], color[2], 128]
    })
}

#[allow(clippy::cast_possible_truncation, reason = "a handful of digits")]
fn errors(source: &str) -> Errors {
    let (device, plate) = (Device::shared(), plate());
    let map = device.filterable_colors(&plate);
    let linear = device.linear_sampler();
    let colors = plate.map(|texel| DVec4::from(texel.map(f64::from)) / 256.0);
    let pairs = grids().map(|taps| {
        let on_device = device.uniform(&OnDevice {
            first_px: taps.steps_px[0].as_vec2().to_array(),
            second_px: taps.steps_px[1].as_vec2().to_array(),
            spacing: taps.spacing.as_vec2().to_array(),
            pad: [0.0; 2],
        });
        let own: Bindings<'_> = vec![
            (0, on_device.as_entire_binding()),
            (1, wgpu::BindingResource::TextureView(&map)),
            (2, wgpu::BindingResource::Sampler(&linear)),
        ];
        let constants = [("N_BESIDE", f64::from(taps.n_beside))];
        let draw = Draw {
            constants: &constants,
            ..Draw::of(source, "fs_soften", SIZE)
        };
        let actual = device.draw(draw, [&[], &own]);
        let expected = Raster::from_fn(SIZE, |texel| soften(&colors, &taps, texel));
        pairs_of(&actual, &expected)
    });
    Errors::between(pairs.concat())
}

#[test]
fn plates_are_spread_as_light_is() {
    errors(&source("soften")).check_all("softened plates", ALLOWED);
}

#[test]
fn a_fault_in_the_spread_is_found() {
    let faults = [
        ("exp(-0.5 *", "exp(-0.6 *"),
        ("own.a == 0.0", "own.a < 0.0"),
        ("taps.spacing * vec2f", "taps.spacing.y * vec2f"),
        ("i <= N_BESIDE", "i < N_BESIDE"),
        ("f32(j) * taps.second_px", "f32(i) * taps.second_px"),
        ("/ sum.a", "/ own.a"),
    ];
    check_faults("soften", &faults, ALLOWED, errors);
}
