//! A plate that shows the toy and its shadow, pushed aside.

use std::sync::{Arc, LazyLock};

use app_core::alignment::{Aligner, Observer};
use app_core::frame::FrameInput;
use app_core::scene::{Image, Scene};
use app_core::things::{Mark, Things};
use glam::IVec2;

use super::bundled::SESSION;

/// How far the toy is pushed, in pixels: so that it overlaps with itself, and so do its shadows.
const PUSHED_PX: IVec2 = IVec2::new(-14, 6);
/// Difference in codes from which on the picture shows the toy or its shadow.
const SHOWN_CODES: u8 = 8;
/// The same so far that the shadows are apart, and the corners of a black cloth in the shadow of the pushed
/// toy, and of a blue tile within it.
const FAR_PX: IVec2 = IVec2::new(-14, 50);
const BLACK: [IVec2; 2] = [IVec2::new(330, 260), IVec2::new(640, 360)];
const BLUE: [IVec2; 2] = [IVec2::new(368, 318), IVec2::new(410, 350)];
/// Colour of an even table, and the column about which the toy is mirrored.
const EVEN: [u8; 3] = [150, 140, 130];
const MIDDLE_COLUMN: i32 = 320;
/// Distance of pixels that are judged from the end of what is pushed.
const CLEAR_PX: i32 = 3;

fn index_of(image: &Image, at: IVec2) -> Option<usize> {
    let size_px = IVec2::new(image.width_px.cast_signed(), image.height_px.cast_signed());
    let is_inside = at.cmpge(IVec2::ZERO).all() && at.cmplt(size_px).all();
    usize::try_from(at.y * size_px.x + at.x)
        .ok()
        .filter(|_| is_inside)
}

fn texel(image: &Image, index: usize) -> [u8; 3] {
    [0, 1, 2].map(|channel| image.rgba8[4 * index + channel])
}

/// Whether the picture shows the toy or its shadow at a pixel.
fn is_shown(frame: &Image, plate: &Image, at: IVec2) -> bool {
    index_of(frame, at).is_some_and(|index| {
        let both = texel(frame, index).into_iter().zip(texel(plate, index));
        both.into_iter().any(|(a, b)| a.abs_diff(b) > SHOWN_CODES)
    })
}

fn places(image: &Image) -> impl Iterator<Item = IVec2> + use<> {
    let [width, height] = [image.width_px.cast_signed(), image.height_px.cast_signed()];
    (0..height).flat_map(move |y| (0..width).map(move |x| IVec2::new(x, y)))
}

/// The scene with such a plate; the colours at each place are changed.
fn pushed(by_px: IVec2, changed: impl Fn(IVec2, [u8; 3]) -> [u8; 3]) -> (Scene, FrameInput) {
    let (scene, input) = &*SESSION;
    let (frame, plate) = (input.image.rgba(), &scene.plates[0].image);
    let mut wrong = Image::clone(plate);
    let mut other = Image::clone(frame);
    for (index, at) in places(plate).enumerate() {
        let from = at - by_px;
        let color = match index_of(frame, from).filter(|_| is_shown(frame, plate, from)) {
            Some(from) => texel(frame, from),
            None => texel(plate, index),
        };
        wrong.rgba8[4 * index..4 * index + 3].copy_from_slice(&changed(at, color));
        other.rgba8[4 * index..4 * index + 3].copy_from_slice(&changed(at, texel(frame, index)));
    }
    let mut scene = Scene::clone(scene);
    scene.plates[0].image = Arc::new(wrong);
    (scene, FrameInput::clone(input).with_image(Arc::new(other)))
}

fn things_in(scene: &Scene, input: &FrameInput) -> Things {
    Observer::default()
        .observed(scene, input)
        .unwrap()
        .things
        .unwrap()
}

fn is_wrong(mark: Mark) -> bool {
    matches!(mark, Mark::WrongPlate | Mark::CompletedPlate { .. })
}

fn is_in([low, high]: [IVec2; 2], at: IVec2) -> bool {
    at.cmpge(low).all() && at.cmplt(high).all()
}

/// Of the pixels well within what is pushed so far, outside the toy and its own shadow, and in a rectangle if one
/// is given, the part that is marked as wrong.
fn marked(things: &Things, by_px: IVec2, within: Option<[IVec2; 2]>) -> f64 {
    let (scene, input) = &*SESSION;
    let (frame, plate) = (input.image.rgba(), &scene.plates[0].image);
    let is_pushed =
        |at: IVec2| is_shown(frame, plate, at - by_px) && within.is_none_or(|rect| is_in(rect, at));
    let (mut n, mut n_marked) = (0.0, 0.0);
    for (index, at) in places(plate).enumerate() {
        let reach = -CLEAR_PX..=CLEAR_PX;
        let mut around = reach
            .clone()
            .flat_map(|y| reach.clone().map(move |x| at + IVec2::new(x, y)));
        if around.all(|at| is_pushed(at) && !is_shown(frame, plate, at)) {
            n += 1.0;
            n_marked += f64::from(u8::from(is_wrong(things.marks()[index])));
        }
    }
    n_marked / n
}

/// An even table, in the plate with the toy and its shadow seen from their other side.
fn turned_on_an_even_table() -> (Scene, FrameInput) {
    let (scene, input) = &*SESSION;
    let (frame, plate) = (input.image.rgba(), &scene.plates[0].image);
    let mut even = Image::clone(frame);
    let mut wrong = Image::clone(frame);
    for (index, at) in places(plate).enumerate() {
        let color_at = |at: IVec2| match index_of(frame, at).filter(|_| is_shown(frame, plate, at)) {
            Some(index) => texel(frame, index),
            None => EVEN,
        };
        let mirrored = IVec2::new(2 * MIDDLE_COLUMN - at.x, at.y);
        even.rgba8[4 * index..4 * index + 3].copy_from_slice(&color_at(at));
        wrong.rgba8[4 * index..4 * index + 3].copy_from_slice(&color_at(mirrored));
    }
    let mut scene = Scene::clone(scene);
    scene.plates[0].image = Arc::new(wrong);
    (scene, FrameInput::clone(input).with_image(Arc::new(even)))
}

/// The toy is the table's only texture, and no camera explains most of it.
#[test]
fn a_camera_does_not_follow_a_toy_on_an_even_table() {
    let (scene, input) = turned_on_an_even_table();
    let camera = Aligner::new(scene).align(&input).unwrap().report.camera.unwrap();
    assert!(!camera.is_applied, "{camera:?}");
}

static PUSHED: LazyLock<(Scene, FrameInput)> = LazyLock::new(|| pushed(PUSHED_PX, |_, color| color));

#[test]
fn a_toy_is_seen_beside_itself_in_the_plate() {
    let (scene, input) = &*PUSHED;
    let aligned = Aligner::new(scene.clone()).align(input).unwrap();
    let pose = aligned.report.pose.unwrap();
    assert!(
        pose.outline_px < 0.5 && aligned.sharpness.outline_spread.mean_px() < 0.7,
        "{pose:?}, {:?}",
        aligned.sharpness
    );
}

#[test]
fn the_toys_shadow_in_the_plate_is_wrong() {
    let (scene, input) = &*PUSHED;
    let things = things_in(scene, input);
    let marked = marked(&things, PUSHED_PX, None);
    assert!(marked > 0.95, "{marked}");
}

/// In yellow light, blue tells nothing beside its noise; the other channels do.
#[test]
fn a_plate_without_blue_is_seen_to_be_wrong() {
    let (scene, input) = pushed(PUSHED_PX, |_, [red, green, blue]| [red, green, blue / 16]);
    let things = things_in(&scene, &input);
    let marked = marked(&things, PUSHED_PX, None);
    // Measured: .88, and .43 with all channels as noisy as the noisiest.
    assert!(marked > 0.8, "{marked}");
}

/// The shadow on a tile, which nothing else on the table resembles, is no thing of the tile's colour.
#[test]
fn the_toys_shadow_in_the_plate_is_wrong_on_another_tile() {
    let (scene, input) = pushed(FAR_PX, |at, color| {
        let [red, green, blue] = color;
        if is_in(BLUE, at) {
            [red / 2, green, blue.saturating_add(blue / 2)]
        } else if is_in(BLACK, at) {
            color.map(|code| code / 16)
        } else {
            color
        }
    });
    let things = things_in(&scene, &input);
    let marks = things.marks().iter();
    let n_others = marks.filter(|mark| **mark != Mark::None && !is_wrong(**mark));
    assert_eq!(n_others.count(), 0);
    let marked = marked(&things, FAR_PX, Some(BLUE));
    assert!(marked > 0.9, "{marked}");
}
