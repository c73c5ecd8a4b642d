//! `rim` on scrambled inputs, around a toy of specks and patches.

use app_core::sharpness::Spread;
use app_core::wgpu;
use app_pipeline::geometry::rect::PixelRect;
use glam::{DVec2, DVec3, UVec2};
use reference::occlusion::PointSpread;
use reference::raster::{Raster, texels_of};
use reference::rim::{Learned, part_of_toy, shown_receiver};

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::Errors;
use crate::numbers::number;
use crate::scrambled::{N_CELLS, Scrambled, buffers, views};

/// Relative to colours up to 10.
const ALLOWED: f64 = 1e-4;
/// One of 64 positions may lie in another texel by rounding.
const ONE_PLACE: f64 = 1.0 / 64.0 + 1e-6;

const BOX: PixelRect = PixelRect {
    origin_px: UVec2::new(14, 9),
    size_px: UVec2::new(83, 71),
};

pub(crate) fn spread() -> Spread {
    Spread {
        xx_px2: 2.5,
        xy_px2: -0.8,
        yy_px2: 1.1,
    }
}

/// A motion's, of 6 px to the right and 3 down.
pub(crate) fn line() -> Spread {
    Spread::of_motion(DVec2::new(6.0, 3.0))
}

/// The spread of a point and of its pixel, without that of means over three by three texels; and the
/// deviation of the latter. Computed by hand.
pub(crate) fn of_point(spread: Spread) -> (PointSpread, f64) {
    let middle = 0.5 * (spread.xx_px2 + spread.yy_px2);
    let apart = 0.5 * (spread.xx_px2 - spread.yy_px2);
    let from_middle = apart.hypot(spread.xy_px2);
    let narrowest = middle - from_middle;
    let of_means = 0.5 * narrowest.clamp(0.0, 1.0);
    let own = 1.0 / 12.0 - of_means;
    let along = DVec2::from_angle(0.5 * spread.xy_px2.atan2(apart));
    let axes_px = [
        (middle + from_middle + own).sqrt() * along,
        (narrowest + own).sqrt() * along.perp(),
    ];
    let is_line = middle + from_middle >= 4.0 * narrowest;
    (PointSpread { axes_px, is_line }, of_means.sqrt())
}

fn depth() -> Raster<f64> {
    Raster::from_fn(BOX.size_px, |at| {
        let is_toy = number(at / 7, 170) < 0.5 || number(at, 171) < 0.03;
        if is_toy { 0.25 } else { 0.0 }
    })
}

/// In a blurred picture and in one of a motion.
fn errors(source: &str) -> Errors {
    errors_over(&Scrambled::new(), source)
}

/// The same over a glossy table.
fn errors_of_glossy(source: &str) -> Errors {
    errors_over(&Scrambled::reflecting(), source)
}

fn errors_over(scene: &Scrambled, source: &str) -> Errors {
    let pairs = [spread(), line()].map(|spread| pairs_of_spread(scene, source, spread));
    Errors::between(pairs.concat())
}

fn pairs_of_spread(scene: &Scrambled, source: &str, spread: Spread) -> Vec<(f64, f64)> {
    let (device, depth) = (Device::shared(), depth());
    let residuals = scene.plane_grids().map(|grid| {
        let values = Raster::from_fn(grid.size, |at| {
            DVec3::from([180, 181, 182].map(|seed| number(at, seed) - 0.7))
        });
        (grid, values)
    });
    let mut cells = vec![[f32::NAN; 4]; N_CELLS];
    for ((_, values), grid) in residuals.iter().zip(scene.grids().grids) {
        let slots = cells[grid.first_cell as usize..].iter_mut().zip(values.texels());
        slots.for_each(|(slot, value)| *slot = value.extend(1.0).as_vec4().to_array());
    }
    let globals = scene.globals().with_boxes(&BOX, &BOX).with_spread(spread);
    let [_, fit] = scene.shared(device);
    let shared = [device.uniform(&globals), fit];
    let place = [
        device.uniform(&scene.grids()),
        device.storage(bytemuck::cast_slice(&cells)),
    ];
    let maps = [
        device.map(&scene.plate),
        device.map(&scene.visibility),
        device.filterable(&scene.ambient),
    ];
    let (linear, toy) = (device.linear_sampler(), device.depth(&depth));
    let mut own = buffers(0, &place);
    own.extend(views(2, &maps));
    own.push((5, wgpu::BindingResource::Sampler(&linear)));
    own.push((6, wgpu::BindingResource::TextureView(&toy)));
    let draw = Draw::of(source, "fs_mix", BOX.size_px);
    let actual = device.draw(draw, [&buffers(0, &shared), &own]);
    let pictures = scene.pictures(0);
    let learned = Learned {
        solution: &scene.solution,
        residuals: &residuals,
    };
    let (mut n_mixed, mut pairs) = (0, Vec::new());
    for texel in texels_of(BOX.size_px) {
        let actual = actual.at(texel);
        let in_region = BOX.origin_px + texel;
        let part = part_of_toy(&depth, of_point(spread), texel);
        let is_mixed = part > 0.0 && part < 1.0;
        let is_known = scene.plate.at(in_region).w > 0.0;
        let part = if is_mixed && !is_known { 1.0 } else { part };
        if (actual.w - part).abs() > ONE_PLACE {
            pairs.push((actual.w, part));
        }
        // A share next to 0 or 1 may have become that by rounding.
        if part > ONE_PLACE && part < 1.0 - ONE_PLACE {
            n_mixed += 1;
            let expected = shown_receiver(&scene.region, &pictures, &learned, in_region);
            pairs.extend((0..3).map(|channel| (actual[channel], expected[channel])));
        }
    }
    assert!(n_mixed > 1000, "{n_mixed} are mixed");
    pairs
}

#[test]
fn what_is_mixed_into_the_toys_colours() {
    errors(&source("rim")).check_all("rim", ALLOWED);
}

#[test]
fn a_fault_in_the_mixture_is_found() {
    let faults = [
        ("N_POSITIONS: u32 = 64u", "N_POSITIONS: u32 = 16u"),
        (
            "POSITION_STEPS = vec2u(47u, 53u)",
            "POSITION_STEPS = vec2u(47u, 47u)",
        ),
        ("2.0 * part - 1.0", "1.4 * part - 0.7"),
        ("globals.is_line == 1u", "globals.is_line == 2u"),
        ("2.0 * lattice.x - 1.0", "lattice.x - 0.5"),
        (
            "globals.spread.xy * deviations.x",
            "globals.spread.yx * deviations.x",
        ),
        ("depth > 0.0", "depth >= 0.0"),
        ("if b.a == 0.0 {", "if b.a < 0.0 {"),
        ("model + cell_at(point).rgb", "model - cell_at(point).rgb"),
        (
            "max(model + cell_at(point).rgb, vec3f(0.0))",
            "(model + cell_at(point).rgb)",
        ),
        ("region_texel(vec2i(position.xy))", "vec2i(position.xy)"),
    ];
    check_faults("rim", &faults, ALLOWED, errors);
}

#[test]
fn the_mixture_with_a_glossy_table() {
    errors_of_glossy(&source("rim")).check_all("rim of a glossy table", ALLOWED);
    let faults = [
        (" + reflected(point, v)", ""),
        ("+ reflected(point, v)", "- reflected(point, v)"),
        ("+ reflected(point, v)", "+ reflected(point, vec4f(1.0))"),
    ];
    check_faults("rim", &faults, ALLOWED, errors_of_glossy);
}
