//! A plate that shows something else behind the toy, on a checked table.

use std::sync::Arc;

use app_core::alignment::Observer;
use app_core::frame::FrameInput;
use app_core::scene::{Image, Scene};
use app_core::session::GroundTruth;
use app_core::things::{MOST_COMPLETED, Mark, Things};
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};
use glam::{DVec2, UVec2, Vec3Swizzles};
use harness::bundled_session;

use super::bundled::SESSION;

/// What the plate alone shows: its first pixel, and the one after its last. It is half beside the toy, half behind it.
const RECT: [UVec2; 2] = [UVec2::new(170, 130), UVec2::new(240, 230)];
const COLOR: [u8; 3] = [20, 120, 130];
/// Side of the table's squares, and the light of every second one.
const SQUARE_M: f64 = 0.02;
const DARK: [f32; 3] = [0.35, 0.5, 0.9];
/// Margin around the rectangle in pixels that may be marked: two pixels of a picture half as large, twice.
const MARGIN_PX: u32 = 8;

/// Whether each pixel shows the toy.
fn toy() -> Vec<bool> {
    let labels = bundled_session().truth(0).unwrap().unwrap().mask;
    labels.rgba8.chunks_exact(4).map(|label| label[1] > 0).collect()
}

fn place_of(index: usize, image: &Image) -> UVec2 {
    let index = u32::try_from(index).unwrap();
    UVec2::new(index % image.width_px, index / image.width_px)
}

/// Whether a square of the table is dark.
type IsDark = fn(DVec2) -> bool;

fn checked(square: DVec2) -> bool {
    (square.x + square.y).rem_euclid(2.0) == 0.0
}

/// Squares that do not repeat.
fn random(square: DVec2) -> bool {
    (square.dot(DVec2::new(12.9898, 78.233)).sin() * 43758.5453).rem_euclid(1.0) < 0.5
}

/// The picture of a table of such squares, where it shows the table.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
fn painted(
    image: &Image,
    input: &FrameInput,
    (is_dark, is_table): (IsDark, &dyn Fn(usize) -> bool),
) -> Image {
    let camera = &input.camera;
    let eye = camera.world_from_camera.w_axis.truncate();
    let mut image = image.clone();
    for index in (0..image.rgba8.len() / 4).filter(|index| is_table(*index)) {
        let ray = camera.intrinsics.ray(place_of(index, &image).as_dvec2() + 0.5);
        let ray = camera.world_from_camera.transform_vector3(ray);
        let square = ((eye - eye.y / ray.y * ray).xz() / SQUARE_M).floor();
        if is_dark(square) {
            for (code, dark) in image.rgba8[4 * index..4 * index + 3].iter_mut().zip(DARK) {
                let light = dark * linear_from_srgb(f32::from(*code) / 255.0);
                *code = (255.0 * srgb_from_linear(light)).round() as u8;
            }
        }
    }
    image
}

/// A code of what the plate alone shows: not of one code, as no object is.
fn plate_code(at: UVec2, channel: usize) -> u8 {
    COLOR[channel] + ((7 * at.x + 13 * at.y) % 5) as u8
}

fn is_in([first, end]: [UVec2; 2], at: UVec2) -> bool {
    at.cmpge(first).all() && at.cmplt(end).all()
}

/// The table's things, and its plate without anything else.
fn found(toy: &[bool], is_dark: IsDark) -> (Things, Image) {
    let (scene, input) = &*SESSION;
    let mut scene = Scene::clone(scene);
    let clean = painted(&scene.plates[0].image, input, (is_dark, &|_| true));
    let mut plate = clean.clone();
    for index in 0..toy.len() {
        let at = place_of(index, &plate);
        if is_in(RECT, at) {
            let color = [0, 1, 2].map(|channel| plate_code(at, channel));
            plate.rgba8[4 * index..4 * index + 3].copy_from_slice(&color);
        }
    }
    scene.plates[0].image = Arc::new(plate);
    let frame = painted(input.image.rgba(), input, (is_dark, &|index| !toy[index]));
    let input = FrameInput::clone(input).with_image(Arc::new(frame));
    let things = Observer::default().observed(&scene, &input).unwrap().things;
    (things.unwrap(), clean)
}

/// Indices of the toy's pixels within a rectangle, or outside it.
fn hidden(toy: &[bool], rect: [UVec2; 2], image: &Image, is_within: bool) -> Vec<usize> {
    let is_of = |index: &usize| toy[*index] && is_in(rect, place_of(*index, image)) == is_within;
    (0..toy.len()).filter(is_of).collect()
}

#[test]
fn the_plate_behind_the_toy_stays_where_it_shows_the_place() {
    let toy = toy();
    let (things, clean) = found(&toy, checked);
    let is_wrong = |index: &&usize| {
        let mark = things.marks()[**index];
        matches!(mark, Mark::WrongPlate | Mark::CompletedPlate { .. })
    };
    let near = [RECT[0] - MARGIN_PX, RECT[1] + MARGIN_PX];
    let [within, beyond] = [(RECT, true), (near, false)].map(|(rect, is)| hidden(&toy, rect, &clean, is));
    let [n_within, n_beyond] = [&within, &beyond].map(|pixels| pixels.iter().filter(is_wrong).count());
    assert!(
        100 * n_within > 98 * within.len() && 20 * n_beyond < within.len(),
        "{n_within} of {} pixels, and {n_beyond} beyond",
        within.len()
    );
}

/// The codes of completed pixels among some, as found and as they are.
fn completed(things: &Things, clean: &Image, within: &[usize]) -> [Vec<f32>; 2] {
    let (mut found, mut right) = (Vec::new(), Vec::new());
    for index in within {
        let Mark::CompletedPlate { light } = things.marks()[*index] else {
            continue;
        };
        let at = place_of(*index, clean);
        for channel in 0..3 {
            let light = MOST_COMPLETED * (f32::from(light[channel]) / 255.0).powi(2);
            let wrong = linear_from_srgb(f32::from(plate_code(at, channel)) / 255.0);
            found.push(255.0 * srgb_from_linear(light * wrong));
            right.push(f32::from(clean.rgba8[4 * index + channel]));
        }
    }
    [found, right]
}

#[test]
fn a_checked_table_continues_where_nothing_shows_it() {
    let toy = toy();
    let (things, clean) = found(&toy, checked);
    let within = hidden(&toy, RECT, &clean, true);
    let [found, right] = completed(&things, &clean, &within);
    let means = [0, 1, 2].map(|channel| {
        let of_channel = right.iter().skip(channel).step_by(3);
        of_channel.sum::<f32>() / within.len() as f32
    });
    let of_one_color = deviation(means.into_iter().cycle(), &right);
    let left = deviation(found.iter().copied(), &right) / of_one_color;
    // Measured: .46, of which most is the wood below the squares.
    assert!(
        right.len() == 3 * within.len() && left < 0.5,
        "{} of {} values, {left:.2} of {of_one_color:.1} codes are left",
        right.len(),
        3 * within.len()
    );
}

fn deviation(found: impl Iterator<Item = f32>, right: &[f32]) -> f32 {
    let squares = found.zip(right).map(|(found, right)| (found - right).powi(2));
    (squares.sum::<f32>() / right.len() as f32).sqrt()
}

#[test]
fn a_table_that_does_not_repeat_continues_in_its_mean_color() {
    let toy = toy();
    let (things, clean) = found(&toy, random);
    let within = hidden(&toy, RECT, &clean, true);
    let [found, right] = completed(&things, &clean, &within);
    let mean = |codes: &[f32], channel| {
        let of_channel = codes.iter().skip(channel).step_by(3);
        of_channel.sum::<f32>() / within.len() as f32
    };
    let apart = [0, 1, 2].map(|channel| (mean(&found, channel) - mean(&right, channel)).abs());
    assert!(
        10 * found.len() > 29 * within.len() && apart.iter().all(|apart| *apart < 20.0),
        "{} of {} values, {apart:?} codes apart",
        found.len(),
        3 * within.len()
    );
}
