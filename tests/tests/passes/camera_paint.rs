//! `common/camera_paint`: colours of the toy's paint, relit, and the model's brightness beside them.

use app_core::sharpness::Spread;
use app_core::wgpu;
use app_pipeline::geometry::rect::PixelRect;
use glam::{DVec3, DVec4, UVec2};
use reference::camera_paint::{SeenToy, relit};
use reference::raster::{Raster, texels_of};

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, channels};
use crate::numbers::{number, numbers};
use crate::scrambled::Scrambled;

/// The pass of the registry that contains it; it has no vertices for a whole target.
const PASS: &str = "toy";
const RELIT: &str = "fs_relit";
const PROBES: &str = "
@vertex fn vs_fullscreen(@builtin(vertex_index) k: u32) -> @builtin(position) vec4f {
  return vec4f(vec2f(vec2u(k & 1u, k >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}
// Base colours are the pixels' here, and the maps the light after and before, and the model's colour.
@fragment fn fs_relit(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2i(position.xy);
  let lit = textureLoad(appearance_received, texel, 0).rgb;
  let was_lit = textureLoad(rim, texel, 0).rgb;
  return vec4f(relit(textureLoad(appearance_base, texel, 0).rgb, lit, was_lit, textureLoad(reflected, texel, 0).rgb), 1.0);
}
@fragment fn fs_beside(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2i(position.xy);
  let tint = 4.0 * textureLoad(appearance_received, texel, 0).rgb;
  let factor = brightness_beside(texel, textureLoad(appearance_base, texel, 0).a, tint);
  return vec4f(factor, paint_color(texel).rgb);
}";
const BOX: PixelRect = PixelRect {
    origin_px: UVec2::new(14, 9),
    size_px: UVec2::new(83, 71),
};
/// Code of a pixel that is its own source: rows of eight, from three above and to the left.
const OWN_SOURCE: f64 = 27.0 / 255.0;
/// Relative to colours up to 10.
const ALLOWED: f64 = 1e-3;

/// A picture that is as sharp as its pixels and shows a matt toy, a blurred one, and that of a glossy toy.
const KINDS: [(bool, bool); 3] = [(false, false), (true, false), (false, true)];

fn single(map: Raster<DVec4>) -> Raster<DVec4> {
    map.map(|texel| texel.as_vec4().as_dvec4())
}

/// Patches that face up by different parts, each pixel in another light.
fn seen_toy(scene: &Scrambled, (is_soft, is_glossy): (bool, bool)) -> SeenToy {
    let size = BOX.size_px;
    SeenToy {
        frame: Raster::from_fn(size, |at| scene.image.at(BOX.origin_px + at).truncate()),
        is_one: Raster::from_fn(size, |at| number(at, 60) < 0.5),
        base: single(Raster::from_fn(size, |at| {
            let up = (5.0 * number(at / 3, 61)).floor() / 5.0 + 0.15 * number(at, 62);
            numbers(size, 16).at(at).truncate().extend(up)
        })),
        received: numbers(size, 17),
        mixed: is_soft.then(|| single(numbers(size, 18))),
        reflected: is_glossy.then(|| single(numbers(size, 19).map(|n| n * DVec4::new(0.3, 0.3, 0.3, 1.0)))),
    }
}

/// The output of a probe, for such a toy.
fn drawn(source: &str, scene: &Scrambled, toy: &SeenToy, probe: &str) -> Raster<DVec4> {
    let device = Device::shared();
    let mut globals = scene.stand.globals(&scene.rect).with_boxes(&BOX, &BOX);
    if toy.mixed.is_some() {
        globals = globals.with_spread(Spread::round(1.5));
    }
    let seen = scene.seen(device);
    let boxed = device.uniform(&globals);
    let mut shared = seen.bindings();
    shared[0].1 = boxed.as_entire_binding();
    let sources = toy
        .is_one
        .map(|is_one| DVec4::splat(if is_one { OWN_SOURCE } else { 1.0 }));
    let [mixed, reflected] = [(&toy.mixed, 18), (&toy.reflected, 19)]
        .map(|(map, seed)| map.clone().unwrap_or_else(|| numbers(BOX.size_px, seed)));
    let maps = [&toy.base, &toy.received, &sources, &mixed, &reflected].map(|map| device.map(map));
    let slots = [2, 3, 6, 7, 8].into_iter().zip(&maps);
    // A probe binds what it reads.
    let own = slots.filter(|(slot, _)| *slot != 6 || probe != RELIT);
    let own: Vec<_> = own
        .map(|(slot, map)| (slot, wgpu::BindingResource::TextureView(map)))
        .collect();
    let source = format!("{source}{PROBES}");
    let is_glossy = f64::from(u8::from(toy.reflected.is_some()));
    let draw = Draw {
        constants: &[("IS_GLOSSY", is_glossy)],
        ..Draw::of(&source, probe, BOX.size_px)
    };
    device.draw(draw, [if probe == RELIT { &[] } else { &shared }, &own])
}

/// Errors of relit colours.
fn relit_errors(source: &str) -> Errors {
    let scene = Scrambled::new();
    let toy = SeenToy {
        mixed: Some(numbers(BOX.size_px, 18).map(|n| if n.w < 0.1 { DVec4::ZERO } else { n * n })),
        reflected: Some(numbers(BOX.size_px, 19)),
        ..seen_toy(&scene, KINDS[0])
    };
    let actual = drawn(source, &scene, &toy, RELIT);
    let of = |map: &Option<Raster<DVec4>>, at| map.as_ref().map_or(DVec3::ZERO, |map| map.at(at).truncate());
    let pairs = texels_of(BOX.size_px).flat_map(|at| {
        let light = [toy.received.at(at).truncate(), of(&toy.mixed, at)];
        let expected = relit(toy.base.at(at).truncate(), light, of(&toy.reflected, at));
        channels(actual.at(at).truncate(), expected)
    });
    Errors::between(pairs.collect::<Vec<_>>())
}

/// Errors of the brightness beside each pixel, and of its paint.
fn beside_errors(source: &str) -> Errors {
    let scene = Scrambled::new();
    let pairs = KINDS.map(|kind| {
        let toy = seen_toy(&scene, kind);
        let actual = drawn(source, &scene, &toy, "fs_beside");
        let (mut pairs, mut n_between) = (Vec::new(), 0);
        for at in texels_of(BOX.size_px) {
            let own = (toy.base.at(at).w, 4.0 * toy.received.at(at).truncate());
            let factor = toy.brightness_beside(&scene.solution, at, own);
            n_between += u32::from(factor > 0.55 && factor < 0.98);
            let expected = toy.paint(&scene.solution, at).truncate();
            let [found, paint @ ..] = actual.at(at).to_array();
            pairs.push((found, factor));
            pairs.extend(channels(DVec3::from(paint), expected));
        }
        assert!(n_between > 100, "{n_between} factors are neither 1 nor the least");
        pairs
    });
    Errors::between(pairs.concat())
}

#[test]
fn a_pixel_is_relit_to_about_the_models_colour() {
    relit_errors(&source(PASS)).check_all("relit colours", ALLOWED);
}

#[test]
fn a_fault_in_the_relit_colours_is_found() {
    let faults = [
        ("MAX_TURN: f32 = 4.0", "MAX_TURN: f32 = 5.0"),
        ("OTHER_PAINT: f32 = 1.1", "OTHER_PAINT: f32 = 1.0"),
        ("min(color, expected / OTHER_PAINT)", "expected / OTHER_PAINT"),
        ("max(color, expected * OTHER_PAINT)", "expected * OTHER_PAINT"),
        (
            "lit / was_lit, was_lit > vec3f(0.0)",
            "lit / was_lit, was_lit >= vec3f(0.0)",
        ),
        ("vec3f(1.0 / MAX_TURN)", "vec3f(1.0)"),
    ];
    check_faults(PASS, &faults, ALLOWED, relit_errors);
}

#[test]
fn the_models_brightness_is_that_of_the_camera_beside_it() {
    beside_errors(&source(PASS)).check_all("brightness beside", ALLOWED);
}

#[test]
fn a_fault_in_the_brightness_beside_is_found() {
    let faults = [
        ("COMPARED_PX: i32 = 2", "COMPARED_PX: i32 = 1"),
        ("SAME_UP: f32 = 0.1", "SAME_UP: f32 = 0.2"),
        ("SAME_BRIGHTNESS: f32 = 1.2", "SAME_BRIGHTNESS: f32 = 1.1"),
        ("OTHER_BRIGHTNESS: f32 = 1.6", "OTHER_BRIGHTNESS: f32 = 1.8"),
        ("MOST_BRIGHTNESS: f32 = 2.0", "MOST_BRIGHTNESS: f32 = 3.0"),
        ("LEAST_PART: f32 = 0.35", "LEAST_PART: f32 = 0.3"),
        ("PART_ERROR: f32 = 0.2", "PART_ERROR: f32 = 0.25"),
        (
            "dot(mixed.rgb, LUMINANCE) - expected",
            "dot(mixed.rgb, LUMINANCE)",
        ),
        ("LEAST_PAINT: f32 = 0.1", "LEAST_PAINT: f32 = 0.0"),
        ("vec3f(0.2126, 0.7152, 0.0722)", "vec3f(0.3333)"),
        (
            "fit.gain.rgb * tint * base.rgb * seen_under(other)",
            "tint * base.rgb * seen_under(other)",
        ),
        ("sum += shown.a * vec2f", "sum += vec2f"),
        (
            "(1.0 - part) * fit.gain.rgb * mixed.rgb",
            "(1.0 - part) * mixed.rgb",
        ),
        ("vec2f(up, 1.0 - up)", "vec2f(1.0 - up, up)"),
        (
            "if sum.x == 0.0 || sum.y == 0.0 { return 1.0; }",
            "if sum.x == 0.0 { return 0.5; }",
        ),
    ];
    check_faults(PASS, &faults, ALLOWED, beside_errors);
}
