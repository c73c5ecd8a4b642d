//! The toy's shadow on things, on scrambled inputs.

use glam::{DMat3, DVec3, DVec4, UVec2};
use reference::on_things::{RELIT, Shaded, on_things};
use reference::raster::Raster;
use reference::things::{BEFORE_TOY, HIDDEN_THING, THING, Things};

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::number;
use crate::scrambled::{Scrambled, buffers, views};

/// Blocks of each code, with heights up to some centimetres and none.
fn things(size: UVec2) -> Things {
    let codes = [THING, 0, BEFORE_TOY, HIDDEN_THING];
    Things {
        codes: Raster::from_fn(size, |at| {
            let code = codes[(at.x / 9 + at.y / 5) as usize % 4];
            let [high, low] = match (at / 4).element_sum() % 5 {
                0 => [0, 0],
                n => [u8::try_from(5 * n).unwrap(), u8::try_from(at.x).unwrap()],
            };
            [code, high, low, u8::try_from(at.y).unwrap() + 120]
        }),
        // Exact in binary, and every pixel has its own mark.
        codes_px_from_region_px: DMat3::IDENTITY,
    }
}

/// Visibilities of the shown toy: in part those before, and elsewhere smooth.
fn shown(scene: &Scrambled) -> Raster<DVec4> {
    Raster::from_fn(scene.rect.size_px, |at| {
        if at.x % 40 < 20 {
            scene.visibility.at(at)
        } else {
            DVec4::from([81, 82, 83, 84].map(|seed| number(at / 8, seed)))
        }
    })
}

/// Marks of things, some of which hide another one.
fn validity(size: UVec2) -> Raster<DVec4> {
    Raster::from_fn(size, |at| {
        let alpha = [0.8, 0.6, 0.8, 0.4, 0.2][(at.x / 7 + at.y / 11) as usize % 5];
        DVec4::new(0.0, 0.0, number(at / 6, 91).round(), alpha)
    })
}

/// Errors of the plate with things that `source` makes.
fn errors(source: &str) -> Errors {
    let (device, mut scene) = (Device::shared(), Scrambled::new());
    // A warm light, whose share in red would be more than all of the light.
    scene.solution.receivers[0].direct_fractions[0] = DVec3::new(0.64, 0.38, 0.2);
    let size = scene.rect.size_px;
    let (things, shown, validity) = (things(size), shown(&scene), validity(size));
    let columns = [0, 1, 2].map(|index| things.codes_px_from_region_px.as_mat3().col(index).extend(0.0));
    let of_codes = |codes: [u8; 4]| DVec4::from_array(codes.map(|code| f64::from(code) / 255.0));
    let maps = [
        device.map(&things.codes.map(of_codes)),
        device.map(&scene.plate),
        device.map(&scene.visibility),
        device.map(&shown),
        device.map(&validity),
    ];
    let view = device.uniform(&columns.map(|column| column.to_array()));
    let mut own = buffers(0, std::slice::from_ref(&view));
    own.extend(views(1, &maps));
    let seen = scene.seen(device);
    let actual = device.draw(Draw::of(source, "fs_shade", size), [&seen.bindings(), &own]);
    let photographed = scene.plate.map(|texel| texel.w);
    let shaded = Shaded {
        things: &things,
        validity: &validity,
        photographed: &photographed,
        shown: &shown,
        camera_in_anchor: DVec3::from(scene.stand.globals(&scene.rect).camera_in_anchor.map(f64::from)),
    };
    let pictures = scene.pictures(0);
    let expected = Raster::from_fn(size, |texel| {
        on_things(&scene.region, &pictures, &scene.solution, &shaded, texel)
    });
    let is_in = |texel: &&DVec4| texel.w > RELIT[0] && texel.w < RELIT[1];
    let n_relit = expected.texels().iter().filter(is_in).count();
    assert!(n_relit > 100, "{n_relit} pixels are in part in a shadow");
    let n_hidden = expected
        .texels()
        .iter()
        .filter(|texel| texel.w == RELIT[1])
        .count();
    assert!(n_hidden > 500, "{n_hidden} pixels are made");
    Errors::between(pairs_of(&actual, &expected))
}

/// Limit for rounding: of places in the picture, between whose pixels visibilities jump.
const ALLOWED: f64 = 3e-4;

#[test]
fn the_shadow_on_things() {
    errors(&source("on_things")).check_all("on_things", ALLOWED);
}

#[test]
fn a_fault_in_the_shadow_on_things_is_found() {
    let faults = [
        ("HEIGHT_STEP_M: f32 = 1e-5", "HEIGHT_STEP_M: f32 = 2e-5"),
        ("NEARBY_PX: f32 = 3.0", "NEARBY_PX: f32 = 2.0"),
        ("KEEP_NONE: f32 = 0.15", "KEEP_NONE: f32 = 0.3"),
        ("point - point.y / to_light.y", "point + point.y / to_light.y"),
        ("|| b.a < 1.0", "|| b.a < 0.0"),
        ("!= 0u { return vec2f(1.0)", "!= 1u { return vec2f(1.0)"),
        ("mix(f / fit.gain.rgb", "mix(f"),
        ("(256.0 * codes.x", "(255.0 * codes.x"),
        (
            "min(of_thing.y * total / mean, vec3f(1.0))",
            "of_thing.y * total / mean",
        ),
        ("1.0 - marks.b", "0.0"),
        ("if is_before_thing(marks) { return b; }", ""),
        ("RELIT_RANGE * made", "RELIT_RANGE"),
    ];
    check_faults("on_things", &faults, ALLOWED, errors);
}
