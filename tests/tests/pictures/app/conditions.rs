//! Conditions of the pictures while the toy moves: their focus, their noise, and a hand in them.

use app_core::app::{Show, Step};
use app_core::frame::FrameInput;
use app_core::scene::Image;
use app_core::things::Mark;
use image::RgbaImage;
use image::imageops::blur;
use measure::random::Random;

use crate::app::way::{OFF_M, Person, placed};

fn playing() -> Person {
    let mut person = placed(OFF_M);
    person.frames(1);
    assert_eq!(person.app.step(), Step::Play, "{:?}", person.app.verdict());
    person.frames(20);
    person
}

fn shown(person: &Person) -> FrameInput {
    let Show::Toy { input, .. } = person.app.show() else {
        panic!("{:?}", person.app.step());
    };
    *input
}

/// Out of focus by a Gaussian of two pixels.
fn defocused(image: &Image) -> Image {
    let [width, height] = [image.width_px, image.height_px];
    let sharp = RgbaImage::from_raw(width, height, image.rgba8.clone()).unwrap();
    Image {
        rgba8: blur(&sharp, 2.0).into_raw(),
        ..image.clone()
    }
}

/// With noise of six codes.
fn noisy(image: &Image) -> Image {
    let mut image = image.clone();
    let mut random = Random::new(3);
    for pixel in image.rgba8.chunks_exact_mut(4) {
        for code in &mut pixel[..3] {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
            let noisy = (f64::from(*code) + 6.0 * random.normal())
                .round()
                .clamp(0.0, 255.0) as u8;
            *code = noisy;
        }
    }
    image
}

#[test]
fn a_picture_out_of_focus_is_drawn_out_of_focus_and_one_with_noise_gets_its_grain() {
    let mut person = playing();
    let sharp = shown(&person);
    assert!(
        sharp.sharpness.outline_spread.widest_px() < 0.5,
        "{:?}",
        sharp.sharpness
    );
    assert!(sharp.grain.is_none(), "{:?}", sharp.grain);
    // Until the next alignment.
    person.retouch = Some(Box::new(defocused));
    person.frames(32);
    let soft = shown(&person).sharpness;
    let spread_px = soft.plate_spread.widest_px();
    assert!((spread_px - 2.0).abs() < 0.3, "{soft:?}");
    assert!((soft.outline_spread.widest_px() - 2.0).abs() < 0.4, "{soft:?}");
    person.retouch = None;
    person.frames(4);
    assert_eq!(
        shown(&person).sharpness,
        soft,
        "it is held until the next alignment"
    );
    person.frames(32);
    assert!(shown(&person).sharpness.plate_spread.widest_px() < 0.5);
    person.retouch = Some(Box::new(noisy));
    person.frames(32);
    let grain = shown(&person).grain.expect("grain");
    // Six codes of a mid grey, in linear light.
    let codes = grain.frame.variance(0.2).sqrt() / (f64::from(linear_per_code(0.2)));
    assert!((codes - 6.0).abs() < 1.2, "{codes}");
    person.retouch = None;
    person.frames(32);
    assert!(shown(&person).grain.is_some(), "one clean picture is ignored");
    person.frames(32);
    assert!(shown(&person).grain.is_none());
}

/// Linear light per code.
fn linear_per_code(light: f32) -> f32 {
    app_scene::geometry::color::linear_per_srgb(light) / 255.0
}

/// The marked share of a rectangle of the picture, and the number of marks beyond it over its size.
fn marked(input: &FrameInput, [left, top, right, bottom]: [u32; 4]) -> [f64; 2] {
    let Some(things) = &input.things else {
        return [0.0; 2];
    };
    let width_px = things.size_px().x;
    let is_in = |index: u32| {
        let (x, y) = (index % width_px, index / width_px);
        (left..right).contains(&x) && (top..bottom).contains(&y)
    };
    let marks = (0..).zip(things.marks());
    let marks = marks.filter(|(_, mark)| **mark != Mark::None);
    let (inside, beyond): (Vec<_>, Vec<_>) = marks.partition(|(index, _)| is_in(*index));
    let size = f64::from((right - left) * (bottom - top));
    [inside.len() as f64 / size, beyond.len() as f64 / size]
}

fn with_hand(image: &Image, [left, top, right, bottom]: [u32; 4]) -> Image {
    let mut image = image.clone();
    for y in top..bottom {
        for x in left..right {
            let first = 4 * (y * image.width_px + x) as usize;
            let grain = ((7 * x + 13 * y) % 5) as u8;
            for (code, skin) in image.rgba8[first..first + 3].iter_mut().zip([20, 120, 130]) {
                *code = skin + grain;
            }
        }
    }
    image
}

/// An alignment runs once a second: without searches in between, marks would lag.
#[test]
fn marks_follow_a_hand_within_a_part_of_a_second_and_none_stays() {
    let mut person = playing();
    // The first search follows an alignment.
    person.frames(32);
    for left in [500, 440, 380] {
        let hand = [left, 190, left + 110, 290];
        person.retouch = Some(Box::new(move |image| with_hand(image, hand)));
        person.frames(7);
        let [of_it, beyond] = marked(&shown(&person), hand);
        assert!(
            of_it > 0.9 && beyond < 0.1,
            "at {left}: {of_it:.2} of it, {beyond:.2} beyond"
        );
    }
    person.retouch = None;
    person.frames(7);
    let things = shown(&person).things;
    assert!(things.is_none_or(|things| !things.has_any()));
}
