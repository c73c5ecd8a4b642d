//! `soften` on pictures of nothing but detail, along axes of any direction.

use app_core::wgpu;
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec4, UVec2};
use reference::raster::Raster;
use reference::soften::{Axis, soften};

use crate::alone::{Bindings, Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::number;

const SIZE: UVec2 = UVec2::new(67, 41);
/// A colour is of up to 2; between texels it is weighed in steps of 1/256 by drivers.
const ALLOWED: f64 = 4e-3;

/// As the shader has it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct OnDevice {
    direction: [f32; 2],
    deviation_px: f32,
    pad: f32,
}

/// Across, down, and aslant; one of nothing.
fn axes() -> [Axis; 4] {
    let axis = |x: f64, y: f64, deviation_px: f64, reach_px: u32| Axis {
        direction: DVec2::new(x, y),
        deviation_px,
        reach_px,
    };
    [
        axis(1.0, 0.0, 2.0, 6),
        axis(0.0, 1.0, 0.7, 6),
        axis(0.6, -0.8, 3.1, 12),
        axis(0.0, 1.0, 0.0, 6),
    ]
}

/// In steps of 1/256, times an alpha of a half or none: patches were not photographed.
fn plate() -> Raster<[u8; 4]> {
    Raster::from_fn(SIZE, |at| {
        if number(at / 9, 160) < 0.2 {
            return [0; 4];
        }
        let color = [161, 162, 163].map(|seed| (255.0 * number(at, seed)) as u8);
        [color[0], color[1], color[2], 128]
    })
}

fn errors(source: &str) -> Errors {
    let (device, plate) = (Device::shared(), plate());
    let map = device.filterable_colors(&plate);
    let linear = device.linear_sampler();
    let colors = plate.map(|texel| DVec4::from(texel.map(f64::from)) / 256.0);
    let pairs = axes().map(|axis| {
        let on_device = device.uniform(&OnDevice {
            direction: axis.direction.as_vec2().to_array(),
            deviation_px: axis.deviation_px as f32,
            pad: 0.0,
        });
        let own: Bindings<'_> = vec![
            (0, on_device.as_entire_binding()),
            (1, wgpu::BindingResource::TextureView(&map)),
            (2, wgpu::BindingResource::Sampler(&linear)),
        ];
        let constants = [("REACH_PX", f64::from(axis.reach_px))];
        let draw = Draw {
            constants: &constants,
            ..Draw::of(source, "fs_soften", SIZE)
        };
        let actual = device.draw(draw, [&[], &own]);
        let expected = Raster::from_fn(SIZE, |texel| soften(&colors, &axis, texel));
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
        ("own.a == 0.0 ||", "own.a < 0.0 ||"),
        ("LEAST_PX: f32 = 0.01", "LEAST_PX: f32 = 1.0"),
        ("k <= REACH_PX", "k < REACH_PX"),
        ("(before + behind)", "(before + before)"),
        ("/ sum.a", "/ own.a"),
    ];
    check_faults("soften", &faults, ALLOWED, errors);
}
