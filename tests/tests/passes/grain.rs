//! `composite` with grain: the noise that is added to retargeted pixels, compared with the
//! reference, and the measurement of a picture's noise.

use app_core::frame::FrameInput;
use app_core::grain::{Grain, Noise};
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::session::{Capture, Session};
use desk::files::{BUNDLED_SESSION, Folder};
use glam::{DVec3, DVec4, UVec2};
use harness::open_core;
use reference::grain::{grain_at, smoothed};
use reference::raster::Raster;

use app_pipeline::geometry::rect::PixelRect;

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::number;
use crate::scrambled::{buffers, views};
use crate::setups::WALL;
use crate::stand::Stand;

/// A frame of the bundled session in which the llama steps.
const FRAME: usize = 2;
const VARIANCE: f32 = 2e-4;

fn grain() -> Grain {
    Grain {
        frame: Noise {
            floor: VARIANCE,
            per_light: 0.0,
        },
        plate: Noise::default(),
        weights: [0.5, 0.2],
        channels: 0.3,
    }
}

fn linear(code: u8) -> f64 {
    let encoded = f64::from(code) / 255.0;
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

fn session() -> Capture {
    Capture::open(Folder::open(BUNDLED_SESSION).unwrap()).unwrap()
}

fn drawn(grain: Option<Grain>) -> Image {
    let session = session();
    let input = FrameInput::from(&session.frame(FRAME).unwrap()).with_grain(grain);
    picture(Preset::Balanced, &input)
}

fn picture(preset: Preset, input: &FrameInput) -> Image {
    let mut core = open_core();
    core.set_scene(session().scene().clone(), preset).unwrap();
    core.frame(input).unwrap();
    core.read_picture().unwrap()
}

/// Detail is that of the plate as it was taken: a pixel whose light does not change stays, however
/// noisy the plate is taken to be.
#[test]
fn unchanged_pixels_stay_beside_a_noisy_plate() {
    let plate = Noise {
        floor: VARIANCE,
        per_light: 0.0,
    };
    let grain = Grain {
        frame: Noise::default(),
        plate,
        ..grain()
    };
    let frame = session().frame(FRAME).unwrap();
    let input = FrameInput::from(&frame);
    let [clean, noisy] =
        [None, Some(grain)].map(|grain| picture(Preset::Best, &input.clone().with_grain(grain)));
    let pixels = |image: &Image| image.rgba8.chunks(4).map(<[u8]>::to_vec).collect::<Vec<_>>();
    let [frame, clean, noisy] = [&*frame.image, &clean, &noisy].map(pixels);
    let is_near = |a: &[u8], b: &[u8]| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1);
    let kept = (0..frame.len()).filter(|index| frame[*index] == clean[*index]);
    let n_lost = kept
        .filter(|index| !is_near(&frame[*index], &noisy[*index]))
        .count();
    let n_smoothed = (0..frame.len())
        .filter(|index| !is_near(&clean[*index], &noisy[*index]))
        .count();
    assert!(n_smoothed > 1000, "{n_smoothed} pixels of the plate are smoothed");
    // Made pixels may have the frame's codes, too. With the smoothed plate: 70,321; else 263.
    assert!(n_lost < 1000, "{n_lost} pixels differ from the frame");
}

/// Pixels either keep the camera's noise or have the reference's, with at most its variance; many
/// have the full variance, and the mean in linear light is unchanged.
#[test]
fn made_pixels_have_the_reference_noise() {
    let (clean, grained) = (drawn(None), drawn(Some(grain())));
    let deviation = f64::from(VARIANCE).sqrt();
    let (mut n_full, mut sum) = (0, 0.0);
    for (index, codes) in (0..).zip(clean.rgba8.chunks(4).zip(grained.rgba8.chunks(4))) {
        let at = [
            index % clean.width_px.cast_signed(),
            index / clean.width_px.cast_signed(),
        ];
        let noise = grain_at(at, 1, grain().weights.map(f64::from), f64::from(grain().channels));
        for channel in 0..3 {
            let [before, after] = [codes.0, codes.1].map(|codes| linear(codes[channel]));
            let (added, most) = (after - before, deviation * noise[channel]);
            // Both pictures are rounded, and a software driver's codes have an error of 0.14.
            let step = |code: u8| linear(code.saturating_add(1)) - linear(code);
            let slack = 1.3 * step(codes.0[channel]).max(step(codes.1[channel])).max(0.004);
            assert!(
                added * most.signum() > -slack && added.abs() < most.abs() + slack,
                "{at:?}: {added} of {most}"
            );
            let is_full = most.abs() > 0.02 && added / most > 0.8;
            n_full += i32::from(is_full);
            sum += added;
        }
    }
    assert!(n_full > 1000, "{n_full} have all of it");
    let mean = sum / f64::from(3 * clean.width_px * clean.height_px);
    assert!(mean.abs() < 1e-4, "{mean}");
}

/// Weights of white noise that reaches the next pixels, and of noise that reaches farther.
const NEAR: [f64; 2] = [0.24, 0.06];
const FAR: [f64; 2] = [0.4, 0.2];

/// With noise of a variance that depends on the light, and of these weights; channels have the
/// correlation 0.3.
fn with_noise(clean: &Image, picture: u32, weights: [f64; 2], variance: impl Fn(f64) -> f64) -> Image {
    let mut noisy = clean.clone();
    for (index, codes) in (0..).zip(noisy.rgba8.chunks_mut(4)) {
        let at = [
            index % clean.width_px.cast_signed(),
            index / clean.width_px.cast_signed(),
        ];
        let noise = grain_at(at, picture, weights, 0.3);
        for (code, noise) in codes.iter_mut().zip(noise) {
            let light = linear(*code);
            let shown = (light + variance(light).sqrt() * noise).clamp(0.0, 1.0);
            *code = (0..=255_u8)
                .min_by(|a, b| (linear(*a) - shown).abs().total_cmp(&(linear(*b) - shown).abs()))
                .unwrap();
        }
    }
    noisy
}

/// Some 1.5 codes of a mid grey.
fn faint(light: f64) -> f64 {
    1e-4 * light
}

#[test]
fn faint_noise_is_measured_and_that_of_the_plate() {
    let session = session();
    let plate = &session.scene().plates[0].image;
    let noisy = with_noise(&session.frame(FRAME).unwrap().image, 7, NEAR, faint);
    let found = Grain::measured(&noisy, plate).expect("grain");
    let ratio = found.frame.variance(0.3) / faint(0.3);
    assert!((0.85..1.2).contains(&ratio), "{ratio}");
    assert!(found.plate.variance(0.3) < 0.1 * faint(0.3), "{found:?}");
    let as_noisy = with_noise(plate, 8, NEAR, faint);
    let found = Grain::measured(&noisy, &as_noisy).expect("grain");
    let ratio = found.plate.variance(0.3) / found.frame.variance(0.3);
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
}

/// A picture that is displaced by a part of a pixel to the right and down.
fn displaced(image: &Image, part: f64) -> Image {
    let mut moved = image.clone();
    let width = image.width_px as usize;
    for (index, codes) in moved.rgba8.chunks_mut(4).enumerate() {
        let up = if index < width { 0 } else { width };
        let left = usize::from(index % width > 0);
        for (channel, code) in codes.iter_mut().enumerate() {
            let at = |back: usize| f64::from(image.rgba8[4 * (index - back) + channel]);
            let row = |up: usize| (1.0 - part) * at(up) + part * at(up + left);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
            let mixed = ((1.0 - part) * row(0) + part * row(up)).round() as u8;
            *code = mixed;
        }
    }
    moved
}

#[test]
fn a_displaced_plate_is_no_noise() {
    let session = session();
    let clean = session.frame(FRAME).unwrap().image;
    let plate = displaced(&session.scene().plates[0].image, 0.3);
    assert_eq!(Grain::measured(&clean, &plate), None);
}

#[test]
fn noise_is_measured() {
    let session = session();
    let plate = &session.scene().plates[0].image;
    let clean = session.frame(FRAME).unwrap().image.as_ref().clone();
    assert_eq!(Grain::measured(&clean, plate), None, "of a clean picture");
    let wanted = |light: f64| 2e-5 + 1.4e-3 * light;
    for weights in [NEAR, FAR] {
        let noisy = with_noise(&clean, 7, weights, wanted);
        check_found(&Grain::measured(&noisy, plate).unwrap(), weights, wanted);
    }
}

fn check_found(found: &Grain, weights: [f64; 2], wanted: impl Fn(f64) -> f64) {
    for light in [0.1, 0.3] {
        let variance = f64::from(found.frame.floor) + f64::from(found.frame.per_light) * light;
        let ratio = variance / wanted(light);
        assert!((0.85..1.2).contains(&ratio), "at {light}: {ratio}");
    }
    for (found, wanted) in found.weights.into_iter().zip(weights) {
        assert!((f64::from(found) - wanted).abs() < 0.08, "{found} for {wanted}");
    }
    assert!((found.channels - 0.3).abs() < 0.08, "channels {}", found.channels);
}

/// The smoothed plate, and the part of its noise that is left.
const PROBE: &str = "
@fragment fn fs_probe(@builtin(position) position: vec4f) -> @location(0) vec4f {
  let b = smoothed_plate(vec2u(position.xy), position.x > 101.0 && position.y < 40.0);
  return vec4f(b.rgb, plate_left);
}";
/// Variance of the plate's noise in the dark and per unit of light.
const PLATE_NOISE: [f32; 2] = [2e-5, 6e-4];
/// Weights with a correlation of neighbours below and above the limit.
const WEIGHTS: [[f32; 2]; 2] = [[0.25, 0.1], [0.5, 0.3]];

/// A plate with noise alone, with texture, with unknown pixels, and with equal ones.
fn scrambled_plate(size: UVec2) -> Raster<DVec4> {
    Raster::from_fn(size, |at| {
        let is_even = at.cmpgt(EVEN_FROM).all();
        let texture = [0.0, 0.01, 0.1][(at.x / 20) as usize % 3];
        let light = |seed: u32| 0.3 + texture * number(at / 3, seed) + 0.02 * number(at, seed + 3);
        let alpha = if number(at / 5, 7) < 0.1 && !is_even {
            0.25
        } else {
            1.0
        };
        let color = DVec3::from([1, 2, 3].map(light));
        let color = if is_even { DVec3::splat(0.25) } else { color };
        color.as_vec3().as_dvec3().extend(alpha)
    })
}

/// The plate is equal in a block beyond this, and known.
const EVEN_FROM: UVec2 = UVec2::new(120, 90);

/// Whether a pixel shows a thing.
fn is_of_thing(at: UVec2) -> bool {
    at.x > 100 && at.y < 40
}

/// Errors of the plate that `source` smooths.
fn errors(source: &str) -> Errors {
    Errors::between(WEIGHTS.map(|weights| pairs(source, weights)).concat())
}

fn pairs(source: &str, weights: [f32; 2]) -> Vec<(f64, f64)> {
    let device = Device::shared();
    let stand = Stand::new(WALL);
    let rect = PixelRect {
        origin_px: UVec2::ZERO,
        size_px: WALL.image_px,
    };
    let plate = scrambled_plate(rect.size_px);
    // Number of the picture and details; noise of frame and plate; weights; channels and strength.
    let drawing = [[0.0; 2], [0.0; 2], PLATE_NOISE, weights, [0.0, 1.0]];
    let globals = [device.uniform(&stand.globals(&rect))];
    let maps = [device.map(&plate)];
    let mut own = views(20, &maps);
    let drawing = [device.uniform(&drawing)];
    own.extend(buffers(21, &drawing));
    // Only two groups are bound here.
    let source = source
        .replace("@group(2) @binding(0)", "@group(1) @binding(20)")
        .replace("@group(2) @binding(4)", "@group(1) @binding(21)");
    let source = format!("{source}{PROBE}");
    let draw = Draw {
        constants: &[("HAS_GRAIN", 1.0), ("HAS_PLATE_NOISE", 1.0)],
        ..Draw::of(&source, "fs_probe", rect.size_px)
    };
    let actual = device.draw(draw, [&buffers(0, &globals), &own]);
    let expected = Raster::from_fn(rect.size_px, |at| {
        let variance = |light: f64| f64::from(PLATE_NOISE[0]) + f64::from(PLATE_NOISE[1]) * light;
        if is_of_thing(at) {
            return plate.at(at).truncate().extend(1.0);
        }
        let (color, left) = smoothed(&plate, at, weights.map(f64::from), variance);
        color.extend(left)
    });
    let n_partly = expected
        .texels()
        .iter()
        .filter(|texel| texel.w > 0.6 && texel.w < 0.95);
    assert!(n_partly.count() > 500, "few pixels are smoothed in part");
    pairs_of(&actual, &expected)
}

/// Limit for rounding.
const ALLOWED: f64 = 1e-3;

#[test]
fn a_plate_is_smoothed_where_it_has_noise_alone() {
    errors(&source("composite")).check_all("smoothed plate", ALLOWED);
}

#[test]
fn a_fault_in_the_smoothing_is_found() {
    let faults = [
        ("STRUCTURE: f32 = 1.0", "STRUCTURE: f32 = 0.9"),
        ("vec3f(1.0 / 8.0)", "vec3f(1.0 / 9.0)"),
        ("vec3f(9.0 / 8.0)", "vec3f(1.0)"),
        ("(1.0 - of_mean);", "1.0;"),
        ("n == 9.0 && !of_thing", "n > 8.0 || !of_thing"),
        ("n == 9.0 && !of_thing", "n == 9.0"),
        (
            "= select(0.0, max(1.0 - STRUCTURE",
            "= select(1.0, max(1.0 - STRUCTURE",
        ),
        ("(1.0 - kept) * of_mean)", "(1.0 - kept))"),
        ("2.0 * kept * with_mean", "kept * with_mean"),
        ("CORRELATED: f32 = 0.5", "CORRELATED: f32 = 0.9"),
        ("vec2f(near.y, of_four_apart)", "near"),
        ("pow(drawing.grain_weights.y, 2.0)", "0.0"),
        ("+ (1.0 - kept) * mean, b.a", "+ mean, b.a"),
        ("b.rgb + mean)", "vec3f(0.0))"),
    ];
    check_faults("composite", &faults, ALLOWED, errors);
}
