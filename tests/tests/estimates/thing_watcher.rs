//! The search for things picture after picture: marks follow a hand, none stays when it has left,
//! and none flickers.

use std::sync::Arc;

use app_core::alignment::{Aligner, Conditions, Observer, ThingWatcher, Watched};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Image, Scene};
use app_core::things::{Mark, Things};
use glam::{DMat4, UVec2};
use measure::random::Random;

use super::bundled::{SESSION, middle};

/// A rectangle of the bundled picture: its first pixel, and the one after its last.
type Rect = [UVec2; 2];

/// In the shadow, away from the toy.
const IN_SHADOW: Rect = [UVec2::new(365, 220), UVec2::new(415, 262)];
const TEAL: [u8; 3] = [20, 120, 130];

/// A hand on the table, whose left end is at a column.
fn hand(left_px: u32) -> Rect {
    [UVec2::new(left_px, 190), UVec2::new(left_px + 110, 290)]
}

fn pixels([first, end]: Rect) -> impl Iterator<Item = UVec2> {
    (first.y..end.y).flat_map(move |y| (first.x..end.x).map(move |x| UVec2::new(x, y)))
}

fn painted(image: &Image, rect: Rect) -> Image {
    let mut image = image.clone();
    for at in pixels(rect) {
        let first = 4 * (at.y * image.width_px + at.x) as usize;
        // Not of one code, as no object is.
        let grain = ((7 * at.x + 13 * at.y) % 5) as u8;
        for (code, color) in image.rgba8[first..first + 3].iter_mut().zip(TEAL) {
            *code = color + grain;
        }
    }
    image
}

/// Share of a rectangle that is marked as a thing, and the number of marked pixels beyond it over
/// its size.
fn marked(things: Option<&Things>, rect: Rect) -> [f64; 2] {
    let Some(things) = things else { return [0.0; 2] };
    let of_it = pixels(rect).filter(|at| {
        let index = (at.y * things.size_px().x + at.x) as usize;
        things.marks()[index] != Mark::None
    });
    let (n_in, n_marks) = (of_it.count(), things.marks().len() - things.count(Mark::None));
    let [first, end] = rect;
    let size = f64::from((end - first).element_product());
    [n_in as f64 / size, (n_marks - n_in) as f64 / size]
}

/// The conditions of the bundled session and its aligned frame.
fn aligned() -> (Conditions, FrameInput) {
    let (scene, input) = &*SESSION;
    let mut aligner = Aligner::new(Scene::clone(scene));
    let alignment = aligner.align(input).unwrap();
    (aligner.conditions().unwrap(), alignment.applied_to(input))
}

fn things(watched: Watched) -> Option<Things> {
    match watched {
        Watched::Things(things) => things,
        Watched::Unchanged(_) => panic!("the picture has changed"),
    }
}

#[test]
fn marks_follow_a_hand_and_none_stays() {
    let (conditions, input) = aligned();
    let plain = Arc::clone(input.image.rgba());
    let mut watcher = ThingWatcher::default();
    let mut look = |image: Image| {
        let seen = input.clone().with_image(Arc::new(image));
        watcher.look(&conditions, &seen).unwrap()
    };
    assert!(things(look(Image::clone(&plain))).is_none_or(|things| !things.has_any()));
    assert!(matches!(look(Image::clone(&plain)), Watched::Unchanged(_)));
    for left_px in [500, 440, 380, 380, 420, 470] {
        let rect = hand(left_px);
        let watched = look(painted(&plain, rect));
        let things = match watched {
            Watched::Things(things) => things,
            Watched::Unchanged(things) => {
                assert_eq!(left_px, 380, "it rests there alone");
                things
            }
        };
        let [of_it, beyond] = marked(things.as_ref(), rect);
        assert!(
            of_it > 0.9 && beyond < 0.1,
            "at {left_px}: {of_it:.2} of it, {beyond:.2} beyond"
        );
    }
    assert!(things(look(Image::clone(&plain))).is_none_or(|things| !things.has_any()));
}

#[test]
fn a_picture_of_another_camera_is_searched_though_it_looks_the_same() {
    let (conditions, input) = aligned();
    let mut watcher = ThingWatcher::default();
    let mut look = |input: &FrameInput| watcher.look(&conditions, input).unwrap();
    assert!(matches!(look(&input), Watched::Things(_)));
    assert!(matches!(look(&input), Watched::Unchanged(_)));
    let mut camera = input.camera;
    camera.world_from_camera *= DMat4::from_translation(glam::DVec3::X * 1e-3);
    assert!(matches!(
        look(&input.clone().with_camera(camera)),
        Watched::Things(_)
    ));
}

/// A picture that is so many times as wide and as high.
fn enlarged(image: &Image, times: u32) -> Arc<Image> {
    let [width_px, height_px] = [image.width_px, image.height_px].map(|px| times * px);
    let pixels = pixels([UVec2::ZERO, UVec2::new(width_px, height_px)]);
    let rgba8 = pixels.flat_map(|at| {
        let first = 4 * (at.y / times * image.width_px + at.x / times) as usize;
        image.rgba8[first..first + 4].to_owned()
    });
    Arc::new(Image {
        rgba8: rgba8.collect(),
        width_px,
        height_px,
    })
}

fn enlarged_camera(camera: &Camera, times: u32) -> Camera {
    Camera {
        intrinsics: camera.intrinsics.scaled(f64::from(times)),
        ..*camera
    }
}

#[test]
fn a_hand_in_a_picture_of_two_megapixels_is_found_where_it_is() {
    const TIMES: u32 = 3;
    let (scene, input) = &*SESSION;
    let mut scene = Scene::clone(scene);
    for plate in &mut scene.plates {
        plate.image = enlarged(&plate.image, TIMES);
        plate.camera = enlarged_camera(&plate.camera, TIMES);
    }
    [scene.width_px, scene.height_px] = [scene.width_px, scene.height_px].map(|px| TIMES * px);
    let plain = Arc::clone(input.image.rgba());
    let input = input.clone().with_camera(enlarged_camera(&input.camera, TIMES));
    let input = input.with_image(enlarged(&plain, TIMES));
    let mut aligner = Aligner::new(scene);
    let alignment = aligner.align(&input).unwrap();
    let (conditions, input) = (aligner.conditions().unwrap(), alignment.applied_to(&input));
    let rect = hand(440);
    let seen = input.with_image(enlarged(&painted(&plain, rect), TIMES));
    let mut watcher = ThingWatcher::default();
    let found = things(watcher.look(&conditions, &seen).unwrap()).unwrap();
    // Marks are in a picture of their own.
    let scale = f64::from(found.size_px().x) / f64::from(plain.width_px);
    let rect = rect.map(|at| (at.as_dvec2() * scale).as_uvec2());
    let [of_it, beyond] = marked(Some(&found), rect);
    assert!(
        of_it > 0.9 && beyond < 0.1,
        "{of_it:.2} of it, {beyond:.2} beyond"
    );
    let [focal_px, of_session_px] = [found.camera(), &SESSION.1.camera].map(|camera| camera.intrinsics.fx_px);
    assert!((focal_px / of_session_px - scale).abs() < 1e-6, "{focal_px}");
}

/// The picture with noise of so many codes.
fn noisy(image: &Image, codes: f64, random: &mut Random) -> Image {
    let mut image = image.clone();
    for pixel in image.rgba8.chunks_exact_mut(4) {
        for code in &mut pixel[..3] {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
            let noisy = (f64::from(*code) + codes * random.normal())
                .round()
                .clamp(0.0, 255.0) as u8;
            *code = noisy;
        }
    }
    image
}

#[test]
fn no_mark_flickers_where_nothing_changes() {
    let (scene, input) = &*SESSION;
    let mut scene = Scene::clone(scene);
    let mut random = Random::new(5);
    scene.plates[0].image = Arc::new(painted(&scene.plates[0].image, IN_SHADOW));
    let frame = painted(input.image.rgba(), IN_SHADOW);
    let mut observer = Observer::default();
    let mut look = || {
        let input = input
            .clone()
            .with_image(Arc::new(noisy(&frame, 3.0, &mut random)));
        observer.observed(&scene, &input).unwrap().things.unwrap()
    };
    let mut before = look();
    for _ in 0..4 {
        let now = look();
        let pairs = before.marks().iter().zip(now.marks());
        let n_other = pairs.filter(|(a, b)| a != b).count();
        let n_marks = now.marks().len() - now.count(Mark::None);
        assert!(n_marks > 1500, "{n_marks}");
        assert!(
            (n_other as f64) < 0.005 * n_marks as f64,
            "{n_other} of {n_marks}"
        );
        before = now;
    }
}

/// A turn about the toy's own centre leaves that where it was, but its shadow moves: no mark of before stays.
#[test]
fn marks_of_a_toy_that_was_turned_are_those_of_its_new_place() {
    let (conditions, input) = aligned();
    let image = Arc::new(painted(input.image.rgba(), IN_SHADOW));
    let turned = {
        let at = middle(&input.world_from_object);
        let turn = DMat4::from_translation(at)
            * DMat4::from_rotation_y(10f64.to_radians())
            * DMat4::from_translation(-at);
        input
            .clone()
            .with_image(Arc::clone(&image))
            .with_world_from_object(turn * input.world_from_object)
    };
    let alone = things(ThingWatcher::default().look(&conditions, &turned).unwrap());
    let mut watcher = ThingWatcher::default();
    watcher.look(&conditions, &input.with_image(image)).unwrap();
    let after = things(watcher.look(&conditions, &turned).unwrap());
    assert_eq!(marks(&after), marks(&alone));
}

/// Marks of another scene are none of this one's.
#[test]
fn marks_in_another_scene_are_its_own() {
    let (conditions, input) = aligned();
    let (mut other, _) = SESSION.clone();
    other.plates[0].image = Arc::new(painted(&other.plates[0].image, IN_SHADOW));
    let mut aligner = Aligner::new(other);
    aligner.align(&SESSION.1).unwrap();
    let others = aligner.conditions().unwrap();
    let seen = input
        .clone()
        .with_image(Arc::new(painted(input.image.rgba(), IN_SHADOW)));
    let alone = things(ThingWatcher::default().look(&others, &seen).unwrap());
    let mut watcher = ThingWatcher::default();
    watcher.look(&conditions, &seen).unwrap();
    let after = things(watcher.look(&others, &seen).unwrap());
    assert_eq!(marks(&after), marks(&alone));
}

fn marks(things: &Option<Things>) -> Option<&[Mark]> {
    things.as_ref().map(Things::marks)
}

/// A picture that shows the same is searched again if an alignment has measured another softness.
#[test]
fn another_softness_is_another_condition() {
    let (scene, input) = &*SESSION;
    let mut aligner = Aligner::new(Scene::clone(scene));
    let alignment = aligner.align(input).unwrap();
    let sharp = aligner.conditions().unwrap();
    let soft = FrameInput::clone(input).with_image(Arc::new(softened(input.image.rgba())));
    aligner.align(&soft).unwrap();
    let soft = aligner.conditions().unwrap();
    let input = alignment.applied_to(input);
    let mut watcher = ThingWatcher::default();
    watcher.look(&sharp, &input).unwrap();
    assert!(matches!(
        watcher.look(&sharp, &input).unwrap(),
        Watched::Unchanged(_)
    ));
    assert!(matches!(watcher.look(&soft, &input).unwrap(), Watched::Things(_)));
}

/// The picture with the mean of the nine pixels around each one.
fn softened(image: &Image) -> Image {
    let mut soft = image.clone();
    let width = image.width_px as usize;
    for y in 1..image.height_px as usize - 1 {
        for x in 1..width - 1 {
            for channel in 0..3 {
                let at = |k: usize| 4 * ((y + k / 3 - 1) * width + x + k % 3 - 1) + channel;
                let sum: u32 = (0..9).map(|k| u32::from(image.rgba8[at(k)])).sum();
                #[allow(clippy::cast_possible_truncation, reason = "a mean of codes")]
                let mean = (sum / 9) as u8;
                soft.rgba8[at(4)] = mean;
            }
        }
    }
    soft
}
