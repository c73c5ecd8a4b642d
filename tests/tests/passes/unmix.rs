//! `unmix` on scrambled inputs, for a toy of specks and patches.

use app_core::wgpu;
use app_pipeline::geometry::rect::PixelRect;
use glam::{DVec3, DVec4, UVec2};
use reference::fit::toy_radiance;
use reference::raster::{Raster, texels_of};
use reference::unmix::{coded_factor, factor_of_code, unmixed_factor};

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, channels};
use crate::numbers::{number, numbers};
use crate::rim::{of_point, spread};
use crate::scrambled::{Scrambled, buffers};

const PASS: &str = "unmix";
const PROBE: &str = "
@fragment fn fs_unmixed(@builtin(position) position: vec4f) -> @location(0) vec4f {
  return vec4f(unmixed_factor(vec2i(position.xy)), 1.0);
}
";
/// Factors of 0 to 9 as codes, and codes of 0 to 984 as factors.
const CODES: &str = "
@fragment fn fs_codes(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let at = position.xxx - 0.5;
  return vec4f(coded_factor(at * (9.0 / 82.0)).x, factor_of_code(at * (12.0 / 1023.0)).x, 0.0, 1.0);
}";
const BOX: PixelRect = PixelRect {
    origin_px: UVec2::new(14, 9),
    size_px: UVec2::new(83, 71),
};
/// One of 64 positions may lie in another texel by rounding: up to a tenth of a factor, in few texels.
const ALLOWED: (f64, f64) = (1e-3, 0.03);
const ALLOWED_ANYWHERE: f64 = 0.3;
/// A hundredth of a code.
const CODE_ALLOWED: f64 = 1e-5;

/// Factors of a picture of a blur, or of one that is as sharp as its pixels.
fn errors(source: &str) -> Errors {
    let (device, scene) = (Device::shared(), Scrambled::new());
    let depth = Raster::from_fn(BOX.size_px, |at| {
        let is_toy = number(at / 7, 170) < 0.7 || number(at, 171) < 0.03;
        if is_toy { 0.25 } else { 0.0 }
    });
    let base = Raster::from_fn(BOX.size_px, |at| {
        let color = numbers(BOX.size_px, 16).at(at / 5).truncate();
        (color * color).extend(number(at / 5, 62)).as_vec4().as_dvec4()
    });
    let received = numbers(BOX.size_px, 17).map(|light: DVec4| light.as_vec4().as_dvec4());
    let model = Raster::from_fn(BOX.size_px, |at| {
        let base = base.at(at);
        let normal = DVec3::Y * (2.0 * base.w - 1.0);
        let light = toy_radiance(&scene.solution, normal, received.at(at));
        (depth.at(at) > 0.0).then(|| base.truncate() * light)
    });
    let sharp = scene.stand.globals(&scene.rect).with_boxes(&BOX, &BOX);
    let (toy, maps) = (
        device.depth(&depth),
        [&received, &base].map(|map| device.map(map)),
    );
    let own: Vec<_> = [(0, &toy), (1, &maps[0]), (2, &maps[1])]
        .map(|(slot, map)| (slot, wgpu::BindingResource::TextureView(map)))
        .into();
    let source = format!("{source}{PROBE}");
    let [_, fit] = scene.shared(device);
    let drawn = [false, true].map(|is_soft| {
        let globals = if is_soft {
            sharp.with_spread(spread())
        } else {
            sharp
        };
        let shared = [device.uniform(&globals), fit.clone()];
        let draw = Draw::of(&source, "fs_unmixed", BOX.size_px);
        device.draw(draw, [&buffers(0, &shared), &own])
    });
    let pairs = texels_of(BOX.size_px).flat_map(|at| {
        let [sharp, soft] = [0, 1].map(|k: usize| drawn[k].at(at).truncate());
        let expected = unmixed_factor(&model, of_point(spread()), at);
        channels(sharp, DVec3::ONE).chain(channels(soft, expected))
    });
    Errors::between(pairs.collect::<Vec<_>>())
}

#[test]
fn one_surface_of_a_mixture() {
    errors(&source(PASS)).check("factors", ALLOWED, ALLOWED_ANYWHERE);
}

fn errors_of_codes(source: &str) -> Errors {
    let source = format!("{source}{CODES}");
    let size = UVec2::new(83, 1);
    let drawn = Device::shared().draw(Draw::of(&source, "fs_codes", size), [&[], &[]]);
    let pairs = texels_of(size).flat_map(|at| {
        let place = DVec3::splat(f64::from(at.x));
        let codes = coded_factor(place * (9.0 / 82.0));
        let factors = factor_of_code(place * (12.0 / 1023.0));
        let actual = drawn.at(at);
        [(actual.x, codes.x), (actual.y, factors.x)]
    });
    Errors::between(pairs.collect::<Vec<_>>())
}

#[test]
fn factors_and_their_codes() {
    errors_of_codes(&source(PASS)).check_all("codes", CODE_ALLOWED);
    let faults = [
        ("CODE_OF_ONE: f32 = 512.0", "CODE_OF_ONE: f32 = 511.5"),
        ("return root * root;", "return root;"),
        ("GREATEST_CODE, vec3f(1.0))", "GREATEST_CODE, vec3f(2.0))"),
    ];
    check_faults(PASS, &faults, CODE_ALLOWED, errors_of_codes);
}

#[test]
fn a_fault_in_the_factor_is_found() {
    let faults = [
        ("UNMIXED_ROW_STEP: u32 = 19u", "UNMIXED_ROW_STEP: u32 = 1u"),
        ("N_UNMIXED: u32 = 64u", "N_UNMIXED: u32 = 8u"),
        (
            "textureLoad(gbuffer_depth, tap, 0) > 0.0",
            "textureLoad(gbuffer_depth, tap, 0) >= 0.0",
        ),
        ("(expected_at(texel) + DARKEST_USABLE)", "expected_at(texel)"),
        (
            "0.5 + spread_position_px(lattice) + beside_px(k)",
            "0.5 + beside_px(k)",
        ),
    ];
    check_faults(PASS, &faults, ALLOWED_ANYWHERE, errors);
}
