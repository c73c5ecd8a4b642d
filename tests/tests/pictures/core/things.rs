//! Objects in the picture stay as the camera saw them, in front of the toy or behind it; a wrong
//! plate is not used.

use std::sync::Arc;

use app_core::Core;
use app_core::alignment::Observer;
use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::{Image, Scene};
use app_core::session::Session;
use app_core::sharpness::{Sharpness, Spread};
use app_core::things::{Front, MOST_PAINTED, Mark, RaisedPoint, Things};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::frame::{Thing, Warning};
use app_pipeline::readback::Map;
use glam::{DVec3, UVec2};
use harness::bundled_session;

use super::bundled::{core, first_input, picture_of, scene};

/// Pixels of the small picture: the first, and the one after the last.
type Rect = [UVec2; 2];

/// In the shadow, away from the toy.
const IN_SHADOW: Rect = [UVec2::new(95, 50), UVec2::new(123, 76)];
/// In the area that the toy covers in either pose, and parts of it.
const OVER_TOY: Rect = [UVec2::new(56, 40), UVec2::new(72, 56)];
const PAINTED: Rect = [UVec2::new(64, 40), UVec2::new(72, 56)];
/// Where the toy moves its head.
const AT_HEAD: Rect = [UVec2::new(44, 14), UVec2::new(64, 38)];

fn with(input: &FrameInput, marked: &[(Mark, Rect)]) -> FrameInput {
    let image = input.image.rgba();
    let size_px = UVec2::new(image.width_px, image.height_px);
    let mut marks = vec![Mark::None; size_px.element_product() as usize];
    for (mark, rect) in marked {
        for at in pixels(*rect) {
            marks[(at.y * size_px.x + at.x) as usize] = *mark;
        }
    }
    let things = Things::new(size_px, marks, input.camera).unwrap();
    input.clone().with_things(Some(things))
}

/// The part of a marked rectangle without its rim.
fn within([first, end]: Rect) -> Rect {
    [first + 1, end - 1]
}

fn pixels([first, end]: Rect) -> impl Iterator<Item = UVec2> {
    (first.y..end.y).flat_map(move |y| (first.x..end.x).map(move |x| UVec2::new(x, y)))
}

/// Largest difference of codes between a picture and the camera's, over a rectangle.
fn apart(picture: &[u8], input: &FrameInput, rect: Rect) -> u8 {
    let image = input.image.rgba();
    let codes = pixels(rect).flat_map(|at| {
        let index = 4 * (at.y * image.width_px + at.x) as usize;
        (index..index + 3).map(|index| picture[index].abs_diff(image.rgba8[index]))
    });
    codes.max().unwrap()
}

fn staged() -> (Scene, FrameInput) {
    (scene(), first_input())
}

#[test]
fn things_stay_as_the_camera_saw_them() {
    let (scene, input) = staged();
    let mut core = core();
    core.set_scene(scene, Preset::Balanced).unwrap();
    let without = picture_of(&mut core, &input);
    for rect in [IN_SHADOW, OVER_TOY] {
        assert!(apart(&without, &input, rect) > 10, "nothing changes in {rect:?}");
    }
    let marked = with(&input, &[(Mark::Thing, IN_SHADOW), (Mark::BeforeToy, OVER_TOY)]);
    let with_things = picture_of(&mut core, &marked);
    for rect in [IN_SHADOW, OVER_TOY] {
        assert_eq!(apart(&with_things, &input, within(rect)), 0, "{rect:?}");
        // A pixel at the rim shows in part what is behind the thing.
        let at_rim = apart(&with_things, &input, rect);
        assert!(at_rim > 5, "{at_rim} codes at the rim of {rect:?}");
    }
    // The toy is drawn over an object that is not in front of it.
    let behind = picture_of(&mut core, &with(&input, &[(Mark::Thing, OVER_TOY)]));
    assert!(apart(&behind, &input, OVER_TOY) > 10);
}

#[test]
fn the_toy_is_drawn_over_a_thing_that_is_lower_or_farther() {
    let (scene, input) = staged();
    let mut core = core();
    core.set_scene(scene, Preset::Balanced).unwrap();
    let marked = with(&input, &[(Mark::BeforeToy, AT_HEAD)]);
    let things = marked.things.clone().unwrap();
    let rect = within(within(AT_HEAD));
    let mut shown = |fronts: Vec<Front>| {
        let known = things.clone().with_fronts(fronts);
        let picture = picture_of(&mut core, &marked.clone().with_things(Some(known)));
        let is_changed = |at: &UVec2| apart(&picture, &input, [*at, *at + 1]) > 10;
        pixels(rect).filter(is_changed).count() as f32 / pixels(rect).count() as f32
    };
    let above = |top_m: f64| Front::at(top_m * DVec3::Y, DVec3::Y).unwrap();
    let parts = [1e-4, 0.105, 0.2].map(|top_m| shown(vec![above(top_m)]));
    // All of the toy is above a tenth of a millimetre, a part above 10.5 cm, nothing above 20; the camera is above that.
    assert!(
        parts[0] > 0.3 && (0.1..0.8).contains(&(parts[1] / parts[0])) && parts[2] == 0.0,
        "the toy is shown in {parts:.2?} of the thing's place"
    );
    // From a side, all of it is before what is 20 cm behind it, and nothing before what is 10 cm before it; what is
    // not before that may be above it.
    let toy = input.world_from_object.w_axis.truncate();
    let towards = (input.camera.world_from_camera.w_axis.truncate() - toy)
        .with_y(0.0)
        .normalize();
    let side = |before_m: f64| Front::at(toy + before_m * towards, towards).unwrap();
    let sides = [-0.2, 0.1].map(|before_m| shown(vec![side(before_m), above(0.2)]));
    assert_eq!(sides, [parts[0], 0.0]);
    assert_eq!(shown(vec![side(0.1), above(0.105)]), parts[1]);
}

/// At rest, a toy that is drawn over a low hand is where that hides it.
#[test]
fn a_low_hand_hides_the_resting_toy() {
    let session = bundled_session();
    let input = FrameInput::from(&session.frame(session.n_frames() - 1).unwrap());
    let mut image = Image::clone(input.image.rgba());
    // Fingers over the forelegs.
    for at in pixels([UVec2::new(222, 222), UVec2::new(292, 254)]) {
        let index = 4 * (at.y * image.width_px + at.x) as usize;
        image.rgba8[index..index + 3].copy_from_slice(&[190 + (at.x % 3) as u8, 120, 90]);
    }
    let input = input.with_image(Arc::new(image));
    let mut core = core();
    core.set_scene(session.scene().clone(), Preset::Balanced).unwrap();
    let things = Observer::default()
        .observed(session.scene(), &input)
        .unwrap()
        .things;
    let low = things.filter(|things| !things.fronts().is_empty()).unwrap();
    let pictures = [low.clone(), low.with_fronts(Vec::new())]
        .map(|things| picture_of(&mut core, &input.clone().with_things(Some(things))));
    let n_apart = (0..pictures[0].len())
        .filter(|at| pictures[0][*at].abs_diff(pictures[1][*at]) > 2)
        .count();
    assert_eq!(n_apart, 0, "of {} codes", pictures[0].len());
}

#[test]
fn a_shadow_moves_on_a_thing_whose_points_are_known() {
    let (scene, input) = staged();
    let mut core = core();
    core.set_scene(scene, Preset::Balanced).unwrap();
    let marked = with(&input, &[(Mark::Thing, IN_SHADOW), (Mark::BeforeToy, OVER_TOY)]);
    let things = marked.things.clone().unwrap();
    let n_pixels = things.marks().len();
    // A millimetre above the table nearly all of the table's shadow falls on it.
    for (of_lights, is_darker) in [(0.6, true), (0.0, false)] {
        let points = vec![RaisedPoint::new(1e-3, of_lights); n_pixels];
        let raised = things.clone().with_raised(points).unwrap();
        let picture = picture_of(&mut core, &marked.clone().with_things(Some(raised)));
        let changed = apart(&picture, &input, within(IN_SHADOW));
        assert_eq!(
            changed > 10,
            is_darker,
            "{changed} codes, {of_lights} of the lights"
        );
    }
    assert!(
        things
            .with_raised(vec![RaisedPoint::default(); n_pixels - 1])
            .is_none()
    );
}

#[test]
fn a_point_too_high_for_its_code_is_none() {
    let heights =
        [0.655, 0.656, 2.0, -0.1, f64::NAN].map(|height_m| RaisedPoint::new(height_m, 0.5).height());
    assert_eq!(heights, [65500, 0, 0, 0, 0]);
}

#[test]
fn a_scene_is_learned_anew_once_things_are_known() {
    let (scene, input) = staged();
    let marked = with(&input, &[(Mark::Thing, IN_SHADOW)]);
    let mut core = core();
    core.set_scene(scene.clone(), Preset::Balanced).unwrap();
    picture_of(&mut core, &input);
    let later = picture_of(&mut core, &marked);
    core.set_scene(scene, Preset::Balanced).unwrap();
    assert!(later == picture_of(&mut core, &marked));
}

#[test]
fn a_wrong_plate_is_estimated() {
    let (scene, input) = staged();
    let mut core = core();
    core.set_scene(scene, Preset::Balanced).unwrap();
    let report = core
        .frame(&with(&input, &[(Mark::WrongPlate, IN_SHADOW)]))
        .unwrap();
    assert!(report.warnings.contains(&Warning::Thing(Thing::InPlateAlone)));
    let origin_px = core.plan().unwrap().region.origin_px;
    let plate = core.read_map(Map::Plate).unwrap().unwrap();
    let is_in = |at: UVec2| at.cmpge(IN_SHADOW[0]).all() && at.cmplt(IN_SHADOW[1]).all();
    for (index, texel) in (0..).zip(&plate.texels) {
        let at = origin_px + UVec2::new(index % plate.width, index / plate.width);
        assert_eq!(texel[3] < 1.0, is_in(at), "{at}");
    }
}

/// The plate where the toy hides it and the place's pattern is known, beside its value in a picture that
/// is as soft from the first.
#[test]
fn a_completed_plate_keeps_its_light_as_the_focus_changes() {
    let (scene, input) = staged();
    let completed = Mark::completed_plate([0.5, 1.0, 2.0]).unwrap();
    let marked = with(&input, &[(completed, OVER_TOY)]);
    let as_soft_as = |deviation_px: f64| {
        let spread = Spread::round(deviation_px);
        marked.clone().with_sharpness(Sharpness {
            plate_spread: spread,
            outline_spread: spread,
        })
    };
    let mut core = core();
    let plate = |core: &mut Core, input: &FrameInput| {
        core.frame(input).unwrap();
        core.read_map(Map::Plate).unwrap().unwrap().texels
    };
    // The second picture is the first soft one of the view, which has no targets for it before.
    let softness = [0.0, 2.0, 0.0, 2.0];
    let fresh = softness.map(|deviation_px| {
        core.set_scene(scene.clone(), Preset::Balanced).unwrap();
        plate(&mut core, &as_soft_as(deviation_px))
    });
    core.set_scene(scene.clone(), Preset::Balanced).unwrap();
    for (deviation_px, fresh) in softness.into_iter().zip(&fresh) {
        let plate = plate(&mut core, &as_soft_as(deviation_px));
        let of_pattern = plate.iter().zip(fresh).filter(|(_, fresh)| fresh[3] < 1.0);
        let apart = of_pattern.flat_map(|(a, b)| (0..3).map(|channel| (a[channel] - b[channel]).abs()));
        let most = apart.fold(0.0, f32::max);
        assert!(most < 0.02, "{most} of light at a softness of {deviation_px} px");
    }
}

/// A thing that no plate shows, in this part of the most light that it can have, of 255.
fn painted(light: [u8; 3]) -> Mark {
    Mark::painted_thing(light.map(|light| MOST_PAINTED * f32::from(light) / 255.0)).unwrap()
}

#[test]
fn a_plate_gets_its_light() {
    let (scene, input) = staged();
    let mut core = core();
    core.set_scene(scene, Preset::Balanced).unwrap();
    // Near codes of their square roots.
    let left = [51, 103, 204];
    // All of the light as well, so that both plates have the same format.
    let maps = [[255; 3], left].map(|light| {
        let marked = [
            (Mark::ShadedPlate { left: light }, IN_SHADOW),
            (Mark::HiddenThing { light }, OVER_TOY),
            (painted(light), PAINTED),
        ];
        let report = core.frame(&with(&input, &marked)).unwrap();
        assert!(report.warnings.contains(&Warning::Thing(Thing::InPlateAlone)));
        core.read_map(Map::Plate).unwrap().unwrap()
    });
    let origin_px = core.plan().unwrap().region.origin_px;
    let is_in = |at: UVec2, [first, end]: Rect| at.cmpge(first).all() && at.cmplt(end).all();
    for (index, (before, after)) in (0..).zip(maps[0].texels.iter().zip(&maps[1].texels)) {
        let at = origin_px + UVec2::new(index % maps[0].width, index / maps[0].width);
        for channel in 0..3 {
            let light = f32::from(left[channel]) / 255.0;
            let factor = match [IN_SHADOW, OVER_TOY].map(|rect| is_in(at, rect)) {
                [true, _] => light.recip(),
                [_, true] => light,
                _ => 1.0,
            };
            let expected = factor * before[channel];
            let error = (after[channel] - expected).abs();
            assert!(
                error < 2e-3 * expected.max(0.5),
                "{at}: {} for {expected}",
                after[channel]
            );
        }
        assert_eq!(after[3], 1.0, "{at}");
    }
}
