//! `appearance` on scattered evidence of surfaces at several depths.

use glam::{DVec4, UVec2};
use harness::reference::appearance::{Seen, ToyPixel, clean};
use harness::reference::raster::Raster;

use crate::alone::{Bindings, Draw, check_faults, source};
use crate::device::Device;
use crate::errors::Errors;
use crate::numbers::{number, numbers};
use crate::scrambled::{Scrambled, buffers, views};
use app_core::wgpu;

/// Nothing, and surfaces of which the second and third are one.
const DEPTHS: [f64; 4] = [0.0, 0.25, 0.250_976_562_5, 0.5];

struct Toy {
    depth: Raster<f64>,
    /// g is 1 where one surface is seen.
    validity: Raster<DVec4>,
    /// Unit length, more or less.
    normal: Raster<DVec4>,
    received: Raster<DVec4>,
    base: Raster<DVec4>,
}

/// What is kept of a pixel in one output.
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
            DVec4::new(0.0, f64::from(u8::from(is_seen)), 0.0, 1.0)
        }),
        depth,
        normal: numbers(size, 23).map(|n| (2.0 * n - 1.0).as_vec4().as_dvec4()),
        received: numbers(size, 24),
        base: numbers(size, 25),
    }
}

/// Sums of 49 terms of 32 bits. Measured: 5e-7.
const ALLOWED: f64 = 1e-5;

/// How far colours, light and base colours are off that `source` makes.
fn errors(source: &str) -> Errors {
    let (device, scene) = (Device::shared(), Scrambled::new());
    let size = scene.rect.size_px;
    let toy = toy(size);
    let seen = Raster::from_fn(size, |at| Seen {
        pixel: ToyPixel {
            color: scene.image.at(at).truncate(),
            received: toy.received.at(at),
            base: toy.base.at(at).truncate().extend(0.5 + 0.5 * toy.normal.at(at).y),
        },
        depth: toy.depth.at(at),
        is_one_surface: toy.validity.at(at).y == 1.0,
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
    let before = [device.map(&scene.image), device.map(&toy.validity)];
    let depth = device.depth(&toy.depth);
    let after = [&toy.normal, &toy.received, &toy.base].map(|map| device.map(map));
    let mut own: Bindings<'_> = views(0, &before);
    own.push((2, wgpu::BindingResource::TextureView(&depth)));
    own.extend(views(3, &after));
    let color: Part = |pixel| pixel.color.extend(1.0);
    // Of a new picture colours alone are made, of the first three inputs.
    let outputs: [(&str, usize, Part); 4] = [
        ("fs_clean", 0, color),
        ("fs_clean", 1, |pixel| pixel.received),
        ("fs_clean", 2, |pixel| pixel.base),
        ("fs_recolor", 0, color),
    ];
    let mut pairs = Vec::new();
    for (fragment, output, part) in outputs {
        let draw = Draw {
            source,
            fragment,
            constants: &[],
            output,
            size,
        };
        let own = if fragment == "fs_recolor" { &own[..3] } else { &own };
        let actual = device.draw(draw, [&buffers(0, &shared[..1]), own]);
        let both = actual.texels().iter().zip(found.texels());
        pairs.extend(both.flat_map(|(actual, found)| {
            let expected = found.map_or(DVec4::ZERO, part);
            (0..4).map(move |k| (actual[k], expected[k]))
        }));
    }
    Errors::between(pairs)
}

#[test]
fn colours_are_carried_past_the_outline() {
    errors(&source("appearance")).check_all("appearance", ALLOWED);
}

#[test]
fn a_fault_in_the_appearance_is_found() {
    let faults = [
        ("REACH_PX: i32 = 3", "REACH_PX: i32 = 2"),
        ("OTHER_SURFACE: f32 = 1e-4", "OTHER_SURFACE: f32 = 2e-4"),
        ("DEPTH_STEP: f32 = 0.005", "DEPTH_STEP: f32 = 0.001"),
        ("0).g == 1.0", "0).a == 1.0"),
        ("|| is_same_surface(", "|| is_same_surface(2.0 * "),
        ("/ (distance_squared", "/ sqrt(distance_squared"),
        ("a > 0.0 { return Appearance(", "a > 9.0 { return Appearance("),
        ("e > 0.0 { return Appearance(", "e > 9.0 { return Appearance("),
        ("> 0.0 { return color / color.a", "> 9.0 { return color / color.a"),
        ("0.5 + 0.5 * normal.y", "0.5 - 0.5 * normal.y"),
        ("received / color.a", "received"),
    ];
    check_faults("appearance", &faults, ALLOWED, errors);
}
