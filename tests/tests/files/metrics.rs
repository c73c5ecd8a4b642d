//! The scores compared with closed forms, and proof that they can distinguish pictures.

use app_core::scene::Image;
use app_core::session::Truth;
use desk::metrics::flicker::{Errors, Flicker, Follower, mean_flicker};
use desk::metrics::{Regions, Score, measure};

const SIDE_PX: u32 = 40;

fn picture(pixel: impl Fn(u32, u32) -> [u8; 4]) -> Image {
    let pixels = (0..SIDE_PX).flat_map(|y| (0..SIDE_PX).map(move |x| (x, y)));
    let rgba8 = pixels.flat_map(|(x, y)| pixel(x, y)).collect();
    Image {
        width_px: SIDE_PX,
        height_px: SIDE_PX,
        rgba8,
    }
}

fn flat(pixel: [u8; 4]) -> Image {
    picture(|_, _| pixel)
}

/// Texture without symmetry, in three different colours.
fn texture() -> Image {
    picture(|x, y| {
        let code = |step: u32| u8::try_from((x * x + step * y + x * y) % 251).unwrap();
        [code(3), code(7), code(20), 255]
    })
}

fn everywhere() -> Regions {
    Regions::from_mask(&flat([255; 4]))
}

fn close(actual: f64, expected: f64) {
    assert!((actual - expected).abs() < 1e-12, "{actual} is not {expected}");
}

#[test]
fn equal_pictures_are_perfect_whatever_their_alpha() {
    let truth = texture();
    let mut actual = truth.clone();
    actual
        .rgba8
        .iter_mut()
        .skip(3)
        .step_by(4)
        .for_each(|alpha| *alpha = 0);
    let scores = measure(&actual, &truth, &everywhere()).unwrap();
    for score in [scores.shadow, scores.toy, scores.edge, scores.frame] {
        assert_eq!(score.rmse, 0.0);
        close(score.ssim, 1.0);
    }
}

#[test]
fn constant_offset_of_flat_grey() {
    let scores = measure(
        &flat([107, 107, 107, 255]),
        &flat([100, 100, 100, 255]),
        &everywhere(),
    )
    .unwrap();
    close(scores.frame.rmse, 7.0);
    // Without variance only the term of the means counts, borders included.
    let c1 = (0.01_f64 * 255.0).powi(2);
    close(
        scores.frame.ssim,
        (2.0 * 100.0 * 107.0 + c1) / (100.0_f64.powi(2) + 107.0_f64.powi(2) + c1),
    );
}

#[test]
fn rmse_is_the_mean_over_the_three_colours() {
    let scores = measure(&flat([3, 0, 4, 255]), &flat([0, 0, 0, 255]), &everywhere()).unwrap();
    close(scores.frame.rmse, (25.0_f64 / 3.0).sqrt());
}

#[test]
fn one_bright_pixel_in_the_corner_shows_window_and_border() {
    const LEVEL: u8 = 200;
    let actual = picture(|x, y| {
        if (x, y) == (0, 0) {
            [LEVEL, LEVEL, LEVEL, 255]
        } else {
            [0, 0, 0, 255]
        }
    });
    let scores = measure(&actual, &flat([0, 0, 0, 255]), &everywhere()).unwrap();

    let gauss = |i: u32| {
        if i <= 5 {
            (-0.5 * (f64::from(i) / 1.5).powi(2)).exp()
        } else {
            0.0
        }
    };
    let sum = gauss(0) + 2.0 * (1..=5).map(gauss).sum::<f64>();
    // The border repeats the pixel, so that the window around x contains it at distance x and x +
    // 1.
    let weight = |x: u32| (gauss(x) + gauss(x + 1)) / sum;
    let (c1, c2) = ((0.01_f64 * 255.0).powi(2), (0.03_f64 * 255.0).powi(2));
    let ssim_at = |x: u32, y: u32| {
        let mean = weight(x) * weight(y) * f64::from(LEVEL);
        let variance = mean * f64::from(LEVEL) - mean * mean;
        c1 * c2 / ((mean * mean + c1) * (variance + c2))
    };
    let total: f64 = (0..SIDE_PX)
        .flat_map(|y| (0..SIDE_PX).map(move |x| ssim_at(x, y)))
        .sum();
    close(scores.frame.ssim, total / f64::from(SIDE_PX * SIDE_PX));
}

#[test]
fn regions_have_the_sizes_of_their_squares() {
    let n_pixels = |region: std::ops::Range<u32>, pixel: [u8; 4]| {
        let inside = |x, y| region.contains(&x) && region.contains(&y);
        Regions::from_mask(&picture(|x, y| if inside(x, y) { pixel } else { [0; 4] })).n_pixels()
    };
    let frame = 40 * 40;
    // Shadow, toy, edge: one pixel in the centre, in each channel of the mask.
    assert_eq!(n_pixels(20..21, [255, 0, 0, 0]), [0, 0, 5 * 5, frame]);
    assert_eq!(n_pixels(20..21, [0, 255, 0, 0]), [13 * 13, 0, 0, frame]);
    assert_eq!(n_pixels(20..21, [0, 0, 3, 0]), [13 * 13, 0, 0, frame]);
    assert_eq!(n_pixels(20..21, [0, 0, 0, 3]), [13 * 13, 0, 0, frame]);
    assert_eq!(n_pixels(20..21, [0, 0, 2, 2]), [0, 0, 0, frame]);
    assert_eq!(
        n_pixels(20..21, [255, 255, 0, 0]),
        [13 * 13 - 5 * 5, 0, 5 * 5, frame]
    );
    // A block of 5, and the border, beyond which nothing counts as outside the toy.
    assert_eq!(n_pixels(20..25, [255, 0, 0, 0]), [0, 3 * 3, 9 * 9 - 3 * 3, frame]);
    assert_eq!(n_pixels(0..1, [0, 255, 0, 0]), [7 * 7, 0, 0, frame]);
    assert_eq!(n_pixels(0..5, [255, 0, 0, 0]), [0, 4 * 4, 7 * 7 - 4 * 4, frame]);
    assert_eq!(n_pixels(0..40, [255, 0, 0, 0]), [0, frame, 0, frame]);
}

#[test]
fn an_error_counts_only_in_its_region() {
    let toy = |x: u32| x >= 20;
    let regions = Regions::from_mask(&picture(|x, _| if toy(x) { [255, 0, 0, 0] } else { [0; 4] }));
    let truth = flat([100, 100, 100, 255]);
    let actual = picture(|x, _| {
        if toy(x) {
            [110, 110, 110, 255]
        } else {
            [100, 100, 100, 255]
        }
    });
    let scores = measure(&actual, &truth, &regions).unwrap();
    close(scores.toy.rmse, 10.0);
    close(scores.frame.rmse, 50.0_f64.sqrt());
    // Columns 18 and 19 are right, and 20 is wrong.
    close(scores.edge.rmse, (100.0_f64 / 3.0).sqrt());
    assert_eq!(
        scores.shadow,
        Score { rmse: 0.0, ssim: 1.0 },
        "an empty region is perfect"
    );
}

#[test]
fn swapped_colours_and_a_shift_are_noticed() {
    let truth = texture();
    let mut swapped = truth.clone();
    swapped
        .rgba8
        .chunks_exact_mut(4)
        .for_each(|pixel| pixel.swap(0, 2));
    let mut shifted = truth.clone();
    shifted.rgba8.rotate_left(4);
    for actual in [swapped, shifted] {
        let frame = measure(&actual, &truth, &everywhere()).unwrap().frame;
        assert!(frame.rmse > 10.0 && frame.ssim < 0.99, "{frame:?}");
    }
}

#[test]
fn another_size_is_an_error() {
    let small = Image {
        width_px: 1,
        height_px: 1,
        rgba8: vec![0; 4],
    };
    let mislabelled = Image {
        width_px: SIDE_PX * 2,
        height_px: SIDE_PX / 2,
        ..texture()
    };
    for other in [small, mislabelled] {
        assert_eq!(
            measure(&other, &texture(), &everywhere()).unwrap_err().name,
            "picture"
        );
        assert_eq!(
            measure(&texture(), &other, &everywhere()).unwrap_err().name,
            "truth"
        );
    }
}

fn truth(image: Image) -> Truth {
    Truth {
        image,
        mask: flat([255; 4]),
    }
}

/// The flicker of pictures, each given with its truth.
fn flickers(pictures: Vec<(Image, Image)>) -> Vec<Option<Flicker>> {
    let mut follower = Follower::default();
    let frames = pictures.into_iter().enumerate();
    frames
        .map(|(index, (picture, of_truth))| follower.next(index, &picture, &truth(of_truth)).unwrap())
        .collect()
}

/// A picture with an offset; codes are not clipped.
fn offset(picture: &Image, by: i16) -> Image {
    let mut picture = picture.clone();
    for pixel in picture.rgba8.chunks_exact_mut(4) {
        for code in &mut pixel[..3] {
            *code = u8::try_from(i16::from(*code / 2) + 60 + by).unwrap();
        }
    }
    picture
}

#[test]
fn a_known_flicker_is_measured_and_an_exact_sequence_has_none() {
    let image = texture();
    // The truth changes, too; its own change is no flicker.
    let truths = [0, 20, -7, 3].map(|by| offset(&image, by));
    let exact = flickers(
        truths
            .iter()
            .map(|truth| (truth.clone(), truth.clone()))
            .collect(),
    );
    assert_eq!(exact[0], None, "nothing is before the first");
    for flicker in &exact[1..] {
        let flicker = flicker.unwrap();
        assert_eq!(
            [flicker.shadow, flicker.toy, flicker.edge, flicker.frame],
            [0.0; 4]
        );
    }
    // A constant error is no flicker either.
    let steady = flickers(
        [0, 20, -7, 3]
            .map(|by| (offset(&image, by + 9), offset(&image, by)))
            .into(),
    );
    assert!(steady[1..].iter().all(|flicker| flicker.unwrap().toy == 0.0));
    // An alternating error is one, of twice its size; and so is a picture that stands still while
    // the truth moves.
    let alternating = [(5, 0), (15, 20), (-2, -7), (-2, 3)];
    let found = flickers(
        alternating
            .map(|(picture, truth)| (offset(&image, picture), offset(&image, truth)))
            .into(),
    );
    for (flicker, expected) in found[1..].iter().zip([10.0, 10.0, 10.0]) {
        close(flicker.unwrap().frame, expected);
        close(flicker.unwrap().toy, expected);
        assert_eq!(flicker.unwrap().shadow, 0.0, "an empty region has none");
    }
    let mean = mean_flicker(&found.into_iter().flatten().collect::<Vec<_>>());
    close(mean.unwrap().frame, 10.0);
    assert_eq!(mean_flicker(&[]), None);
}

#[test]
fn flicker_is_over_pixels_that_are_of_a_region_in_both_frames() {
    let grey = |code: u8| flat([code, code, code, 255]);
    let toy_from = |left: u32| picture(|x, _| if x >= left { [255, 0, 0, 0] } else { [0; 4] });
    let errors = |left: u32, code: u8| {
        let truth = Truth {
            image: grey(100),
            mask: toy_from(left),
        };
        // Wrong on the toy by this amount, and far more in the column that belongs to the toy in
        // one of the frames alone.
        let wrong = picture(|x, _| match x {
            20..25 => [250, 250, 250, 255],
            25.. => [code, code, code, 255],
            _ => [100, 100, 100, 255],
        });
        Errors::new(&wrong, &truth).unwrap()
    };
    let flicker = errors(25, 104).flicker_from(&errors(20, 101)).unwrap();
    close(flicker.toy, 3.0);
    // 15 of 40 columns.
    close(flicker.frame, (9.0_f64 * 15.0 / 40.0).sqrt());
}

#[test]
fn a_frame_that_was_left_out_breaks_the_sequence() {
    let image = texture();
    let mut follower = Follower::default();
    let mut next = |index| follower.next(index, &image, &truth(texture())).unwrap();
    let found = [3, 4, 6, 7, 7].map(|index| next(index).is_some());
    assert_eq!(found, [false, true, false, true, false]);
}
