//! Lights that are moved, switched on or out of sight during a session.
//!
//! Worlds are photographed by exact rays; the lights that are found are compared with the true
//! lamps.

use std::sync::Arc;

use app_core::Core;
use app_core::alignment::{Aligner, Alignment, AlignmentWarning};
use app_core::frame::FrameInput;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::scene::{Image, Light, PoseUncertainty, Scene};
use app_core::wgpu::{Instance, InstanceDescriptor};
use desk::alignment::SeenLight;
use desk::metrics::score;
use glam::DVec3;
use measure::photographer::world::toward;
use measure::photographer::{Lamp, Quality, Shot, World};

const SIZE_PX: [u32; 2] = [512, 288];

/// The boxes under some lamps.
fn shot(lamps: Vec<Lamp>) -> Shot {
    let mut world = World::boxes().resized(SIZE_PX).lit_by(lamps);
    world.quality = Quality {
        n_across: 2,
        n_light_rays: 48,
        n_sky_rays: 32,
    };
    Shot::of(&world).unwrap()
}

fn bulb(elevation_deg: f64, azimuth_deg: f64) -> Lamp {
    Lamp::bulb(toward(elevation_deg, azimuth_deg), 0.01, 0.6)
}

/// Aligns the boxes under one bulb, then under other lamps, with the list of the first.
fn relit(list: impl Fn(&Shot) -> Vec<Light>, lamps: Vec<Lamp>) -> (Vec<Light>, [Alignment; 2]) {
    let (before, after) = (shot(vec![bulb(50.0, 30.0)]), shot(lamps));
    let mut scene = before.scene.clone();
    scene.lights = list(&before);
    let mut aligner = Aligner::new(scene);
    let found = [&before, &after].map(|shot| aligner.align(&shot.input).unwrap());
    (after.scene.lights, found)
}

fn listed(shot: &Shot) -> Vec<Light> {
    shot.scene.lights.clone()
}

fn nobody(_: &Shot) -> Vec<Light> {
    Vec::new()
}

/// Largest angle from a lamp to the nearest light that was found, from the centre of the table, in
/// degrees.
fn off_deg(lamps: &[Light], found: &Alignment) -> f64 {
    let direction = |light: &Light| SeenLight::from(0.05 * DVec3::Y, light).direction_in_world;
    let found = found.lights.as_deref().unwrap_or_default();
    assert_eq!(found.len(), lamps.len(), "{found:?}");
    let nearest = lamps.iter().map(|lamp| {
        let off_rad = found
            .iter()
            .map(|light| direction(light).angle_between(direction(lamp)));
        off_rad.fold(f64::INFINITY, f64::min)
    });
    nearest.fold(0.0, f64::max).to_degrees()
}

#[test]
fn a_listed_light_that_is_moved_is_found_again() {
    for lamp in [bulb(52.0, 33.0), bulb(40.0, 140.0)] {
        let (lamps, [before, after]) = relit(listed, vec![lamp]);
        assert_eq!(before.lights, None, "{:?}", before.report);
        assert!(off_deg(&lamps, &after) < 0.15, "{:?}", after.report);
        assert!(after.warnings.is_empty(), "{:?}", after.warnings);
    }
}

#[test]
fn a_light_that_nobody_lists_is_followed() {
    let (lamps, [before, after]) = relit(nobody, vec![bulb(60.0, -20.0)]);
    assert!(off_deg(&lamps, &before) > 10.0, "{:?}", before.report);
    assert!(off_deg(&lamps, &after) < 0.15, "{:?}", after.report);
}

#[test]
fn a_lamp_that_is_switched_on_is_found() {
    let lamps = vec![
        bulb(50.0, 30.0),
        Lamp::bulb(0.8 * toward(60.0, -70.0), 0.02, 0.35),
    ];
    let (lamps, [before, after]) = relit(listed, lamps);
    assert_eq!(before.lights, None);
    assert!(off_deg(&lamps, &after) < 0.15, "{:?}", after.report);
}

#[test]
fn a_light_is_kept_while_its_shadow_is_as_it_was() {
    let (_, [before, after]) = relit(nobody, vec![bulb(50.0, 30.0)]);
    assert_eq!(before.lights, after.lights);
    let unexplained = [before, after].map(|found| found.report.unexplained.unwrap());
    assert!(unexplained.iter().all(|part| *part < 0.02), "{unexplained:?}");
}

#[test]
fn a_dimmed_light_is_kept() {
    let dimmed = Lamp::bulb(toward(50.0, 30.0), 0.01, 0.3);
    let (_, [before, after]) = relit(nobody, vec![dimmed]);
    assert_eq!(before.lights, after.lights, "{:?}", after.report);
}

/// A list that is far off is corrected if the shadow shows a light elsewhere.
#[test]
fn a_light_that_is_listed_60_degrees_off_is_found() {
    let mut shot = shot(vec![bulb(50.0, 30.0)]);
    let lamps = std::mem::replace(&mut shot.scene.lights, vec![bulb(50.0, 150.0).light]);
    let found = Aligner::new(shot.scene).align(&shot.input).unwrap();
    assert!(off_deg(&lamps, &found) < 0.15, "{:?}", found.report);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
}

/// A shadow that no light casts moves no list, since that remains the best estimate.
#[test]
fn a_list_stays_where_no_light_explains_the_shadow() {
    let shot = shot(vec![bulb(50.0, 30.0)]);
    let input = shot
        .input
        .clone()
        .with_image(with_dark_bars(shot.input.image.rgba()));
    let found = Aligner::new(shot.scene).align(&input).unwrap();
    assert_eq!(found.lights, None, "{:?}", found.report);
    assert!(
        matches!(found.warnings[..], [AlignmentWarning::ListUnexplained { .. }]),
        "{:?} {:?}",
        found.warnings,
        found.report
    );
}

/// A shadow that no light casts is reported, and moves no light.
#[test]
fn a_shadow_that_no_light_casts_is_said() {
    let before = shot(vec![bulb(50.0, 30.0)]);
    let mut aligner = Aligner::new(before.scene.clone());
    assert_eq!(aligner.align(&before.input).unwrap().lights, None);
    let input = before
        .input
        .clone()
        .with_image(with_dark_bars(before.input.image.rgba()));
    let after = aligner.align(&input).unwrap();
    assert_eq!(after.lights, None, "{:?}", after.report);
    let said = after.warnings.iter();
    assert!(
        said.clone()
            .any(|warning| matches!(warning, AlignmentWarning::LightsChanged { .. })),
        "{:?} {:?}",
        after.warnings,
        after.report
    );
}

/// What lights leave unexplained is said of the views that show their shadows.
#[test]
fn a_view_without_shadows_says_nothing_about_lights() {
    let before = shot(vec![bulb(50.0, 30.0)]);
    let input = before.input.clone();
    let mut aligner = Aligner::new(before.scene.clone());
    let unexplained = |image: &Arc<Image>, aligner: &mut Aligner| {
        let found = aligner.align(&input.clone().with_image(image.clone())).unwrap();
        found.report.unexplained
    };
    assert!(unexplained(input.image.rgba(), &mut aligner).is_some());
    assert_eq!(unexplained(&before.scene.plates[0].image, &mut aligner), None);
}

/// A picture with every other column of 24 pixels at half its codes, except for the centre with the
/// toy.
fn with_dark_bars(image: &Image) -> Image {
    let mut image = image.clone();
    let middle = image.width_px / 3..2 * image.width_px / 3;
    for (index, pixel) in (0..).zip(image.rgba8.chunks_exact_mut(4)) {
        let column = index % image.width_px;
        if !middle.contains(&column) && (column / 24).is_multiple_of(2) {
            pixel[..3].iter_mut().for_each(|code| *code /= 2);
        }
    }
    image
}

/// RMSE of shadow and toy.
fn errors(core: &mut Core, scene: impl Into<Arc<Scene>>, input: &FrameInput, shot: &Shot) -> [f64; 2] {
    core.set_scene(scene, Preset::Balanced).unwrap();
    core.frame(input).unwrap();
    let scores = score(&core.read_picture().unwrap(), &shot.truth).unwrap();
    [scores.shadow.rmse, scores.toy.rmse]
}

/// The new shadow is as accurate as with a plate that was taken under the moved lamp.
#[test]
fn plates_follow_a_moved_lamp() {
    let before = shot(vec![bulb(50.0, 30.0)]);
    let after = shot(vec![bulb(40.0, 140.0)]);
    let mut aligner = Aligner::new(before.scene.clone());
    aligner.align(&before.input).unwrap();
    let found = aligner.align(&after.input).unwrap();
    assert!(Arc::ptr_eq(aligner.scene(), found.scene.as_ref().unwrap()));
    let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
    let mut core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest)).unwrap();
    let relit = errors(
        &mut core,
        aligner.scene().clone(),
        &found.applied_to(&after.input),
        &after,
    );
    let anew = errors(&mut core, after.scene.clone(), &after.input, &after);
    let outdated = errors(
        &mut core,
        before.scene.clone(),
        &found.applied_to(&after.input),
        &after,
    );
    assert!(relit[0] < 1.15 * anew[0], "{relit:?}, with a new plate {anew:?}");
    assert!(relit[1] < 1.15 * anew[1], "{relit:?}, with a new plate {anew:?}");
    assert!(
        relit[0] < 0.3 * outdated[0],
        "{relit:?}, with the old plate {outdated:?}"
    );
}

/// The texels of a patch of a picture's lower border.
fn patch(image: &Image) -> impl Iterator<Item = usize> + use<> {
    const SIDE_PX: u32 = 32;
    let (width_px, height_px) = (image.width_px, image.height_px);
    let rows = height_px - SIDE_PX..height_px;
    rows.flat_map(move |y| (width_px / 2..width_px / 2 + SIDE_PX).map(move |x| (y * width_px + x) as usize))
}

/// A picture with a bright patch.
fn with_patch(image: &Image, code: u8) -> Arc<Image> {
    let mut image = image.clone();
    for texel in patch(&image) {
        image.rgba8[4 * texel..4 * texel + 3].fill(code);
    }
    Arc::new(image)
}

/// Plates are relit from what was photographed: what was too bright for their codes comes back.
#[test]
fn plates_are_as_photographed_once_a_lamp_is_back() {
    const CODE: u8 = 250;
    let mut before = shot(vec![bulb(50.0, 30.0)]);
    let bright = shot(vec![Lamp::bulb(toward(60.0, 60.0), 0.01, 0.7)]);
    let plate = &mut before.scene.plates[0];
    plate.image = with_patch(&plate.image, CODE);
    let lamps = std::mem::take(&mut before.scene.lights);
    before.scene.uncertainty.camera = PoseUncertainty {
        position_m: Some(0.0),
        rotation_rad: Some(0.0),
    };
    let mut aligner = Aligner::new(before.scene.clone());
    let [_, moved, back] = [(&before, CODE), (&bright, u8::MAX), (&before, CODE)].map(|(shot, code)| {
        let image = with_patch(shot.input.image.rgba(), code);
        aligner.align(&shot.input.clone().with_image(image)).unwrap()
    });
    assert!(moved.report.is_relit, "{:?}", moved.report);
    assert!(off_deg(&lamps, &back) < 0.15, "{:?}", back.report);
    let relit = &aligner.scene().plates[0].image;
    let off_codes = patch(relit).map(|texel| CODE.abs_diff(relit.rgba8[4 * texel]));
    let most_off = off_codes.max().unwrap();
    assert!(most_off < 3, "{most_off} codes");
}
