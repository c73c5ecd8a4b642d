//! `search` on few, scattered samples, some of them missing, with warps that point inside the
//! region and outside.

use app_core::scene::MAX_RECEIVERS;
use app_pipeline::baseline::uniform::Baseline as BaselineUniform;
use app_pipeline::geometry::rect::PixelRect;
use glam::{DVec2, DVec4, UVec2};
use reference::raster::Raster;
use reference::search::{Rings, Start, search, term};
use reference::sets::LightSet;

use crate::alone::{Bindings, Draw, check_faults, source};
use crate::device::Device;
use crate::errors::Errors;
use crate::numbers::{number, numbers};
use crate::scrambled::views;
use crate::setups::SETUPS;
use crate::stand::Stand;

const RINGS: Rings = Rings {
    step_px: 2.0,
    n_directions: 8,
    n_rings: 60,
};
/// The overlap of both lights is stated to occur, but does not.
const SEEN: [LightSet; 3] = [LightSet(1), LightSet(2), LightSet(3)];

/// Share of values that rounding may decide, since a candidate may be on either side of a texel's
/// border. Measured: 0.
const ALLOWED_SHARE: f64 = 0.001;

/// Original positions of two lights' shadows; alpha is 1 where there is a shadow.
fn warp(size: UVec2, light: u32) -> Raster<DVec4> {
    Raster::from_fn(size, |at| {
        let toward = DVec2::from([0, 1].map(|k| number(at, 100 + 2 * light + k)));
        let source = (3.0 * toward - 1.0) * size.as_dvec2();
        let is_shaded = number(at, 110 + light) < 0.6;
        let source = source.as_vec2().as_dvec2();
        DVec4::new(source.x, source.y, 0.0, f64::from(u8::from(is_shaded)))
    })
}

/// One texel in a few hundred is eligible, or in a few dozen, for one light or the other.
fn eligible(size: UVec2) -> Raster<u8> {
    Raster::from_fn(size, |at| {
        let share = if at.x < size.x / 2 { 0.004 } else { 0.04 };
        let is_any = number(at, 120) < share;
        let first = number(at, 121) < 0.5;
        u8::from(is_any) * if first { 1 } else { 2 }
    })
}

fn settings() -> BaselineUniform {
    BaselineUniform {
        textured_receivers: 1,
        ring_step_px: 2.0,
        n_ring_directions: RINGS.n_directions,
        n_rings: RINGS.n_rings,
        ..bytemuck::Zeroable::zeroed()
    }
}

/// Actual and expected terms with labels, and taps.
fn pairs(source: &str) -> [Vec<(f64, f64)>; 2] {
    let (device, stand) = (Device::shared(), Stand::new(SETUPS[1]));
    let rect = PixelRect {
        origin_px: UVec2::new(13, 7),
        size_px: UVec2::new(71, 53),
    };
    let (image, plate) = (numbers(stand.setup.image_px, 31), numbers(rect.size_px, 32));
    let (warps, eligible) = (
        [0, 1].map(|light| warp(rect.size_px, light)),
        eligible(rect.size_px),
    );
    let sets = eligible.map(|label| LightSet(u32::from(label)));
    let texels = Raster::from_fn(rect.size_px, |texel| texel);
    let expected = texels.map(|texel| {
        let lights: Vec<u32> = [0, 1]
            .into_iter()
            .filter(|light| warps[*light as usize].at(texel).w > 0.0)
            .collect();
        if lights.is_empty() {
            return (DVec4::ZERO, 0.0);
        }
        let sources = lights.iter().map(|light| warps[*light as usize].at(texel));
        let start = Start {
            set: LightSet::of(&lights),
            sources_px: sources.map(|source| DVec2::new(source.x, source.y)).collect(),
        };
        let found = search(&sets, &SEEN, &start, &RINGS);
        let term = found.texel.map_or(DVec4::ZERO, |sample| {
            let sample = sample.as_uvec2();
            let (frame, plate) = (image.at(rect.origin_px + sample), plate.at(sample));
            term(frame.truncate(), plate.truncate(), true).extend(f64::from(start.set.0))
        });
        (term, f64::from(found.n_taps))
    });

    let uniforms = [device.uniform(&stand.globals(&rect)), device.uniform(&settings())];
    let seen = SEEN.iter().fold(0u32, |seen, set| seen | 1 << set.0);
    let mut words = [0; MAX_RECEIVERS];
    words[0] = seen;
    let seen = device.storage(bytemuck::bytes_of(&words));
    let maps = [
        device.array(&[&warps[0], &warps[1]]),
        device.labels(&eligible.map(|label| [label, 0])),
        device.map(&image),
        device.map(&plate),
    ];
    let shared: Bindings<'_> = vec![
        (0, uniforms[0].as_entire_binding()),
        (1, uniforms[1].as_entire_binding()),
    ];
    let mut own = views(0, &maps);
    own.push((4, seen.as_entire_binding()));
    let actual = [0, 1].map(|output| {
        let draw = Draw {
            output,
            ..Draw::of(source, "fs_search", rect.size_px)
        };
        device.draw(draw, [&shared, &own])
    });
    let of_terms = actual[0].texels().iter().zip(expected.texels());
    let of_taps = actual[1].texels().iter().zip(expected.texels());
    [
        of_terms
            .flat_map(|(actual, (term, _))| (0..4).map(|k| (actual[k], term[k])))
            .collect(),
        of_taps.map(|(actual, (_, taps))| (actual.x, *taps)).collect(),
    ]
}

#[test]
fn scattered_samples_are_found() {
    let [of_terms, of_taps] = pairs(&source("search"));
    let n_found = of_terms.iter().filter(|(_, expected)| *expected > 0.0).count();
    assert!(n_found > 1500, "{n_found} values are found");
    Errors::between(of_terms).check("terms of scattered samples", (1e-5, ALLOWED_SHARE), 3.0);
    Errors::between(of_taps).check("taps", (0.0, ALLOWED_SHARE), f64::INFINITY);
}

#[test]
fn a_fault_in_the_search_is_found() {
    let faults = [
        ("baseline.n_rings, u32(", "baseline.n_rings, u32(2.0 * "),
        (
            "abs(globals.region_size_px - ",
            "abs(0.0 * globals.region_size_px - ",
        ),
        ("0.5 * f32(", "0.0 * f32("),
        ("distance(vec2f(", "0.0 * distance(vec2f("),
        ("&= ~", "&= 0u & ~"),
        ("2u * countOneBits(", "0u * countOneBits("),
        (", vec3f(1.0)),", ", vec3f(1e9)),"),
    ];
    // An error counts as a fault if it occurs in more places than rounding decides.
    let errors = |source: &str| {
        let share = pairs(source).map(|pairs| Errors::between(pairs).share_beyond(1e-5));
        Errors::between([(share[0].max(share[1]), 0.0)])
    };
    check_faults("search", &faults, 2.0 * ALLOWED_SHARE, errors);
}
