//! Pixels at the rims of things, on scrambled inputs.

use glam::{DVec3, DVec4, UVec2};
use reference::raster::Raster;
use reference::thing_rim::Rims;
use reference::things::rim_steps;

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::number;
use crate::scrambled::{Scrambled, views};

/// Every code of a rim, on both kinds of marks, with what is beyond changed little or much.
const PROBE: &str = "
@fragment fn fs_probe(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let texel = vec2u(position.xy);
  let code = f32(1u + (texel.x / 5u + texel.y / 7u) % 16u);
  let steps = rim_steps(vec4f(0.0, 0.0, 0.0, select(THING, BEFORE_TOY, texel.y % 2u == 1u) + code / 255.0));
  if any(texel < vec2u(2u)) || any(texel + 2u >= vec2u(globals.region_size_px)) { return vec4f(0.0); }
  let beyond = frame_at(vec2i(texel) + steps.zw);
  let change = 0.004 * (f32(texel.x) - 60.0);
  return vec4f(rim_mixed(vec2i(texel), steps, beyond * (1.0 + change)), 1.0);
}";

/// The plate as photographed, estimated, or with what is shown of a thing.
fn plate(size: UVec2) -> Raster<DVec4> {
    Raster::from_fn(size, |at| {
        let alpha = [1.0, 1.0, 0.25, 0.5625, 0.75][(at.x / 11 + at.y / 6) as usize % 5];
        color(at, 11).extend(alpha)
    })
}

/// Colours with little and with much contrast, exact in 32 bits.
fn color(at: UVec2, seed: u32) -> DVec3 {
    let contrast = [0.03, 0.2, 0.9][(at.x / 13 + at.y / 17) as usize % 3];
    let light = |channel: u32| 0.05 + contrast * number(at, seed + channel);
    DVec3::from([0, 1, 2].map(light)).as_vec3().as_dvec3()
}

/// Errors of the mixed pixels that `source` makes.
fn errors(source: &str) -> Errors {
    let (device, mut scene) = (Device::shared(), Scrambled::new());
    let size = scene.rect.size_px;
    scene.image = Raster::from_fn(size, |at| color(at, 5).extend(1.0));
    let plate = plate(size);
    let maps = [device.map(&plate)];
    let own = views(20, &maps);
    // Only two groups are bound here.
    let source = source.replace("@group(2) @binding(0)", "@group(1) @binding(20)");
    let source = format!("{source}{PROBE}");
    let seen = scene.seen(device);
    let actual = device.draw(Draw::of(&source, "fs_probe", size), [&seen.bindings(), &own]);
    let rims = Rims {
        frame: &scene.image.map(DVec4::truncate),
        plate: &plate,
        gain: scene.solution.gain,
    };
    let expected = Raster::from_fn(size, |at| {
        let is_within = at.cmpge(UVec2::splat(2)).all() && (at + 2).cmplt(size).all();
        if !is_within {
            return DVec4::ZERO;
        }
        let steps = rim_steps(1 + (at.x / 5 + at.y / 7) as usize % 16);
        let beyond = rims.frame.at((at.as_ivec2() + steps[1]).as_uvec2());
        let change = 0.004 * (f64::from(at.x) - 60.0);
        rims.mixed(at, steps, beyond * (1.0 + change)).extend(1.0)
    });
    Errors::between(pairs_of(&actual, &expected))
}

/// Limit for rounding.
const ALLOWED: f64 = 1e-5;

#[test]
fn the_rim_of_a_thing() {
    errors(&source("composite")).check_all("thing_rim", ALLOWED);
}

#[test]
fn a_fault_at_the_rim_of_a_thing_is_found() {
    let faults = [
        ("RIM_CONTRAST: f32 = 0.003", "RIM_CONTRAST: f32 = 0.004"),
        ("PART_INSIDE: f32 = 0.75", "PART_INSIDE: f32 = 0.5"),
        ("beyond.a) < 1.0 {", "beyond.a) < 0.0 {"),
        (" + dot(in_plate[0], in_plate[1])", ""),
        ("select(0u, 1u, number > 3u)", "0u"),
        ("code > N_DIRECTIONS", "code < N_DIRECTIONS"),
        ("-select(2, 1, is_inside) * outward", "-outward"),
        ("largest(max(shown, beyond))", "1.0"),
        ("mix(shown, within, part) + remainder", "mix(shown, within, part)"),
        ("if !is_relit(relit_within) { return kept; }", ""),
        (
            "fit.gain.rgb * relit_within.rgb",
            "fit.gain.rrr * relit_within.rgb",
        ),
        ("kept_part(relit_within)", "0.0"),
    ];
    check_faults("composite", &faults, ALLOWED, errors);
}
