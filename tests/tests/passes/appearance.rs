//! `appearance` on scattered evidence of surfaces at several depths.

use glam::{DVec4, IVec2, UVec2};
use reference::appearance::{REACH_PX, Seen, ToyPixel, clean};
use reference::raster::Raster;

use crate::alone::{Bindings, Draw, check_faults, source};
use crate::device::Device;
use crate::errors::Errors;
use crate::numbers::{number, numbers};
use crate::scrambled::{Scrambled, buffers, views};
use app_core::wgpu;

/// Depth of no surface, and depths of surfaces, the second and third of which count as one.
const DEPTHS: [f64; 4] = [0.0, 0.25, 0.250_976_562_5, 0.5];

struct Toy {
    depth: Raster<f64>,
    /// g is 1 where a single surface is visible.
    validity: Raster<DVec4>,
    /// Approximate unit length.
    received: Raster<DVec4>,
    base: Raster<DVec4>,
}

/// The part of a pixel that is stored in one output.
type Part = fn(ToyPixel) -> DVec4;

/// Patches of surfaces; evidence is sparse enough that some pixels have none in reach.
fn toy(size: UVec2) -> Toy {
    let depth = Raster::from_fn(size, |at| {
        let surface = (at.x / 4 * 7 + at.y / 5 * 3 + at.x / 9) % 4;
        DEPTHS[surface as usize]
    });
    Toy {
        validity: Raster::from_fn(size, |at| {
            let is_sparse = number(at / 16, 92) < 0.5;
            let share = if is_sparse { 0.02 } else { 0.3 };
            let is_seen = depth.at(at) > 0.0 && number(at, 91) < share;
            // Another surface may be mixed into it.
            let of_surface = if number(at, 93) < 0.4 { 0.0625 } else { 1.0 };
            DVec4::new(0.0, if is_seen { of_surface } else { 0.0 }, 0.0, 1.0)
        }),
        depth,
        received: numbers(size, 24),
        base: numbers(size, 25),
    }
}

/// A colour is only copied from another pixel. Measured: 0.
const ALLOWED: f64 = 1e-6;

/// Errors of the colours, light and base colours that `source` makes.
fn errors(source: &str) -> Errors {
    let (device, scene) = (Device::shared(), Scrambled::new());
    let size = scene.rect.size_px;
    let toy = toy(size);
    let seen = Raster::from_fn(size, |at| Seen {
        pixel: ToyPixel {
            color: scene.image.at(at).truncate(),
            received: toy.received.at(at),
            base: toy.base.at(at),
        },
        depth: toy.depth.at(at),
        is_one_surface: toy.validity.at(at).y > 0.0,
    });
    let found = Raster::from_fn(size, |texel| clean(&seen, texel));
    let n_none = found.texels().iter().filter(|pixel| pixel.is_none()).count();
    let is_thin =
        |texel: &UVec2| !seen.at(*texel).is_one_surface && found.at(*texel) == Some(seen.at(*texel).pixel);
    let texels = Raster::from_fn(size, |texel| texel);
    let n_thin = texels.texels().iter().filter(|texel| is_thin(texel)).count();
    assert!(
        n_none > 50 && n_thin > 50,
        "{n_none} find none, {n_thin} their own"
    );

    let shared = scene.shared(device);
    let [validity, received, base] = [&toy.validity, &toy.received, &toy.base].map(|map| [device.map(map)]);
    let depth = device.depth(&toy.depth);
    let own: Bindings<'_> = [
        views(0, &validity),
        vec![(1, wgpu::BindingResource::TextureView(&depth))],
        views(2, &received),
        views(3, &base),
    ]
    .concat();
    let drawn = |output| {
        let draw = Draw {
            output,
            ..Draw::of(source, "fs_clean", size)
        };
        device.draw(draw, [&buffers(0, &shared[..1]), &own])
    };
    let sources = drawn(2);
    let colors = texels.map(|texel| color_from(&scene.image, texel, sources.at(texel).x));
    let outputs: [(Raster<DVec4>, Part); 3] = [
        (drawn(0), |pixel| pixel.received),
        (drawn(1), |pixel| pixel.base),
        (colors, |pixel| pixel.color.extend(1.0)),
    ];
    let mut pairs = Vec::new();
    for (actual, part) in outputs {
        let both = actual.texels().iter().zip(found.texels());
        pairs.extend(both.flat_map(|(actual, found)| {
            let expected = found.map_or(DVec4::ZERO, part);
            (0..4).map(move |k| (actual[k], expected[k]))
        }));
    }
    Errors::between(pairs)
}

/// Colour of the pixel that a source code refers to: the pixels of the square around a texel are
/// numbered row by row, eight to a row.
fn color_from(image: &Raster<DVec4>, texel: UVec2, source: f64) -> DVec4 {
    let number = (0..255).find(|number| (255.0 * source - f64::from(*number)).abs() < 0.5);
    let Some(number) = number else {
        return DVec4::ZERO;
    };
    let offset = IVec2::new(number % 8, number / 8) - REACH_PX;
    let last = image.size().as_ivec2() - 1;
    let from = (texel.as_ivec2() + offset).clamp(IVec2::ZERO, last);
    image.at(from.as_uvec2()).truncate().extend(1.0)
}

#[test]
fn colours_are_carried_past_the_outline() {
    errors(&source("appearance")).check_all("appearance", ALLOWED);
}

#[test]
fn a_fault_in_the_appearance_is_found() {
    let faults = [
        ("REACH_PX: i32 = 3", "REACH_PX: i32 = 2"),
        ("OTHER_SURFACE: i32 = 64", "OTHER_SURFACE: i32 = 4"),
        ("DEPTH_STEP: f32 = 0.005", "DEPTH_STEP: f32 = 0.001"),
        ("0).g > 0.0", "0).g == 1.0"),
        ("marks.b == 1.0", "marks.a == 1.0"),
        ("|| is_same_surface(", "|| is_same_surface(2.0 * "),
        ("far < least", "far <= least"),
        ("here > 0.0", "here > 9.0"),
        ("number / u32(N", "number % u32(N"),
        ("* N_IN_ROW + offset.x", "* N_IN_ROW - offset.x"),
        ("/ 255.0, 0.0", "/ 250.0, 0.0"),
        (
            "textureLoad(gbuffer_base, from_texel",
            "textureLoad(gbuffer_base, texel",
        ),
        (
            "textureLoad(gbuffer_received, from_texel",
            "textureLoad(gbuffer_received, texel",
        ),
    ];
    check_faults("appearance", &faults, ALLOWED, errors);
}
