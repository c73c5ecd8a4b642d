//! The camera's picture in the work region, from its planes.

use app_core::camera_frame::{CodeRange, LumaCoefficients, YcbcrEncoding};
use glam::{DVec4, UVec2};
use reference::camera_planes::{chroma_at, decoded};
use reference::raster::Raster;

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::numbers;
use crate::scrambled::{Scrambled, views};

const ENCODING: YcbcrEncoding = YcbcrEncoding {
    coefficients: LumaCoefficients::Bt709,
    range: CodeRange::Video,
};
/// The map from its codes, with luma, Cb and Cr as columns; then black and grey.
const MAP: [f32; 16] = [
    1.164_383_6,
    1.164_383_6,
    1.164_383_6,
    0.0,
    0.0,
    -0.213_248_6,
    2.112_401_8,
    0.0,
    1.792_741_1,
    -0.532_909_3,
    0.0,
    0.0,
    16.0 / 255.0,
    128.0 / 255.0,
    128.0 / 255.0,
    0.0,
];
/// Draws only the part.
const SHOWN: &str = "
@fragment
fn fs_frame(@builtin(position) at: vec4f) -> @location(0) vec4f { return vec4f(frame_at(vec2i(at.xy)), 1.0); }
";
/// Rounding of 32 bits and of constants with seven digits.
const ALLOWED: f64 = 1e-5;

fn linear(code: f64) -> f64 {
    if code <= 0.04045 {
        code / 12.92
    } else {
        ((code + 0.055) / 1.055).powf(2.4)
    }
}

/// Errors of the light that `source` reads.
fn errors(source: &str) -> Errors {
    let (device, scene) = (Device::shared(), Scrambled::new());
    let image_px = scene.stand.setup.image_px;
    let half = UVec2::new(image_px.x.div_ceil(2), image_px.y.div_ceil(2));
    let (luma, chroma) = (numbers(image_px, 5), numbers(half, 6));
    let ([globals, _], encoding) = (scene.shared(device), device.uniform(&MAP));
    let planes = [device.map(&luma), device.map(&chroma)];
    let mut bindings = views(3, &planes);
    bindings.extend([
        (0, globals.as_entire_binding()),
        (2, encoding.as_entire_binding()),
    ]);
    let shown = format!("{source}{SHOWN}");
    let draw = Draw {
        constants: &[("IS_PLANAR", 1.0)],
        ..Draw::of(&shown, "fs_frame", scene.rect.size_px)
    };
    let actual = device.draw(draw, [&bindings, &[]]);
    let expected = Raster::from_fn(scene.rect.size_px, |texel| {
        let at = texel + scene.rect.origin_px;
        let [blue, red] = [0, 1].map(|channel| {
            let sample = |x: i64, y: i64| chroma.at(UVec2::new(index(x), index(y)))[channel];
            chroma_at(sample, [half.x, half.y].map(i64::from), at.to_array())
        });
        let codes = decoded(ENCODING, [luma.at(at).x, blue, red].map(|code| 255.0 * code)) / 255.0;
        DVec4::from([linear(codes.x), linear(codes.y), linear(codes.z), 1.0])
    });
    Errors::between(pairs_of(&actual, &expected))
}

fn index(at: i64) -> u32 {
    u32::try_from(at).unwrap()
}

#[test]
fn planes_are_read_as_light() {
    errors(&source("estimate")).check_all("light of planes", ALLOWED);
}

#[test]
fn a_fault_in_the_reading_is_found() {
    let faults = [
        (
            "+ vec2i(globals.region_origin_px);",
            "+ vec2i(globals.region_origin_px) / 2;",
        ),
        ("linear_from_srgb(codes_of(", "(codes_of("),
        ("if !IS_PLANAR", "if IS_PLANAR"),
        ("2 * (texel % 2) - 1", "1 - 2 * (texel % 2)"),
        ("own + 2 *", "own - 2 *"),
        ("* (ycbcr - origin)", "* ycbcr"),
        ("0.75 * above + 0.25", "0.25 * above + 0.75"),
    ];
    check_faults("estimate", &faults, ALLOWED, errors);
}
