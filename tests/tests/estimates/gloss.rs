//! Estimation of a toy's gloss, from photographs of one on a table under a bulb.

use std::sync::{Arc, LazyLock};

use app_core::alignment::Observer;
use app_core::frame::FrameInput;
use app_core::gloss::Gloss;
use app_core::scene::{Image, Scene};
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};
use glam::{DVec3, UVec2};
use measure::photographer::{Part, Shape, Sheen, Shot, Stance, World};

/// A figure of three balls on a box, with two paints.
fn figure(sheen: Option<Sheen>) -> World {
    let mut world = World::boxes().resized([480, 270]);
    let ball = |radius_m: f64, at: DVec3, color: DVec3| Part {
        shape: Shape::Sphere { radius_m },
        color,
        rest: Stance::at(at),
        keys: Vec::new(),
    };
    world.parts.extend([
        ball(0.026, DVec3::new(0.0, 0.122, 0.0), DVec3::new(0.15, 0.22, 0.4)),
        ball(0.022, DVec3::new(0.05, 0.022, 0.04), DVec3::new(0.15, 0.22, 0.4)),
        ball(0.02, DVec3::new(-0.04, 0.02, 0.045), DVec3::new(0.45, 0.4, 0.3)),
    ]);
    world.sheen = sheen;
    world
}

fn shot(sheen: Option<Sheen>) -> (Scene, FrameInput) {
    let shot = Shot::of(&figure(sheen)).unwrap();
    (shot.scene, shot.input)
}

static MATT: LazyLock<(Scene, FrameInput)> = LazyLock::new(|| shot(None));

fn seen(scene: &Scene, input: &FrameInput) -> Gloss {
    Observer::default().observed(scene, input).unwrap().gloss
}

#[test]
fn roughness_and_strength_are_found() {
    for roughness in [0.12, 0.25] {
        let (scene, input) = shot(Some(Sheen {
            roughness,
            strength: 1.0,
        }));
        let found = seen(&scene, &input);
        let ratio = f64::from(found.roughness) / roughness;
        assert!(
            (0.75..1.33).contains(&ratio),
            "{roughness} is taken for {found:?}"
        );
        assert!((0.6..1.6).contains(&found.strongest()), "{found:?} of plastic");
        assert!(!found.is_beyond_model(), "{found:?}");
    }
}

/// Tone curve of a camera: it darkens shadows and flattens lights. A broad lobe would have a
/// similar effect on a matt toy.
fn through_a_camera(image: &Image) -> Image {
    let toned = |code: u8| {
        let light = linear_from_srgb(f32::from(code) / 255.0);
        let shown = light * (1.5 * light + 0.03) / (light * (1.46 * light + 0.59) + 0.14);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
        let code = (255.0 * srgb_from_linear(shown.min(1.0))).round() as u8;
        code
    };
    Image {
        rgba8: image.rgba8.iter().map(|code| toned(*code)).collect(),
        ..image.clone()
    }
}

#[test]
fn a_matt_toy_has_none() {
    let (scene, input) = &*MATT;
    assert_eq!(seen(scene, input), Gloss::NONE);
    let mut scene = scene.clone();
    for plate in &mut scene.plates {
        plate.image = Arc::new(through_a_camera(&plate.image));
    }
    let input = input
        .clone()
        .with_image(Arc::new(through_a_camera(input.image.rgba())));
    assert_eq!(seen(&scene, &input), Gloss::NONE);
}

/// A hand behind a toy of which one ball alone shows a highlight, before that hand.
#[test]
fn a_toy_before_a_hand_is_as_glossy() {
    const HAND: [UVec2; 2] = [UVec2::new(121, 15), UVec2::new(369, 144)];
    let sheen = Some(Sheen {
        roughness: 0.25,
        strength: 1.0,
    });
    let mut world = figure(sheen);
    world.parts.truncate(world.parts.len() - 2);
    let Shot {
        scene, input, truth, ..
    } = Shot::of(&world).unwrap();
    let mut image = Image::clone(input.image.rgba());
    let [first, end] = HAND;
    for at in (first.y..end.y).flat_map(|y| (first.x..end.x).map(move |x| UVec2::new(x, y))) {
        let index = 4 * (at.y * image.width_px + at.x) as usize;
        if truth.mask.rgba8[index + 1] == 0 {
            // Not of one code, as no hand is.
            let grain = ((7 * at.x + 13 * at.y) % 5) as u8;
            image.rgba8[index..index + 3].copy_from_slice(&[20, 120, 130].map(|code| code + grain));
        }
    }
    let alone = seen(&scene, &input);
    let found = Observer::default()
        .observed(&scene, &input.with_image(Arc::new(image)))
        .unwrap();
    let behind = found.things.as_ref().unwrap().marks().iter();
    let n_behind = behind.filter(|mark| mark.is_behind_toy()).count();
    assert!(n_behind > 2000, "{n_behind} pixels");
    assert_eq!(found.gloss, alone);
    assert_ne!(found.gloss, Gloss::NONE);
}

/// Neither a frame without the toy nor one without lights tells the gloss, and neither ends or changes it.
#[test]
fn a_gloss_is_found_in_the_first_frame_that_shows_the_toy_and_kept() {
    let (scene, input) = shot(Some(Sheen {
        roughness: 0.25,
        strength: 1.0,
    }));
    let mut observer = Observer::default();
    let mut look = |input: FrameInput| observer.observed(&scene, &input).unwrap().gloss;
    let empty = input.clone().with_image(Arc::clone(&scene.plates[0].image));
    let dark = input.clone().with_lights(Some(Arc::from([])));
    assert_eq!(look(empty), Gloss::NONE);
    assert_eq!(look(dark.clone()), Gloss::NONE);
    let found = look(input);
    assert!((0.6..1.6).contains(&found.strongest()), "{found:?}");
    assert_eq!(look(dark), found);
}
