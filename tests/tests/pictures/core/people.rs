//! People in the picture, by a platform's mask: they stay as the camera saw them, and the toy goes
//! behind those that cover it.

use app_core::depth::Depth;
use app_core::frame::FrameInput;
use app_core::people::People;
use app_core::preset::Preset;
use app_pipeline::frame::{Thing, Warning};
use app_pipeline::plan::Change;
use glam::UVec2;

use super::bundled::{core, first_input, picture_of, scene};

/// Pixels of the small picture: the first, and the one after the last.
type Rect = [UVec2; 2];

/// In the shadow, away from the toy.
const IN_SHADOW: Rect = [UVec2::new(96, 50), UVec2::new(122, 76)];
/// In the area that the toy covers in either pose.
const OVER_TOY: Rect = [UVec2::new(56, 40), UVec2::new(72, 56)];

/// A mask of half the picture's resolution.
fn mask(input: &FrameInput, rects: &[Rect]) -> People {
    let [width, height] = input.image.size_px();
    let size_px = UVec2::new(width, height) / 2;
    let is_in = |at: UVec2| {
        let mut rects = rects.iter();
        rects.any(|[first, end]| at.cmpge(*first / 2).all() && at.cmplt(*end / 2).all())
    };
    let pixels = (0..size_px.y).flat_map(|y| (0..size_px.x).map(move |x| UVec2::new(x, y)));
    let codes: Vec<u8> = pixels.map(|at| 255 * u8::from(is_in(at))).collect();
    People::new(size_px, codes).unwrap()
}

fn with(input: &FrameInput, rects: &[Rect]) -> FrameInput {
    input.clone().with_people(Some(mask(input, rects)))
}

/// Largest difference of codes between a picture and the camera's, within a rectangle.
fn apart(picture: &[u8], input: &FrameInput, [first, end]: Rect) -> u8 {
    let image = input.image.rgba();
    let pixels = (first.y..end.y).flat_map(|y| (first.x..end.x).map(move |x| (x, y)));
    let codes = pixels.flat_map(|(x, y)| {
        let index = 4 * (y * image.width_px + x) as usize;
        (index..index + 3).map(|index| picture[index].abs_diff(image.rgba8[index]))
    });
    codes.max().unwrap()
}

#[test]
fn people_stay_as_the_camera_saw_them_and_hide_the_toy_that_they_cover() {
    let input = first_input();
    let mut core = core();
    core.set_scene(scene(), Preset::Balanced).unwrap();
    let without = picture_of(&mut core, &input);
    for rect in [IN_SHADOW, OVER_TOY] {
        assert!(apart(&without, &input, rect) > 10, "nothing changes in {rect:?}");
    }
    let with_people = picture_of(&mut core, &with(&input, &[IN_SHADOW, OVER_TOY]));
    for [first, end] in [IN_SHADOW, OVER_TOY] {
        // A pixel at the rim shows in part what is behind the person.
        let within = [first + 1, end - 1];
        assert_eq!(apart(&with_people, &input, within), 0, "{within:?}");
    }
    let report = core.frame(&with(&input, &[OVER_TOY])).unwrap();
    assert!(report.warnings.contains(&Warning::Thing(Thing::BeforeToy)));
    let report = core.frame(&with(&input, &[IN_SHADOW])).unwrap();
    assert!(report.warnings.contains(&Warning::Thing(Thing::OnReceiver)));
}

#[test]
fn a_mask_or_depths_of_another_shape_are_refused() {
    let input = first_input();
    let mut core = core();
    core.set_scene(scene(), Preset::Balanced).unwrap();
    let [width_px, height_px] = input.image.size_px();
    for (size_px, is_alike) in [
        ([width_px / 4, height_px / 4], true),
        ([height_px, width_px], false),
        ([width_px / 4, height_px / 8], false),
    ] {
        let n_pixels = (size_px[0] * size_px[1]) as usize;
        let people = People::new(size_px.into(), vec![0; n_pixels]);
        let depth = Depth::new(size_px.into(), vec![300; n_pixels]);
        let inputs = [
            ("people: ", input.clone().with_people(people)),
            ("depth: ", input.clone().with_depth(depth)),
        ];
        for (field, input) in inputs {
            let refused = core.frame(&input).err().map(|error| error.to_string());
            let is_refused = refused.as_ref().is_some_and(|refused| {
                refused.contains(field) && refused.contains("not the shape of the picture")
            });
            assert_eq!(is_refused, !is_alike, "{field}{size_px:?}: {refused:?}");
            assert_eq!(refused.is_none(), is_alike, "{refused:?}");
        }
    }
}

/// A platform delivers a mask with each picture.
#[test]
fn an_equal_mask_costs_nothing() {
    let input = first_input();
    let mut core = core();
    core.set_scene(scene(), Preset::Balanced).unwrap();
    core.frame(&with(&input, &[OVER_TOY])).unwrap();
    let report = core.frame(&with(&input, &[OVER_TOY])).unwrap();
    assert_eq!(report.change, Some(Change::Pose));
    let report = core.frame(&with(&input, &[IN_SHADOW])).unwrap();
    assert_eq!(report.change, Some(Change::View), "the person has moved");
}
