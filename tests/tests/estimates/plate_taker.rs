//! Taking the plate by hand: the pictures that contribute and those that are refused, with pictures
//! whose every pixel is known.

use std::sync::{Arc, OnceLock};

use app_core::app::{PlateRefusal, PlateShot, PlateStep, PlateTaker};
use app_core::camera_frame::{CameraImage, CodeRange, LumaCoefficients, PlanarImage, Planes, YcbcrEncoding};
use app_core::scene::{Camera, Image, Intrinsics, Plate};
use app_scene::geometry::color::linear_from_srgb;
use glam::{DMat4, DQuat, DVec2, DVec3};
use measure::random::Random;

const SIZE_PX: [u32; 2] = [320, 240];
const N_PIXELS: usize = 320 * 240;
const BETWEEN_S: f64 = 0.061;

/// A table in front of the camera, in codes; positions, in pixels, may be fractional.
#[derive(Clone, Copy)]
struct View {
    shift_px: DVec2,
    /// Standard deviation, in pixels.
    blur_px: f64,
    texture: f64,
    gain: f64,
    /// Centre of a hand.
    hand: Option<DVec2>,
    /// Centre of a hand's shadow alone, which darkens its surroundings.
    hand_shadow: Option<DVec2>,
}

const STILL: View = View {
    shift_px: DVec2::ZERO,
    blur_px: 0.0,
    texture: 1.0,
    gain: 1.0,
    hand: None,
    hand_shadow: None,
};

/// Waves of many directions and lengths, from 3 to 60 pixels, each of which a blur weakens
/// differently.
fn waves() -> Vec<(DVec2, f64, f64)> {
    let mut random = Random::new(31);
    let wave = |k: u32| {
        let length_px = 3.0 * 20_f64.powf(f64::from(k) / 11.0);
        let angle = std::f64::consts::TAU * random.uniform();
        let wave = DVec2::from_angle(angle) * std::f64::consts::TAU / length_px;
        (wave, std::f64::consts::TAU * random.uniform(), 6.0)
    };
    (0..12).map(wave).collect()
}

/// Centres of all pixels minus half a pixel, row by row.
fn pixels() -> impl Iterator<Item = DVec2> {
    let row = |y: u32| (0..SIZE_PX[0]).map(move |x| DVec2::new(f64::from(x), f64::from(y)));
    (0..SIZE_PX[1]).flat_map(row)
}

impl View {
    /// Codes of the table alone.
    fn texture(&self) -> Vec<f64> {
        let waves = waves().into_iter().map(|(wave, phase, codes)| {
            let blur = (-0.5 * wave.length_squared() * self.blur_px * self.blur_px).exp();
            (wave, phase, codes * blur * self.texture)
        });
        let waves: Vec<_> = waves.filter(|(_, _, codes)| *codes > 0.0).collect();
        let detail = |place: DVec2| -> f64 {
            waves
                .iter()
                .map(|(wave, phase, codes)| codes * (wave.dot(place) + phase).sin())
                .sum()
        };
        pixels().map(|at| 120.0 + detail(at - self.shift_px)).collect()
    }

    fn codes(&self) -> Vec<f64> {
        static STILL_TEXTURE: OnceLock<Vec<f64>> = OnceLock::new();
        let is_still = (self.shift_px, self.blur_px, self.texture) == (DVec2::ZERO, 0.0, 1.0);
        let texture = if is_still {
            STILL_TEXTURE.get_or_init(|| self.texture()).clone()
        } else {
            self.texture()
        };
        let code = |(at, table): (DVec2, f64)| {
            let shadow = self.hand_shadow.map_or(1.0, |middle| {
                1.0 - 0.08 * (-(at.distance(middle) / 60.0).powi(2)).exp()
            });
            match self.hand {
                Some(hand) if at.distance(hand) < 30.0 => 170.0,
                _ => self.gain * shadow * table,
            }
        };
        pixels().zip(texture).map(code).collect()
    }

    fn picture(&self, noise: f64, random: &mut Random) -> Image {
        let mut rgba8 = Vec::new();
        for code in self.codes() {
            let code = code + noise * random.normal();
            for channel in [0.0, 10.0, -20.0] {
                rgba8.push(rounded(code + channel));
            }
            rgba8.push(255);
        }
        Image {
            width_px: SIZE_PX[0],
            height_px: SIZE_PX[1],
            rgba8,
        }
    }

    fn shot(&self, noise: f64, random: &mut Random) -> PlateShot {
        let image = self.picture(noise, random);
        PlateShot {
            image: image.into(),
            camera: Some(tracked(random)),
            elapsed_s: BETWEEN_S,
        }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "a cast saturates")]
fn rounded(code: f64) -> u8 {
    code.round() as u8
}

/// A camera that stands still, as a tracker reports it.
fn tracked(random: &mut Random) -> Camera {
    let mut noise = || DVec3::from_array([(); 3].map(|()| random.normal()));
    let turn = DQuat::from_scaled_axis(0.2_f64.to_radians() * noise());
    Camera {
        intrinsics: Intrinsics {
            fx_px: 300.0,
            fy_px: 300.0,
            cx_px: 160.0,
            cy_px: 120.0,
        },
        world_from_camera: DMat4::from_rotation_translation(turn, DVec3::new(0.0, 0.3, 0.4) + 1e-3 * noise()),
    }
}

fn refusal(step: &PlateStep) -> Option<PlateRefusal> {
    match step {
        PlateStep::Refused(refusal) => Some(*refusal),
        _ => None,
    }
}

fn n_growing(step: &PlateStep) -> Option<u32> {
    match step {
        PlateStep::Growing { n, .. } => Some(*n),
        _ => None,
    }
}

/// Offers one view until a plate is taken.
fn taken(taker: &mut PlateTaker, random: &mut Random, mut view: impl FnMut(u32) -> View) -> (Plate, u32) {
    let mut steps = Vec::new();
    for frame in 0..100 {
        match taker.offer(&view(frame).shot(3.0, random)) {
            PlateStep::Taken { plate, n } => return (plate, n),
            step => steps.push(step),
        }
    }
    panic!("no plate in 100 shots: {steps:?}");
}

/// RMS difference of a picture's red from known codes, at selected pixels.
fn off(image: &Image, codes: &[f64]) -> f64 {
    let squares = image
        .rgba8
        .chunks_exact(4)
        .zip(codes)
        .map(|(pixel, code)| (f64::from(pixel[0]) - code).powi(2));
    let n = codes.len() as f64;
    (squares.sum::<f64>() / n).sqrt()
}

#[test]
fn noise_goes_down_by_the_root_of_the_number() {
    let mut random = Random::new(1);
    let (plate, n) = taken(&mut PlateTaker::default(), &mut random, |_| STILL);
    assert_eq!(n, 16);
    let codes = STILL.codes();
    let one = off(&STILL.picture(3.0, &mut random), &codes);
    // Each picture is rounded to codes, and so is their mean.
    let rounding = 1.0 / 12.0;
    assert!((one - (9.0_f64 + rounding).sqrt()).abs() < 0.05, "{one}");
    let expected = (one * one / 16.0 + rounding).sqrt();
    let mean = off(&plate.image, &codes);
    println!("one {one:.3}, mean of 16 {mean:.3}, expected {expected:.3} codes");
    assert!((mean / expected - 1.0).abs() < 0.05, "{mean}, not {expected}");
    // So do those of the poses: a single one has 1.7 mm.
    let position = plate.camera.world_from_camera.w_axis.truncate();
    assert!(
        position.distance(DVec3::new(0.0, 0.3, 0.4)) < 1.2e-3,
        "{position}"
    );
}

#[test]
fn the_mean_is_of_light_not_of_codes() {
    let mut random = Random::new(2);
    let mut taker = PlateTaker::default();
    let (mut light, mut codes) = (vec![0.0; N_PIXELS], vec![0.0; N_PIXELS]);
    for frame in 0..17 {
        let picture = STILL.picture(12.0, &mut random);
        // The first picture is needed to detect motion in the second.
        if frame > 0 {
            for (at, pixel) in picture.rgba8.chunks_exact(4).enumerate() {
                light[at] += f64::from(linear_from_srgb(f32::from(pixel[0]) / 255.0)) / 16.0;
                codes[at] += f64::from(pixel[0]) / 16.0;
            }
        }
        let shot = PlateShot {
            image: picture.into(),
            camera: Some(tracked(&mut random)),
            elapsed_s: BETWEEN_S,
        };
        if let PlateStep::Taken { plate, n } = taker.offer(&shot) {
            assert_eq!((frame, n), (16, 16));
            let off_by = |expected: &dyn Fn(usize) -> f64| {
                let pixels = plate.image.rgba8.chunks_exact(4).enumerate();
                pixels
                    .map(|(at, pixel)| (f64::from(pixel[0]) - expected(at)).abs())
                    .fold(0.0, f64::max)
            };
            #[allow(clippy::cast_possible_truncation, reason = "from 0 to 1")]
            let of_light = off_by(&|at| 255.0 * encoded(light[at]));
            let of_codes = off_by(&|at| codes[at]);
            assert!(of_light < 0.51 && of_codes > 1.0, "{of_light} {of_codes}");
            return;
        }
    }
    panic!("no plate");
}

fn encoded(light: f64) -> f64 {
    if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    }
}

/// A hand that crosses the picture, one that moves slowly, and the shadow of one that stays
/// outside.
#[test]
fn a_hand_is_refused_and_leaves_nothing_behind() {
    let fast = |frame: u32| {
        (5..25)
            .contains(&frame)
            .then(|| DVec2::new(20.0 * f64::from(frame) - 60.0, 120.0))
    };
    // It leaves the picture's left border after some 40 shots.
    let slow = |frame: u32| (frame < 40).then(|| DVec2::new(170.0 - 5.0 * f64::from(frame), 100.0));
    type Way<'a> = &'a dyn Fn(u32) -> View;
    let ways: [(&str, Way<'_>); 3] = [
        ("fast", &|frame| View {
            hand: fast(frame),
            ..STILL
        }),
        ("slow", &|frame| View {
            hand: slow(frame),
            ..STILL
        }),
        ("shadow", &|frame| View {
            hand_shadow: fast(frame),
            ..STILL
        }),
    ];
    let codes = STILL.codes();
    for (name, view) in ways {
        let mut random = Random::new(3);
        let mut taker = PlateTaker::default();
        let mut n_refused = 0;
        let plate = (0..100).find_map(|frame| {
            let step = taker.offer(&view(frame).shot(3.0, &mut random));
            n_refused += u32::from(refusal(&step) == Some(PlateRefusal::Obstructed));
            match step {
                PlateStep::Taken { plate, .. } => Some(plate),
                _ => None,
            }
        });
        let plate = plate.unwrap();
        let worst = plate.image.rgba8.chunks_exact(4).zip(&codes);
        let worst = worst
            .map(|(pixel, code)| (f64::from(pixel[0]) - code).abs())
            .fold(0.0, f64::max);
        let off = off(&plate.image, &codes);
        println!("{name}: {n_refused} refused; {off:.2} codes off, at most {worst:.1}");
        assert!(n_refused >= 10, "{name}: {n_refused}");
        assert!(off < 1.2 && worst < 8.0, "{name}: {off}, {worst}");
    }
}

#[test]
fn a_blurred_shot_is_refused_and_a_sharper_one_begins_anew() {
    let mut random = Random::new(4);
    let mut taker = PlateTaker::default();
    let blurred = View {
        blur_px: 1.2,
        ..STILL
    };
    for frame in 0..6 {
        let step = taker.offer(&blurred.shot(3.0, &mut random));
        assert_eq!(n_growing(&step), Some(frame), "nothing sharper was seen yet");
    }
    let step = taker.offer(&STILL.shot(3.0, &mut random));
    assert_eq!(n_growing(&step), Some(1), "the blurred ones are dropped");
    for _ in 0..3 {
        let step = taker.offer(&blurred.shot(3.0, &mut random));
        assert_eq!(refusal(&step), Some(PlateRefusal::Blurred));
    }
    let (plate, n) = taken(&mut taker, &mut random, |_| STILL);
    assert_eq!(n, 16);
    assert!(off(&plate.image, &STILL.codes()) < 0.9);
}

#[test]
fn a_camera_that_moves_is_refused_and_the_sharpest_is_taken_at_last() {
    let mut random = Random::new(5);
    let mut taker = PlateTaker::default();
    let mut n_moving = 0;
    for frame in 0..200 {
        let view = View {
            shift_px: DVec2::new(1.0, 0.6) * f64::from(frame),
            // A sharp picture once in a while.
            blur_px: if frame == 40 { 0.0 } else { 0.6 },
            ..STILL
        };
        match taker.offer(&view.shot(1.0, &mut random)) {
            PlateStep::Taken { plate, n } => {
                assert_eq!(n, 1);
                assert!(n_moving > 60, "{n_moving}");
                let sharp = View {
                    shift_px: DVec2::new(40.0, 24.0),
                    ..STILL
                };
                let off = off(&plate.image, &sharp.codes());
                assert!(off < 1.2, "{off}: not the sharpest");
                return;
            }
            // The pictures after the sharp one are blurred in comparison.
            step => {
                n_moving += u32::from(matches!(
                    refusal(&step),
                    Some(PlateRefusal::Moving | PlateRefusal::Blurred)
                ))
            }
        }
    }
    panic!("no plate");
}

/// A tremor of a tenth of a pixel is no movement, a turn about the view and a step of a centimetre
/// are.
#[test]
fn movement_is_judged_by_picture_and_pose() {
    let mut random = Random::new(6);
    let mut trembling = Random::new(7);
    let (_, n) = taken(&mut PlateTaker::default(), &mut random, |_| View {
        shift_px: 0.1 * DVec2::new(trembling.normal(), trembling.normal()),
        ..STILL
    });
    assert_eq!(n, 16);
    // A place without texture shows no movement, but poses do.
    let plain = View {
        texture: 0.0,
        ..STILL
    };
    let mut taker = PlateTaker::default();
    for _ in 0..4 {
        taker.offer(&plain.shot(3.0, &mut random));
    }
    let mut shot = plain.shot(3.0, &mut random);
    let camera = shot.camera.as_mut().unwrap();
    camera.world_from_camera.w_axis.x += 0.05;
    assert_eq!(refusal(&taker.offer(&shot)), Some(PlateRefusal::Moving));
    let (_, n) = taken(&mut taker, &mut random, |_| plain);
    assert_eq!(n, 16, "a plain place is not blurred");
}

#[test]
fn a_change_of_exposure_begins_anew() {
    let mut random = Random::new(8);
    let mut taker = PlateTaker::default();
    for _ in 0..5 {
        taker.offer(&STILL.shot(3.0, &mut random));
    }
    let brighter = View { gain: 1.05, ..STILL };
    assert_eq!(
        refusal(&taker.offer(&brighter.shot(3.0, &mut random))),
        Some(PlateRefusal::Exposure)
    );
    let (plate, n) = taken(&mut taker, &mut random, |_| brighter);
    assert_eq!(n, 16);
    assert!(off(&plate.image, &brighter.codes()) < 0.9);
}

/// The luma alone is examined before a plane's picture is decoded: the verdict is the same.
#[test]
fn planes_are_taken_as_pictures_are() {
    let mut random = Random::new(9);
    let mut taker = PlateTaker::default();
    let encoding = YcbcrEncoding {
        coefficients: LumaCoefficients::Bt601,
        range: CodeRange::Full,
    };
    let chroma = vec![128; N_PIXELS / 4];
    let codes = STILL.codes();
    for frame in 0..40 {
        let luma: Vec<u8> = codes
            .iter()
            .map(|code| rounded(code + 3.0 * random.normal()))
            .collect();
        let planes = Planes::i420(SIZE_PX, (&luma, 320), (&chroma, 160), (&chroma, 160), encoding);
        let image = CameraImage::from(PlanarImage::new(&planes).unwrap());
        let shot = PlateShot {
            image,
            camera: Some(tracked(&mut random)),
            elapsed_s: 1.0 / 30.0,
        };
        if let PlateStep::Taken { plate, n } = taker.offer(&shot) {
            // Number of pictures used if every second one is good.
            assert_eq!((frame, n), (31, 16));
            assert!(off(&plate.image, &codes) < 0.9);
            return;
        }
    }
    panic!("no plate");
}

#[test]
fn whatever_is_offered_is_answered() {
    let mut random = Random::new(10);
    let mut taker = PlateTaker::default();
    let odd = [f64::NAN, f64::INFINITY, -1.0, 0.0, 0.02, 1e300];
    let pick = |random: &mut Random, n: usize| {
        #[allow(clippy::cast_possible_truncation, reason = "below n")]
        let picked = (random.uniform() * n as f64) as usize;
        picked.min(n - 1)
    };
    let mut steps = [0; 3];
    for _ in 0..600 {
        let sides = [0, 1, 7, 8, 9, 40, 241, 500];
        let [width_px, height_px] = [(); 2].map(|()| sides[pick(&mut random, sides.len())]);
        let missing = if random.uniform() < 0.1 { 1 } else { 0 };
        let n_bytes = (4 * width_px as usize * height_px as usize).saturating_sub(missing);
        let code = rounded(255.0 * random.uniform());
        let image = Arc::new(Image {
            width_px,
            height_px,
            rgba8: vec![code; n_bytes],
        });
        let mut camera = tracked(&mut random);
        if random.uniform() < 0.1 {
            camera.world_from_camera *= odd[pick(&mut random, odd.len())];
        }
        let shot = PlateShot {
            image: image.into(),
            camera: (random.uniform() < 0.95).then_some(camera),
            elapsed_s: odd[pick(&mut random, odd.len())],
        };
        for _ in 0..1 + pick(&mut random, 20) {
            match taker.offer(&shot) {
                PlateStep::Refused(_) => steps[0] += 1,
                PlateStep::Growing { .. } => steps[1] += 1,
                PlateStep::Taken { plate, .. } => {
                    steps[2] += 1;
                    let n_bytes = 4 * plate.image.width_px as usize * plate.image.height_px as usize;
                    assert_eq!(plate.image.rgba8.len(), n_bytes);
                    assert!(plate.camera.world_from_camera.is_finite());
                }
            }
        }
    }
    assert!(steps.iter().all(|n| *n > 20), "{steps:?}");
}
