//! The changes in a frame determine which estimates are made anew, and nothing else does.

use std::sync::Arc;

use app_core::Core;
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::{Image, Light, Pose, Scene};
use app_core::sharpness::{Sharpness, Spread};
use app_core::toy::NodePose;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::Map;
use app_pipeline::readback::inject::InjectedVisibility;
use glam::{DMat4, DVec2, DVec3};
use harness::compare::Pair;

use crate::core::bundled::{core, first_input, picture_of, scene, whole};

#[test]
fn the_pose_as_authored_is_a_pose_like_any_other() {
    let mut core = core();
    let input = first_input();
    let posed = scene().with_physical_pose(input.shown_pose.clone());
    core.set_scene(posed, Preset::Balanced).unwrap();
    assert!(core.frame(&input).unwrap().region.is_none());
    assert!(
        core.frame(&input.with_shown_pose(Pose::Authored))
            .unwrap()
            .region
            .is_some()
    );
}

/// The frame at half of its codes.
fn dimmed(input: &FrameInput) -> FrameInput {
    let image = input.image.rgba();
    let pixels = image.rgba8.chunks_exact(4);
    let image = Arc::new(Image {
        rgba8: pixels.flat_map(|p| [p[0] / 2, p[1] / 2, p[2] / 2, 255]).collect(),
        ..image.as_ref().clone()
    });
    input.clone().with_image(image)
}

#[test]
fn a_paused_toy_looks_as_one_that_is_drawn_again() {
    let mut core = core();
    let first = first_input();
    let second = dimmed(&first);
    for preset in [Preset::Balanced, Preset::Paper] {
        let mut pictures = |is_drawn_again: bool| {
            core.set_scene(scene(), preset).unwrap();
            if is_drawn_again {
                core.draw_every_pose().unwrap();
            }
            [&first, &first, &second, &second, &first].map(|input| picture_of(&mut core, input))
        };
        let [kept, drawn] = [false, true].map(&mut pictures);
        assert!(kept == drawn, "{preset}");
        assert!(kept[1] != kept[2], "{preset}: the picture makes a difference");
    }
}

#[test]
fn the_toys_colours_are_those_of_the_latest_picture() {
    let mut core = core();
    let first = first_input();
    let second = dimmed(&first);
    let at_rest = second.clone().with_shown_pose(scene().physical_pose.clone());

    core.set_scene(scene(), Preset::Balanced).unwrap();
    core.frame(&first).unwrap();
    let expected = picture_of(&mut core, &second);

    core.set_scene(scene(), Preset::Balanced).unwrap();
    core.frame(&first).unwrap();
    core.frame(&at_rest).unwrap();
    assert!(picture_of(&mut core, &second) == expected);
}

/// The extent of the estimates that a frame makes anew.
#[derive(Debug, PartialEq)]
enum Learned {
    /// None.
    Nothing,
    /// The colours of a new picture.
    Picture,
    /// A new view of a known scene: fits are refined.
    View,
    /// All estimates.
    Scene,
}

/// The estimates that the core made from a frame.
fn learned(core: &mut Core, input: &FrameInput) -> Learned {
    let report = core.frame(input).unwrap();
    let n_runs = |pass: &str| -> u32 {
        let runs = report.ran.iter().filter(|run| run.pass == pass);
        runs.map(|run| run.n_runs).sum()
    };
    let plan = core.plan().unwrap();
    // The light on one receiver and on the toy is fitted; for a known scene, the intensities as
    // well.
    let fits = [
        2 * plan.n_fit_steps,
        2 * plan.n_refine_steps + plan.n_intensity_steps,
        plan.n_intensity_steps,
        0,
    ];
    let of_fits = [Learned::Scene, Learned::View, Learned::Picture, Learned::Nothing];
    let matching = fits.into_iter().zip(of_fits).find(|(n, _)| *n == n_runs("fit"));
    matching.map(|(_, learned)| learned).unwrap()
}

fn first_frame(core: &mut Core) -> FrameInput {
    core.set_scene(scene(), Preset::Balanced).unwrap();
    let input = first_input();
    assert_eq!(learned(core, &input), Learned::Scene);
    input
}

/// The picture of a frame by a core without previous frames.
fn fresh_picture(core: &mut Core, scene: Scene, input: &FrameInput) -> Image {
    core.set_scene(scene, Preset::Balanced).unwrap();
    core.frame(input).unwrap();
    core.read_picture().unwrap()
}

/// Root of the mean squared difference, of each pixel's worst channel, in codes.
fn rms([expected, actual]: [&Image; 2]) -> f64 {
    let difference = Pair { expected, actual }.difference().unwrap();
    let n_pixels = f64::from(u32::try_from(difference.per_texel.len()).unwrap());
    (difference.per_texel.iter().map(|d| d * d).sum::<f64>() / n_pixels).sqrt()
}

/// Measured: 0.05 if the frame was followed, since the region has another size; 6 and more if it
/// was not.
const MAX_RMS: f64 = 0.3;

#[test]
fn an_object_that_was_moved_is_learned_anew_where_it_stands() {
    let mut core = core();
    let first = first_frame(&mut core);
    let turned = |degrees: f64| {
        first
            .clone()
            .with_world_from_object(first.world_from_object * DMat4::from_rotation_y(degrees.to_radians()))
    };
    // For a toy of some 15 cm, 40 cm away, 0.1 px are some 0.07 mm.
    assert_eq!(learned(&mut core, &turned(0.005)), Learned::Nothing);
    let wrong = turned(10.0);
    assert_eq!(learned(&mut core, &wrong), Learned::Scene);
    let not_followed = core.read_picture().unwrap();
    assert_eq!(learned(&mut core, &wrong), Learned::Nothing);
    // The photograph shows the toy at its first position.
    assert_eq!(learned(&mut core, &first), Learned::Scene);
    let followed = core.read_picture().unwrap();
    let fresh = fresh_picture(&mut core, scene(), &first);
    let (followed, not_followed) = (rms([&fresh, &followed]), rms([&fresh, &not_followed]));
    assert!(
        followed < MAX_RMS && not_followed > 10.0 * MAX_RMS,
        "followed {followed}, not followed {not_followed}"
    );
}

/// A toy that is larger and equally farther away looks the same, but its shadow does not.
#[test]
fn motion_that_only_the_shadow_shows_is_learned_from() {
    let mut core = core();
    let first = first_frame(&mut core);
    let camera = first.camera.world_from_camera.w_axis.truncate();
    let farther = DMat4::from_translation(camera)
        * DMat4::from_scale(DVec3::splat(1.02))
        * DMat4::from_translation(-camera);
    let world_from_object = farther * first.world_from_object;
    let moved = first.with_world_from_object(world_from_object);
    assert_eq!(learned(&mut core, &moved), Learned::Scene);
}

#[test]
fn the_baseline_follows_a_number_of_lights() {
    let mut core = core();
    let (scene, first) = (scene(), first_input());
    let aside = Light::Sphere {
        position_in_world: DVec3::new(0.5, 0.6, 0.4),
        radius_m: 0.01,
    };
    let lights = vec![scene.lights[0], aside];
    let lit = first.clone().with_lights(Some(lights.as_slice().into()));
    core.set_scene(scene.clone(), Preset::Paper).unwrap();
    core.frame(&first).unwrap();
    core.frame(&lit).unwrap();
    let followed = core.read_picture().unwrap();
    core.set_scene(scene.with_lights(lights), Preset::Paper).unwrap();
    core.frame(&first).unwrap();
    let fresh = core.read_picture().unwrap();
    let followed = rms([&fresh, &followed]);
    assert!(followed < MAX_RMS, "{followed}");
}

#[test]
fn lights_that_a_frame_brings_are_learned_under() {
    let mut core = core();
    let first = first_frame(&mut core);
    let lit_by = |lights: &[Light]| first.clone().with_lights(Some(lights.into()));
    let scene = scene();
    let Light::Sphere {
        position_in_world,
        radius_m,
    } = scene.lights[0]
    else {
        panic!("the bundled session has a bulb");
    };
    assert_eq!(learned(&mut core, &lit_by(&scene.lights)), Learned::Nothing);
    let aside = Light::Sphere {
        position_in_world: position_in_world + DVec3::new(0.0, 0.0, 0.2),
        radius_m,
    };
    let below = Light::Sphere {
        position_in_world: DVec3::new(0.0, -1.0, 0.0),
        radius_m,
    };
    for lights in [vec![aside], vec![below, scene.lights[0], aside]] {
        let input = lit_by(&lights);
        assert_eq!(learned(&mut core, &input), Learned::Scene);
        assert_eq!(learned(&mut core, &input), Learned::Nothing);
        let scene = scene.clone().with_lights(lights);
        let followed = core.read_picture().unwrap();
        let followed = rms([&fresh_picture(&mut core, scene, &input), &followed]);
        assert!(followed < MAX_RMS, "{followed}");
    }
}

#[test]
fn a_focal_length_that_toggles_is_another_view_of_the_same_scene() {
    let mut core = core();
    let first = first_frame(&mut core);
    let mut zoomed = first.clone();
    zoomed.camera.intrinsics.fx_px += 0.5;
    zoomed.camera.intrinsics.fy_px += 0.5;
    assert_eq!(learned(&mut core, &zoomed), Learned::View);
    zoomed.camera.intrinsics.fx_px += 1e-3;
    assert_eq!(learned(&mut core, &zoomed), Learned::Nothing);
    assert_eq!(learned(&mut core, &first), Learned::View);
}

fn as_soft_as(input: &FrameInput, deviation_px: f64) -> FrameInput {
    input.clone().with_sharpness(Sharpness {
        plate_spread: Spread::round(deviation_px),
        outline_spread: Spread::round(deviation_px),
    })
}

/// The picture is as sharp as its pixels, however small the measured blur is.
#[test]
fn a_softness_that_is_not_seen_changes_nothing() {
    let mut core = core();
    let first = first_input();
    let sharp = fresh_picture(&mut core, scene(), &first);
    assert!(fresh_picture(&mut core, scene(), &as_soft_as(&first, 0.29)) == sharp);
    assert!(fresh_picture(&mut core, scene(), &as_soft_as(&first, 1.0)) != sharp);
    for preset in [Preset::Paper, Preset::Flat] {
        let mut published = |input: &FrameInput| {
            core.set_scene(scene(), preset).unwrap();
            picture_of(&mut core, input)
        };
        assert!(
            published(&first) == published(&as_soft_as(&first, 2.0)),
            "{preset}"
        );
        // Nor is anything drawn again.
        let report = core.frame(&as_soft_as(&first, 3.0)).unwrap();
        assert!(report.ran.is_empty(), "{preset}: {:?}", report.ran);
    }
}

#[test]
fn a_focus_that_breathes_is_no_new_scene() {
    let maps = |core: &Core| {
        let maps = [
            Map::Plate,
            Map::Validity,
            Map::PhysicalVisibility,
            Map::Visibility,
            Map::Coverage,
        ];
        maps.map(|map| core.read_map(map).unwrap().unwrap())
    };
    let mut core = core();
    let first = first_frame(&mut core);
    let of_softness = [1.4, 2.6, 0.0, 2.0].map(|deviation_px| {
        let input = as_soft_as(&first, deviation_px);
        fresh_picture(&mut core, scene(), &input);
        (input, maps(&core))
    });
    first_frame(&mut core);
    // The passes for softness have no targets yet.
    assert_eq!(learned(&mut core, &as_soft_as(&first, 2.0)), Learned::View);
    assert_eq!(learned(&mut core, &as_soft_as(&first, 2.05)), Learned::Nothing);
    for (input, fresh) in &of_softness {
        assert_eq!(learned(&mut core, input), Learned::Picture);
        assert!(maps(&core) == *fresh, "{:?}", input.sharpness);
    }
}

/// The colours of a soft picture are mixed in the light of that picture, whose lamps may have been
/// dimmed since an earlier one: they are unmixed anew in every second picture.
#[test]
fn a_soft_picture_is_unmixed_in_its_own_light() {
    let mut core = core();
    let first = as_soft_as(&first_frame(&mut core), 2.0);
    let mut is_unmixed = |input: &FrameInput| {
        let report = core.frame(input).unwrap();
        report.ran.iter().any(|run| run.pass == "unmix")
    };
    assert!(is_unmixed(&first));
    let later = [0; 4].map(|_| is_unmixed(&dimmed(&first)));
    assert!(later == [true, false, true, false] || later == [false, true, false, true]);
}

/// A small part of the variance changes, but edges along the motion become soft.
#[test]
fn a_blur_that_grows_across_a_motion_is_followed() {
    let mut core = core();
    let first = first_frame(&mut core);
    let with_width = |across_px: f64| {
        let spread = Spread {
            yy_px2: across_px * across_px,
            ..Spread::of_motion(DVec2::new(13.0, 0.0))
        };
        first.clone().with_sharpness(Sharpness {
            plate_spread: spread,
            outline_spread: spread,
        })
    };
    assert_eq!(learned(&mut core, &with_width(0.0)), Learned::View);
    assert_eq!(learned(&mut core, &with_width(0.2)), Learned::Nothing);
    assert_eq!(learned(&mut core, &with_width(0.8)), Learned::Picture);
}

#[test]
fn an_exposure_that_is_told_stands_where_no_pixel_tells_it() {
    let mut core = core();
    let first = first_frame(&mut core);
    let gain = |core: &Core| core.read_fit().unwrap().unwrap().gain[0];
    let before = gain(&core);
    let white = Image {
        rgba8: vec![255; first.image.rgba().rgba8.len()],
        ..first.image.rgba().as_ref().clone()
    };
    let overexposed = first.clone().with_image(white.clone()).with_exposure(2.0);
    assert_eq!(learned(&mut core, &overexposed), Learned::Picture);
    let doubled = gain(&core) / before;
    assert!((doubled - 2.0).abs() < 1e-5, "{doubled}");
    let again = |exposure: f64| {
        overexposed
            .clone()
            .with_image(white.clone())
            .with_exposure(exposure)
    };
    let still = again(2.0);
    assert_eq!(learned(&mut core, &still), Learned::Picture);
    assert!(
        (gain(&core) / before - doubled).abs() < 1e-5,
        "the exposure stayed"
    );
    // The exposure of a picture that was already used arrives late: it counts from the next picture
    // on.
    let late = still.with_exposure(4.0);
    assert_eq!(learned(&mut core, &late), Learned::Nothing);
    assert_eq!(learned(&mut core, &again(4.0)), Learned::Picture);
    assert!(
        (gain(&core) / before - 4.0).abs() < 1e-4,
        "{}",
        gain(&core) / before
    );
}

/// A scene and a frame whose toy fills a small part of the picture; all other pixels show the
/// plate.
fn from_afar() -> (Scene, FrameInput) {
    let (mut scene, mut input) = whole();
    let cameras = scene.plates.iter_mut().map(|plate| &mut plate.camera);
    for camera in cameras.chain([&mut input.camera]) {
        camera.intrinsics.fx_px *= 0.3;
        camera.intrinsics.fy_px *= 0.3;
    }
    input.image = Arc::clone(&scene.plates[0].image).into();
    (scene, input)
}

/// The region is that of the previous poses; a pose that reaches farther is not cut off.
#[test]
fn the_region_grows_with_a_pose_that_reaches_beyond_it() {
    let mut core = core();
    let (scene, first) = from_afar();
    let toy = Arc::clone(&scene.toy);
    let root = toy.find_node("root").unwrap();
    let lifted = |height_m: f64| {
        let mut trs = toy.authored_transform(root).unwrap().unwrap();
        trs.translation.y += height_m;
        first.clone().with_shown_pose(Pose::Nodes(Arc::new(NodePose {
            parent_from_node: vec![(root, trs)],
            ..NodePose::default()
        })))
    };
    core.set_scene(scene.clone(), Preset::Balanced).unwrap();
    let mut before = core.frame(&lifted(0.0)).unwrap().region.unwrap();
    // Far beyond the grids over the receivers, their estimates are no longer usable.
    for (height_m, expected) in [(0.012, Learned::View), (0.08, Learned::Scene)] {
        let high = lifted(height_m);
        assert_eq!(learned(&mut core, &high), expected);
        let after = core.frame(&high).unwrap().region.unwrap();
        assert_ne!(after, before, "{height_m} m");
        before = after;
    }
    let followed = core.read_picture().unwrap();
    let fresh = fresh_picture(&mut core, scene, &lifted(0.08));
    let followed = rms([&fresh, &followed]);
    assert!(followed < MAX_RMS, "{followed}");
}

/// Injected maps belong to one view: the next view continues from the estimates, and so does the
/// one after it.
#[test]
fn views_after_an_injection_forget_nothing() {
    let mut core = core();
    let first = first_frame(&mut core);
    let own = core.read_map(Map::Visibility).unwrap();
    core.inject_visibility(&InjectedVisibility {
        physical: None,
        shown: own,
    })
    .unwrap();
    let beside = |x_m: f64| {
        let mut input = first.clone();
        input.camera.world_from_camera.w_axis.x += x_m;
        input
    };
    for x_m in [0.001, 0.002, 0.003] {
        assert_eq!(learned(&mut core, &beside(x_m)), Learned::View, "{x_m} m");
    }
}
