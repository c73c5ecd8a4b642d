//! Measurement of a picture's softness with the bundled session, whose frame or plate is blurred as
//! by a lens or a motion.

use std::sync::Arc;

use app_core::alignment::{Aligner, Observer};
use app_core::frame::FrameInput;
use app_core::scene::{Image, Scene};
use app_core::session::GroundTruth;
use app_core::sharpness::{Sharpness, Spread};
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};
use glam::{DMat4, DVec2, DVec3};
use harness::bundled_session;

use super::bundled::SESSION;

/// A blur along each side: steps and weights.
type Taps = Vec<(i32, f32)>;

fn gaussian(deviation_px: f32) -> Taps {
    let weight = |step: i32| (-0.5 * (step as f32 / deviation_px).powi(2)).exp();
    let sum: f32 = (-12..=12).map(weight).sum();
    (-12..=12).map(|step| (step, weight(step) / sum)).collect()
}

fn still() -> Taps {
    vec![(0, 1.0)]
}

/// Blur in linear light.
#[allow(clippy::cast_possible_truncation, reason = "from 0 to 255")]
fn spread(image: &Image, across: &Taps, down: &Taps) -> Image {
    let (width, height) = (image.width_px as i32, image.height_px as i32);
    let codes = image.rgba8.chunks_exact(4);
    let sharp: Vec<[f32; 3]> = codes
        .map(|texel| [0, 1, 2].map(|channel| linear_from_srgb(f32::from(texel[channel]) / 255.0)))
        .collect();
    let along = |from: &[[f32; 3]], taps: &Taps, [x_step, y_step]: [i32; 2]| {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let sum = |(x, y): (i32, i32)| {
            taps.iter().fold([0.0; 3], |sum: [f32; 3], (step, weight)| {
                let x = (x + step * x_step).clamp(0, width - 1);
                let y = (y + step * y_step).clamp(0, height - 1);
                let color = from[(y * width + x) as usize];
                [0, 1, 2].map(|channel| sum[channel] + weight * color[channel])
            })
        };
        places.map(sum).collect::<Vec<_>>()
    };
    let soft = along(&along(&sharp, across, [1, 0]), down, [0, 1]);
    let code = |linear: f32| (255.0 * srgb_from_linear(linear)).round() as u8;
    Image {
        rgba8: soft
            .iter()
            .flat_map(|[r, g, b]| [code(*r), code(*g), code(*b), 255])
            .collect(),
        ..image.clone()
    }
}

/// The session's first frame, with its own picture or its plates blurred.
fn spread_session(frame: Option<[Taps; 2]>, plates: Option<[Taps; 2]>) -> (Scene, FrameInput) {
    let (mut scene, mut input) = SESSION.clone();
    if let Some([across, down]) = frame {
        input = input
            .clone()
            .with_image(spread(input.image.rgba(), &across, &down));
    }
    if let Some([across, down]) = plates {
        for plate in &mut scene.plates {
            plate.image = Arc::new(spread(&plate.image, &across, &down));
        }
    }
    (scene, input)
}

fn as_given((scene, input): &(Scene, FrameInput)) -> Sharpness {
    Observer::default().observed(scene, input).unwrap().sharpness
}

/// A picture as sharp as its plate, or sharper, has no blur to measure.
#[test]
fn a_picture_as_sharp_as_its_plate_is_told_as_sharp() {
    let soft = || Some([gaussian(1.5), gaussian(1.5)]);
    for session in [spread_session(None, None), spread_session(None, soft())] {
        let Sharpness {
            plate_spread,
            outline_spread,
        } = as_given(&session);
        assert!(plate_spread.widest_px() < 0.3, "{plate_spread:?}");
        assert_eq!(outline_spread, plate_spread);
    }
}

/// With the given pose, and with a search for it.
#[test]
fn a_picture_out_of_focus_is_told_by_its_texture_and_its_outline() {
    let session = spread_session(Some([gaussian(2.0), gaussian(2.0)]), None);
    let mut aligner = Aligner::new(session.0.clone());
    for sharpness in [as_given(&session), aligner.align(&session.1).unwrap().sharpness] {
        let plate_px = sharpness.plate_spread.variances_px2().map(f64::sqrt);
        assert!(plate_px.iter().all(|px| (px - 2.0).abs() < 0.15), "{plate_px:?}");
        let outline_px = sharpness.outline_spread.widest_px();
        assert!((outline_px - 2.0).abs() < 0.25, "{outline_px}");
    }
}

/// A toy that is not where its outline is has no blur that could be measured there.
#[test]
fn a_wrong_pose_is_no_blur() {
    let (scene, input) = spread_session(None, None);
    let aside = DMat4::from_translation(4e-3 * DVec3::X) * input.world_from_object;
    let sharpness = as_given(&(scene, input.with_world_from_object(aside)));
    assert_eq!(sharpness.outline_spread, sharpness.plate_spread);
    assert!(sharpness.plate_spread.widest_px() < 0.3, "{sharpness:?}");
}

/// Softness of a shadow by the lens is none of its light: a bulb is found in its own size.
#[test]
fn a_light_is_no_larger_out_of_focus() {
    let (scene, input) = spread_session(Some([gaussian(2.0), gaussian(2.0)]), None);
    let found = Aligner::new(scene).align(&input).unwrap();
    let [light] = &found.report.lights[..] else {
        panic!("{:?}", found.report.lights);
    };
    let size_ratio = light.size_ratio.unwrap();
    assert!((size_ratio - 1.0).abs() < 0.15, "{light:?}");
    assert!(light.turned_rad < 0.003, "{light:?}");
}

/// Frame and plate by the same lens: only the outline shows the blur.
#[test]
fn a_plate_that_is_as_soft_is_told_by_the_outline() {
    let soft = || Some([gaussian(1.5), gaussian(1.5)]);
    let sharpness = as_given(&spread_session(soft(), soft()));
    assert!(
        sharpness.plate_spread.widest_px() < 0.3,
        "{:?}",
        sharpness.plate_spread
    );
    let outline_px = sharpness.outline_spread.widest_px();
    assert!((outline_px - 1.5).abs() < 0.3, "{outline_px}");
}

#[test]
fn a_motion_is_told_by_its_direction() {
    let motion: Taps = (-2..=2).map(|step| (step, 0.2)).collect();
    let expected = Spread::of_motion(5.0 * DVec2::X);
    let sharpness = as_given(&spread_session(Some([motion, still()]), None));
    let deviations_px = |spread: Spread| spread.variances_px2().map(|variance| variance.max(0.0).sqrt());
    let [wide, narrow] = deviations_px(sharpness.plate_spread);
    assert!((wide - expected.widest_px()).abs() < 0.1, "{wide}");
    assert!(narrow < 0.4, "{narrow}");
    assert!(sharpness.plate_spread.xx_px2 > 4.0 * sharpness.plate_spread.yy_px2);
    let [wide, narrow] = deviations_px(sharpness.outline_spread);
    let ratio = wide / expected.widest_px();
    assert!((0.93..1.07).contains(&ratio) && narrow < 0.4, "{wide}, {narrow}");
    let along = sharpness.outline_spread.axes_px()[0].normalize();
    assert!(along.x.abs() > 0.95, "{along}");
}

/// Length and direction of a motion of the camera, in pixels.
const MOTION_PX: DVec2 = DVec2::new(4.1, 2.87);
/// One at 45 degrees whose variances along rows and columns are 1: only their covariance tells it from a round
/// blur of a pixel.
const DIAGONAL_PX: DVec2 = DVec2::new(3.464, 3.464);

/// An upright one, across which the planks are as sharp as before.
pub(crate) const UPRIGHT_PX: DVec2 = DVec2::new(0.0, 5.0);

/// A frame in a motion, of steps between pixels.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pixels, and codes from 0 to 255"
)]
pub(crate) fn moved(image: &Image, motion_px: DVec2) -> Image {
    const N: i32 = 20;
    let (width, height) = (image.width_px as i32, image.height_px as i32);
    let light = |x: i32, y: i32, channel: usize| {
        let at = y.clamp(0, height - 1) * width + x.clamp(0, width - 1);
        linear_from_srgb(f32::from(image.rgba8[4 * at as usize + channel]) / 255.0)
    };
    let between = |at: DVec2, channel: usize| {
        let low = at.floor();
        let t = (at - low).as_vec2();
        let (x, y) = (low.x as i32, low.y as i32);
        let row = |y: i32| (1.0 - t.x) * light(x, y, channel) + t.x * light(x + 1, y, channel);
        (1.0 - t.y) * row(y) + t.y * row(y + 1)
    };
    let code = |x: i32, y: i32, channel: usize| {
        let steps = (0..N).map(|k| (f64::from(k) + 0.5) / f64::from(N) - 0.5);
        let at = DVec2::new(f64::from(x), f64::from(y));
        let sum: f32 = steps.map(|part| between(at + part * motion_px, channel)).sum();
        (255.0 * srgb_from_linear(sum / N as f32)).round() as u8
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Image {
        rgba8: texels
            .flat_map(|(x, y)| [code(x, y, 0), code(x, y, 1), code(x, y, 2), 255])
            .collect(),
        ..image.clone()
    }
}

/// The session's first frame in a motion.
fn moved_session(motion_px: DVec2) -> (Scene, FrameInput) {
    let (scene, input) = SESSION.clone();
    let image = moved(input.image.rgba(), motion_px);
    let input = input.clone().with_image(image);
    (scene, input)
}

/// Whether each pixel of the session's first frame shows the toy.
fn toy_mask() -> Vec<bool> {
    let labels = bundled_session().truth(0).unwrap().unwrap().mask;
    labels.rgba8.chunks_exact(4).map(|texel| texel[1] > 0).collect()
}

/// The same over an even table without a shadow.
fn moved_over_even() -> (Scene, FrameInput) {
    let (mut scene, input) = SESSION.clone();
    let painted = |image: &Image, is_kept: &dyn Fn(usize) -> bool| {
        let mut image = image.clone();
        for (index, texel) in image.rgba8.chunks_exact_mut(4).enumerate() {
            if !is_kept(index) {
                texel[..3].fill(120);
            }
        }
        image
    };
    for plate in &mut scene.plates {
        plate.image = Arc::new(painted(&plate.image, &|_| false));
    }
    let is_toy = toy_mask();
    let image = painted(input.image.rgba(), &|index| is_toy[index]);
    let input = input.clone().with_image(moved(&image, MOTION_PX));
    (scene, input)
}

/// Interpolation blurs as well: by a sixth of a square pixel along each axis.
fn check_motion(spread: Spread, motion_px: DVec2, (allowed_px, allowed_rad): (f64, f64)) {
    let expected = Spread::of_motion(motion_px).and(Spread::round((1.0_f64 / 6.0).sqrt()));
    let [told, true_px] = [spread, expected].map(|spread| spread.variances_px2().map(f64::sqrt));
    for k in 0..2 {
        assert!(
            (told[k] - true_px[k]).abs() < allowed_px,
            "{told:?} for {true_px:?}"
        );
    }
    let across = spread.axes_px()[0].normalize().perp_dot(motion_px.normalize());
    assert!(across.abs() < allowed_rad, "{spread:?} is turned by {across}");
    assert!(spread.is_line());
}

#[test]
fn a_motion_is_told_by_its_texture_and_its_outline() {
    let sharpness = as_given(&moved_session(MOTION_PX));
    check_motion(sharpness.plate_spread, MOTION_PX, (0.05, 0.05));
    check_motion(sharpness.outline_spread, MOTION_PX, (0.05, 0.05));
}

/// Measured: .03 and .11 px too wide along the motion and across it.
#[test]
fn a_diagonal_motion_is_told_by_its_texture_and_its_outline() {
    let sharpness = as_given(&moved_session(DIAGONAL_PX));
    check_motion(sharpness.plate_spread, DIAGONAL_PX, (0.15, 0.05));
    check_motion(sharpness.outline_spread, DIAGONAL_PX, (0.15, 0.05));
}

/// The lens of photograph and plate is as soft, and the photograph's camera has moved.
#[test]
fn a_soft_lens_beside_a_motion_is_told_by_the_outline() {
    let (scene, input) = moved_session(MOTION_PX);
    let soft = [gaussian(1.0), gaussian(1.0)];
    let (mut scene, input) = (
        scene,
        input
            .clone()
            .with_image(spread(input.image.rgba(), &soft[0], &soft[1])),
    );
    for plate in &mut scene.plates {
        plate.image = Arc::new(spread(&plate.image, &soft[0], &soft[1]));
    }
    let sharpness = as_given(&(scene, input));
    check_motion(sharpness.plate_spread, MOTION_PX, (0.2, 0.1));
    let beyond = sharpness.outline_spread.and(sharpness.plate_spread.times(-1.0));
    let beyond_px = beyond.mean_px();
    assert!((beyond_px - 1.0).abs() < 0.25, "{beyond_px}");
}

/// No texture tells a blur of the plate.
#[test]
fn a_motion_over_an_even_table_is_told_by_the_outline() {
    let sharpness = as_given(&moved_over_even());
    assert_eq!(sharpness.plate_spread, Spread::NONE);
    check_motion(sharpness.outline_spread, MOTION_PX, (0.15, 0.12));
}

/// A blur of the outline that the table beside it does not have is no camera's.
#[test]
fn a_motion_of_the_toy_alone_is_none_of_the_camera() {
    let (scene, input) = SESSION.clone();
    let image = input.image.rgba();
    let [soft, moved] = [
        spread(image, &gaussian(1.5), &gaussian(1.5)),
        moved(image, 2.0 * MOTION_PX),
    ];
    let width = image.width_px as i32;
    let is_toy = toy_mask();
    let is_near = |index: usize| {
        let around = (0..15 * 15).map(|k| (k / 15 - 7) * width + k % 15 - 7);
        let around = around.filter_map(|step| index.checked_add_signed(step as isize));
        around.into_iter().any(|at| is_toy.get(at) == Some(&true))
    };
    let mut mixed = soft.clone();
    for index in (0..is_toy.len()).filter(|index| is_near(*index)) {
        mixed.rgba8[4 * index..4 * index + 4].copy_from_slice(&moved.rgba8[4 * index..4 * index + 4]);
    }
    let input = input.clone().with_image(mixed);
    let sharpness = as_given(&(scene, input));
    let plate_px = sharpness.plate_spread.variances_px2().map(f64::sqrt);
    assert!(plate_px.iter().all(|px| (px - 1.5).abs() < 0.15), "{plate_px:?}");
    assert_eq!(sharpness.outline_spread, sharpness.plate_spread);
}

#[test]
fn a_motion_without_a_plate_is_told_by_the_outline() {
    let (mut scene, input) = moved_session(MOTION_PX);
    scene.plates.clear();
    check_motion(as_given(&(scene, input)).outline_spread, MOTION_PX, (0.15, 0.12));
}

/// Beside a plate with a round blur the edges of the planks looked like light that the lamp does not give:
/// .036 of the shadow, and .11 on tiles, which was blamed on the list of lights.
#[test]
fn the_lamp_explains_a_shadow_in_a_motion() {
    let (scene, input) = moved_session(UPRIGHT_PX);
    let found = Aligner::new(scene).align(&input).unwrap();
    let unexplained = found.report.unexplained.unwrap();
    assert!(unexplained < 0.01, "{unexplained}");
}
