//! Proof that the comparer and the goldens can fail: each fault below must be found.

use std::fs;

use app_core::scene::Image;
use app_pipeline::readback::FloatMap;
use harness::compare::{Check, CompareError, Difference, Pair, Texels};
use harness::golden::{GoldenError, Goldens};
use harness::temporary::Temporary;

const WIDTH: u32 = 17;
const HEIGHT: u32 = 11;
const EXACT: &[Check] = &[Check::MaxAbs(0.0)];

/// Four different channels without symmetry, alpha included.
fn picture() -> Image {
    let texel = |i: u32| [3, 7, 20, 11].map(|step| u8::try_from(i * i % 97 + i * step % 101).unwrap());
    Image {
        width_px: WIDTH,
        height_px: HEIGHT,
        rgba8: (0..WIDTH * HEIGHT).flat_map(texel).collect(),
    }
}

fn map() -> FloatMap {
    let texels = picture()
        .rgba8
        .chunks_exact(4)
        .map(|t| [t[0], t[1], t[2], t[3]].map(|c| f32::from(c) / 8.0))
        .collect();
    FloatMap {
        width: WIDTH,
        height: HEIGHT,
        texels,
    }
}

fn check<T: Texels>(expected: &T, actual: &T) -> Result<Difference, CompareError> {
    Pair { expected, actual }.check(EXACT)
}

/// The picture with one fault, which must be found; returns the difference.
fn fault(spoil: impl Fn(&mut Image)) -> Difference {
    let (expected, mut actual) = (picture(), picture());
    spoil(&mut actual);
    let error = check(&expected, &actual).unwrap_err();
    assert!(matches!(error, CompareError::NotMet { .. }), "{error}");
    Pair {
        expected: &expected,
        actual: &actual,
    }
    .difference()
    .unwrap()
}

#[test]
fn equal_is_zero() {
    let difference = check(&picture(), &picture()).unwrap();
    assert_eq!(
        (difference.max_abs, difference.n_nan, difference.share_above(0.0)),
        (0.0, 0, 0.0)
    );
    assert_eq!(difference.size, [WIDTH, HEIGHT]);
    let difference = check(&map(), &map()).unwrap();
    assert_eq!((difference.max_abs, difference.share_above(0.0)), (0.0, 0.0));
}

#[test]
fn one_wrong_texel_is_found_and_measured() {
    let difference = fault(|image| image.rgba8[4 * 20 + 1] ^= 8);
    assert_eq!(difference.max_abs, 8.0);
    let one = 1.0 / f64::from(WIDTH * HEIGHT);
    assert!((difference.share_above(0.0) - one).abs() < 1e-12);
    assert!((difference.share_above(7.9) - one).abs() < 1e-12);
    assert_eq!(
        difference.share_above(8.0),
        0.0,
        "a difference of the tolerance is within it"
    );

    let (expected, mut actual) = (map(), map());
    actual.texels[186][2] += 0.25;
    let error = check(&expected, &actual).unwrap_err();
    assert!(
        matches!(error, CompareError::NotMet { max_abs: 0.25, .. }),
        "{error}"
    );
}

#[test]
fn a_wrong_alpha_is_found() {
    assert_eq!(fault(|image| image.rgba8[4 * 20 + 3] ^= 16).max_abs, 16.0);
    let (expected, mut actual) = (map(), map());
    actual.texels[0][3] += 1.0;
    assert!(check(&expected, &actual).is_err());
}

#[test]
fn a_shift_by_a_pixel_and_swapped_channels_are_found() {
    assert!(fault(|image| image.rgba8.rotate_left(4)).share_above(0.0) > 0.9);
    let swapped = fault(|image| image.rgba8.chunks_exact_mut(4).for_each(|texel| texel.swap(0, 2)));
    assert!(swapped.share_above(0.0) > 0.9);
}

#[test]
fn a_nan_fails_whatever_is_allowed() {
    let generous = [
        Check::MaxAbs(f64::INFINITY),
        Check::Outliers {
            tolerance: f64::INFINITY,
            max_share: 1.0,
        },
    ];
    let mut spoilt = map();
    spoilt.texels[5] = [0.0, f32::NAN, 0.0, 0.0];
    for (expected, actual) in [(&map(), &spoilt), (&spoilt, &map()), (&spoilt, &spoilt.clone())] {
        let pair = Pair { expected, actual };
        assert_eq!(pair.check(&generous).unwrap_err(), CompareError::NaN { n_nan: 1 });
    }
    let mut infinite = map();
    infinite.texels[5][0] = f32::INFINITY;
    assert!(check(&map(), &infinite).is_err());
}

#[test]
fn another_size_or_too_few_texels_are_found() {
    let mislabelled = Image {
        width_px: HEIGHT,
        height_px: WIDTH,
        ..picture()
    };
    let error = check(&picture(), &mislabelled).unwrap_err();
    assert!(matches!(error, CompareError::SizeDiffers { .. }), "{error}");

    let mut short = picture();
    short.rgba8.truncate(4 * 100);
    let empty = || Image {
        width_px: 0,
        height_px: 0,
        rgba8: Vec::new(),
    };
    for error in [
        check(&picture(), &short),
        check(&short, &picture()),
        check(&empty(), &empty()),
    ] {
        assert!(matches!(error, Err(CompareError::WrongLength { .. })));
    }
}

#[test]
fn a_comparison_that_cannot_fail_is_refused() {
    let (expected, actual) = (picture(), picture());
    let no_checks = Pair {
        expected: &expected,
        actual: &actual,
    }
    .check(&[]);
    assert_eq!(no_checks.unwrap_err(), CompareError::NoChecks);
    assert_eq!(check(&expected, &expected).unwrap_err(), CompareError::SameOrigin);
}

#[test]
fn every_check_counts() {
    let (expected, mut actual) = (picture(), picture());
    actual.rgba8[0] ^= 64;
    let pair = Pair {
        expected: &expected,
        actual: &actual,
    };
    let few = Check::Outliers {
        tolerance: 2.0,
        max_share: 0.01,
    };
    let none = Check::Outliers {
        tolerance: 2.0,
        max_share: 0.0,
    };
    assert!(pair.check(&[few]).is_ok());
    assert!(pair.check(&[few, Check::MaxAbs(64.0)]).is_ok());
    assert!(pair.check(&[few, Check::MaxAbs(63.0)]).is_err());
    assert!(pair.check(&[Check::MaxAbs(64.0), none]).is_err());
    assert!(pair.check(&[Check::MaxAbs(f64::NAN)]).is_err());
}

#[test]
fn goldens_are_found_missing_unreadable_or_different_and_never_written() {
    let folder = Temporary::new("goldens");
    let goldens = Goldens::in_folder(&folder.0.join("goldens"), &folder.0.join("failures"));

    let error = goldens.check("llama", &picture(), EXACT).unwrap_err();
    assert!(matches!(error, GoldenError::Missing { .. }), "{error}");
    assert!(error.to_string().contains("cargo xtask bless"), "{error}");
    assert!(!goldens.path("llama").exists(), "a check writes no golden");

    goldens.write("llama", &picture()).unwrap();
    assert_eq!(goldens.check("llama", &picture(), EXACT).unwrap().max_abs, 0.0);
    let before = fs::read(goldens.path("llama")).unwrap();

    let mut shifted = picture();
    shifted.rgba8.rotate_left(4);
    let error = goldens.check("llama", &shifted, EXACT).unwrap_err();
    assert!(matches!(error, GoldenError::Differs { .. }), "{error}");
    for side in ["expected", "actual", "difference"] {
        assert!(
            folder.0.join(format!("failures/llama.{side}.png")).exists(),
            "{side}"
        );
    }
    let turned = Image {
        width_px: HEIGHT,
        height_px: WIDTH,
        ..picture()
    };
    assert!(goldens.check("llama", &turned, EXACT).is_err());
    assert_eq!(
        fs::read(goldens.path("llama")).unwrap(),
        before,
        "a check changes no golden"
    );

    fs::write(goldens.path("llama"), &before[..before.len() / 2]).unwrap();
    let error = goldens.check("llama", &picture(), EXACT).unwrap_err();
    assert!(matches!(error, GoldenError::Unreadable { .. }), "{error}");
}
