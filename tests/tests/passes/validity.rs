//! `validity` on slopes, steps and specks of depth.

use app_core::wgpu;
use glam::UVec2;
use reference::raster::Raster;
use reference::validity::mark;

use crate::alone::{Bindings, Draw, check_faults, source};
use crate::device::Device;
use crate::errors::Errors;
use crate::numbers::number;

/// Mark of a surface into which another one is mixed.
const MIXED: f64 = 16.0 / 255.0;

const SIZE: UVec2 = UVec2::new(147, 93);

/// Patches of a toy with different slopes and roughness, and holes; between them nothing, or a speck.
fn depth(at: UVec2) -> f64 {
    let patch = at / 24;
    let is_speck = at.x % 41 == 20 && at.y % 37 == 18;
    if (number(patch, 140) < 0.55) != is_speck {
        return 0.0;
    }
    // In steps of 2^-12, which 32 bits add up exactly; two of them are the limit for the bend of a
    // surface.
    let slope = |seed: u32, x: u32| (8.0 * number(patch, seed)).floor() * f64::from(x % 24);
    let rough = (6.0 * number(patch, 143) * number(at, 144)).floor();
    (1024.0 + slope(141, at.x) + slope(142, at.y) + rough) / 4096.0
}

/// Actual and expected marks.
fn errors(source: &str) -> Errors {
    let device = Device::shared();
    let depth = Raster::from_fn(SIZE, depth);
    let map = device.depth(&depth);
    // For a sharp picture, and for a soft one.
    let pairs = [0, 5].map(|soft_px: i32| {
        let uniform = device.uniform(&soft_px);
        let own: Bindings<'_> = vec![
            (0, wgpu::BindingResource::TextureView(&map)),
            (1, uniform.as_entire_binding()),
        ];
        let draw = Draw::of(source, "fs_mark", SIZE);
        let actual = device.draw(draw, [&[], &own]);
        let expected = Raster::from_fn(SIZE, |texel| mark(&depth, soft_px, texel));
        let both = actual.texels().iter().zip(expected.texels());
        let pairs = both.flat_map(|(actual, marks)| {
            let of_surface = match (marks.is_one_surface, marks.is_mixed) {
                (false, _) => 0.0,
                (true, false) => 1.0,
                (true, true) => MIXED,
            };
            let [clear, well_clear] = [marks.is_clear, marks.is_well_clear].map(|is| f64::from(u8::from(is)));
            let marks = [clear, of_surface, well_clear];
            (0..3).map(move |k| (actual[k], marks[k]))
        });
        pairs.collect::<Vec<_>>()
    });
    Errors::between(pairs.concat())
}

#[test]
fn what_pixels_show() {
    errors(&source("validity")).check_all("validity", 1e-7);
}

#[test]
fn a_fault_in_the_marks_is_found() {
    let faults = [
        ("EDGE_PX: i32 = 2", "EDGE_PX: i32 = 1"),
        ("EDGE_PX + soft_px", "EDGE_PX - soft_px"),
        ("BLEED_PX: i32 = 8", "BLEED_PX: i32 = 6"),
        ("BLEED_STEP_PX: i32 = 2", "BLEED_STEP_PX: i32 = 1"),
        ("% (2 * BLEED_STEP_PX)", "% BLEED_STEP_PX"),
        ("DEPTH_BEND: f32 = 0.002", "DEPTH_BEND: f32 = 0.003"),
        ("vec2i(far_px, far_px)", "vec2i(far_px, 0)"),
        ("vec2i(far_px, -far_px)", "vec2i(far_px, 0)"),
        ("goes_on(texel, soft_px, here) &&", ""),
        ("&& goes_on(texel, max(soft_px / 2, 1), here)", ""),
        (
            "is_clear && is_well_clear_of_toy(texel)",
            "is_well_clear_of_toy(texel)",
        ),
    ];
    check_faults("validity", &faults, 0.5, errors);
}
