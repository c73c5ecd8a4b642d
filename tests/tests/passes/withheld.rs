//! A withheld shadow has no effect on the estimates, and is reconstructed all the same.

use std::sync::Arc;

use app_core::core::Core;
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::wgpu;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::Map;
use glam::UVec2;
use reference::raster::texels_of;
use reference::withhold::withhold;

use crate::alone::{Draw, check_faults, source};
use crate::cores::core_on;
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::photo::Photo;
use crate::run::{codes_at, input, raster, scene};
use crate::scrambled::{Scrambled, buffers, views};
use crate::setups::SETUPS;
use crate::stand::Stand;

const MAGENTA: [u8; 4] = [255, 0, 255, 255];

/// Draws the physical pose from a photograph.
fn rebuilt(core: &mut Core, stand: &Stand, photograph: &Arc<Image>) -> Image {
    let input = input(stand, photograph).with_shown_pose(stand.physical_pose.clone());
    core.frame(&input).unwrap();
    core.read_picture().unwrap()
}

#[test]
fn a_withheld_shadow_is_rebuilt_and_tells_nothing() {
    let stand = Stand::new(SETUPS[0]);
    let photo = Photo::plain(stand.setup.lights.len());
    let photograph = photo.frame(&stand, &stand.physical);
    let mut core = core_on(scene(&stand, &photo.plate(&stand)), Preset::Balanced).unwrap();
    core.withhold_shadow().unwrap();
    let first = rebuilt(&mut core, &stand, &photograph);

    let origin_px = core.plan().unwrap().region.origin_px;
    let validity = raster(&core.read_map(Map::Validity).unwrap().unwrap());
    let withheld: Vec<UVec2> = texels_of(validity.size())
        .filter(|texel| validity.at(*texel).w < 1.0)
        .map(|texel| origin_px + texel)
        .collect();
    let pairs = |a: &Image, b: &Image| {
        let codes = withheld.iter().flat_map(|texel| codes_at(a, b, *texel));
        Errors::between(codes.collect::<Vec<_>>())
    };
    // Rounding of codes, and edges. Measured: 0.61.
    let off = pairs(&first, &photograph).mean();
    assert!(off > 0.0 && off < 1.0, "{off:.2} codes");

    let mut defaced = Image::clone(&photograph);
    for texel in &withheld {
        let index = 4 * (texel.y * defaced.width_px + texel.x) as usize;
        defaced.rgba8[index..index + 4].copy_from_slice(&MAGENTA);
    }
    let again = rebuilt(&mut core, &stand, &Arc::new(Image::clone(&photograph)));
    let of_defaced = rebuilt(&mut core, &stand, &Arc::new(defaced));
    pairs(&of_defaced, &again).check_all("codes of a defaced shadow", 1.0);
}

/// Errors of the marks that `source` makes.
fn errors(source: &str) -> Errors {
    let (device, scene) = (Device::shared(), Scrambled::new());
    let maps = [
        device.map(&scene.validity),
        device.map(&scene.visibility),
        device.filterable(&scene.ambient),
    ];
    let linear = device.linear_sampler();
    let mut own = views(0, &maps);
    own.push((3, wgpu::BindingResource::Sampler(&linear)));
    let draw = Draw::of(source, "fs_withhold", scene.rect.size_px);
    let actual = device.draw(draw, [&buffers(0, &scene.shared(device)), &own]);
    let expected = withhold(
        &scene.region,
        &scene.pictures(0),
        &scene.solution,
        &scene.validity,
    );
    Errors::between(pairs_of(&actual, &expected))
}

#[test]
fn evidence_without_the_shadow() {
    errors(&source("withhold")).check_all("withhold", 0.0);
}

#[test]
fn a_fault_in_withholding_is_found() {
    let faults = [
        ("LIT: f32 = 0.95", "LIT: f32 = 0.7"),
        (".r == 0.0", ".r < 0.0"),
        ("(point) < MAX_RECEIVERS;", "(point) <= MAX_RECEIVERS;"),
        (", smallest(", ", largest("),
        (".b)),", ".g)),"),
    ];
    check_faults("withhold", &faults, 0.0, errors);
}
