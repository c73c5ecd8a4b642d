//! The grain of a textured picture, beside a plate of the same view.

use app_core::grain::Grain;
use app_core::scene::Image;
use app_scene::geometry::color::linear_from_srgb;
use reference::grain::grain_at;

const SIDE_PX: u32 = 400;
const GREY: f64 = 120.0;

/// A texture about a grey, with noise of a standard deviation and of these weights, all in codes. The
/// pictures differ by their number.
fn picture(texture: impl Fn(f64, f64) -> f64, (deviation, weights): (f64, [f64; 2]), number: u32) -> Image {
    let mut image = Image {
        width_px: SIDE_PX,
        height_px: SIDE_PX,
        rgba8: vec![255; (4 * SIDE_PX * SIDE_PX) as usize],
    };
    for (index, pixel) in (0..).zip(image.rgba8.chunks_mut(4)) {
        let [x, y] = [index % SIDE_PX, index / SIDE_PX];
        let noise = grain_at([x.cast_signed(), y.cast_signed()], number, weights, 0.0);
        let shown = GREY + texture(f64::from(x), f64::from(y));
        for (code, noise) in pixel.iter_mut().zip(noise) {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a code")]
            let noisy = (shown + deviation * noise).round() as u8;
            *code = noisy;
        }
    }
    image
}

/// Standard deviation in codes of a grain, at the grey.
fn codes(grain: &Grain) -> f64 {
    let [light, above] = [GREY, GREY + 1.0].map(|code| {
        #[allow(clippy::cast_possible_truncation, reason = "a code")]
        let code = code as f32;
        f64::from(linear_from_srgb(code / 255.0))
    });
    grain.frame.variance(light).sqrt() / (above - light)
}

#[test]
fn noise_on_a_fine_periodic_texture_is_found() {
    let squares = |x: f64, y: f64| if (x + y) % 4.0 < 2.0 { 4.0 } else { -4.0 };
    let [frame, plate] =
        [(1.5, 1), (0.0, 2)].map(|(deviation, number)| picture(squares, (deviation, [0.0; 2]), number));
    let found = codes(&Grain::measured(&frame, &plate).unwrap());
    assert!((found - 1.5).abs() < 0.2, "{found:.2} codes");
}

/// A denoiser's noise, of which pixels one to four apart have the correlations .76, .41, .13 and .03.
const FAR: [f64; 2] = [0.5, 0.2];

/// Correlations of pixels one and two apart.
fn correlations([near, far]: [f64; 2]) -> [f64; 2] {
    let squares = 1.0 + 2.0 * (near * near + far * far);
    [2.0 * near * (1.0 + far), 2.0 * far + near * near].map(|covariance| covariance / squares)
}

#[test]
fn noise_that_reaches_far_is_measured() {
    #[allow(clippy::cast_possible_truncation, reason = "a pixel")]
    let texture = |x: f64, y: f64| 3.0 * grain_at([x as i32, y as i32], 3, FAR, 0.0)[0];
    let frame = picture(texture, (1.5, FAR), 1);
    let plate = picture(texture, (0.0, FAR), 2);
    let found = Grain::measured(&frame, &plate).unwrap();
    let of_found = correlations(found.weights.map(f64::from));
    for (found, wanted) in of_found.into_iter().zip(correlations(FAR)) {
        assert!((found - wanted).abs() < 0.1, "{found:.2} for {wanted:.2}");
    }
    let found = codes(&found);
    assert!((found - 1.5).abs() < 0.15, "{found:.2} codes");
}

/// In three tenths of two pictures, darker ones, they differ; everywhere else they are equal.
#[test]
fn a_part_that_differs_is_no_noise_of_the_whole() {
    let dark_rows = 0.3 * f64::from(SIDE_PX);
    let texture = |x: f64, y: f64| {
        let wave = 12.0 * (0.9 * x).sin() * (0.7 * y).sin();
        if y < dark_rows { -60.0 } else { wave }
    };
    let noisy = |number: u32| picture(texture, (2.0, [0.0; 2]), number);
    let clean = picture(texture, (0.0, [0.0; 2]), 0);
    let with_clean_rest = |noisy: Image| {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of bytes"
        )]
        let n_dark = 4 * dark_rows as usize * SIDE_PX as usize;
        let rgba8 = [&noisy.rgba8[..n_dark], &clean.rgba8[n_dark..]].concat();
        Image { rgba8, ..noisy }
    };
    let everywhere = [1, 2].map(noisy);
    let in_part = [1, 2].map(|number| with_clean_rest(noisy(number)));
    assert!(Grain::measured(&everywhere[0], &everywhere[1]).is_some());
    assert_eq!(Grain::measured(&in_part[0], &in_part[1]), None);
}
