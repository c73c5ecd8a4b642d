//! `detail` on scrambled inputs, whose residuals are partly noise.

use app_core::wgpu;
use glam::{DVec3, DVec4};
use reference::detail::{evidence, separate};
use reference::model::{Pictures, centre_px};
use reference::raster::Raster;

use crate::alone::{Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::number;
use crate::scrambled::{Scrambled, views};

/// For residuals up to a tenth of the plate, and larger ones where nothing is modelled. Measured:
/// 1.2e-6.
const ALLOWED: f64 = 1e-4;
/// Reflections are many times as bright as a dark plate. Measured: 4.3e-5.
const GLOSSY_ALLOWED: f64 = 1e-3;

/// A scene whose frame differs from the model by less and by more than noise.
fn scene() -> Scrambled {
    let mut scene = Scrambled::new();
    let (region, pictures) = (&scene.region, scene.pictures(0));
    let everywhere = Raster::from_fn(region.size_px, |_| 1.0);
    let seen = Pictures {
        seen: everywhere.clone(),
        ..pictures
    };
    let modelled = evidence(region, &seen, &everywhere, &scene.solution);
    let image = Raster::from_fn(scene.image.size(), |texel| {
        modelled.at(texel).map_or(scene.image.at(texel), |here| {
            let residual = DVec3::from([130, 131, 132].map(|seed| 0.2 * number(texel, seed) - 0.1));
            let plate = scene.plate.at(texel).truncate();
            let color = scene.solution.gain * plate * (here.model + residual);
            color.as_vec3().as_dvec3().extend(1.0)
        })
    });
    scene.image = image;
    scene
}

/// Errors of the residuals that `source` makes.
fn errors(source: &str) -> Errors {
    errors_over(&scene(), source)
}

/// The same over a glossy table, of which most pixels show the surroundings.
fn errors_of_glossy(source: &str) -> Errors {
    errors_over(&Scrambled::reflecting(), source)
}

fn errors_over(scene: &Scrambled, source: &str) -> Errors {
    let device = Device::shared();
    let size = scene.rect.size_px;
    let maps = [
        device.map(&scene.plate),
        device.map(&scene.validity),
        device.map(&scene.visibility),
        device.filterable(&scene.ambient),
    ];
    let linear = device.linear_sampler();
    let mut own = views(0, &maps);
    own.push((4, wgpu::BindingResource::Sampler(&linear)));
    let draw = Draw::of(source, "fs_separate", size);
    let actual = device.draw(draw, [&scene.seen(device).bindings(), &own]);

    let photographed = scene.plate.map(|texel| texel.w);
    let evidence = evidence(&scene.region, &scene.pictures(0), &photographed, &scene.solution);
    let expected = Raster::from_fn(size, |texel| {
        let point = scene.region.receiver_point(centre_px(texel));
        point.map_or(DVec4::ZERO, |point| {
            separate(&evidence, (texel, point.receiver)).extend(1.0)
        })
    });
    Errors::between(pairs_of(&actual, &expected))
}

#[test]
fn noise_is_told_from_detail() {
    errors(&source("detail")).check_all("detail", ALLOWED);
}

#[test]
fn a_fault_in_the_separation_is_found() {
    let faults = [
        ("RADIUS_PX: i32 = 3", "RADIUS_PX: i32 = 2"),
        ("NOISE: f32 = 0.03", "NOISE: f32 = 0.02"),
        ("DETAIL: f32 = 0.08", "DETAIL: f32 = 0.09"),
        ("SHADOW: f32 = 0.85", "SHADOW: f32 = 0.8"),
        ("LIT: f32 = 0.98", "LIT: f32 = 0.95"),
        ("(point) != receiver ||", "(point) + 9u == receiver ||"),
        ("(texel).r == 0.0", "(texel).b == 0.0"),
        (".a < 1.0", ".a < 0.0"),
        ("DARKEST_USABLE: f32 = 0.00303527", "DARKEST_USABLE: f32 = 0.0"),
        ("largest(abs(", "smallest(abs("),
        ("largest(add_own(", "smallest(add_own("),
    ];
    check_faults("detail", &faults, ALLOWED, errors);
}

#[test]
fn detail_of_a_glossy_table() {
    errors_of_glossy(&source("detail")).check_all("detail of a glossy table", GLOSSY_ALLOWED);
    let faults = [
        ("- reflected(point, v)", "+ reflected(point, v)"),
        ("- reflected(point, v)", "- reflected(point, vec4f(1.0))"),
    ];
    check_faults("detail", &faults, GLOSSY_ALLOWED, errors_of_glossy);
}
