//! Camera frames as phones deliver them: layouts of planes, time, blending, and placement on a
//! screen.

use app_core::camera_frame::{
    Arrival, Arrivals, CameraImage, CodeRange, Display, Fade, Fit, LONGEST_GAP_S, LumaCoefficients,
    PlanarImage, Plane, PlaneError, Planes, Stamp, YcbcrEncoding,
};
use glam::{DVec2, DVec3};
use reference::camera_planes::{chroma_at, decoded};

const FULL_601: YcbcrEncoding = YcbcrEncoding {
    coefficients: LumaCoefficients::Bt601,
    range: CodeRange::Full,
};
const VIDEO_601: YcbcrEncoding = YcbcrEncoding {
    range: CodeRange::Video,
    ..FULL_601
};
const VIDEO_709: YcbcrEncoding = YcbcrEncoding {
    coefficients: LumaCoefficients::Bt709,
    range: CodeRange::Video,
};

/// Colour bars at full amplitude from the tables of the standards and of JFIF, rounded to codes:
/// luma, Cb, Cr, then red, green, blue.
const BARS: [(YcbcrEncoding, [u8; 3], [u8; 3]); 15] = [
    (FULL_601, [255, 128, 128], [255, 255, 255]),
    (FULL_601, [0, 128, 128], [0, 0, 0]),
    (FULL_601, [76, 85, 255], [255, 0, 0]),
    (FULL_601, [150, 44, 21], [0, 255, 0]),
    (FULL_601, [29, 255, 107], [0, 0, 255]),
    (VIDEO_601, [235, 128, 128], [255, 255, 255]),
    (VIDEO_601, [16, 128, 128], [0, 0, 0]),
    (VIDEO_601, [81, 90, 240], [255, 0, 0]),
    (VIDEO_601, [145, 54, 34], [0, 255, 0]),
    (VIDEO_601, [41, 240, 110], [0, 0, 255]),
    (VIDEO_709, [235, 128, 128], [255, 255, 255]),
    (VIDEO_709, [63, 102, 240], [255, 0, 0]),
    (VIDEO_709, [173, 42, 26], [0, 255, 0]),
    (VIDEO_709, [32, 240, 118], [0, 0, 255]),
    (VIDEO_709, [219, 16, 138], [255, 255, 0]),
];

fn first_pixel(encoding: YcbcrEncoding, ycbcr: [u8; 3]) -> [u8; 4] {
    let [luma, blue, red] = [0, 1, 2].map(|k| (&ycbcr[k..=k], 1));
    let planes = Planes::i420([1, 1], luma, blue, red, encoding);
    let image = PlanarImage::new(&planes).unwrap();
    image.rgba().rgba8[..].try_into().unwrap()
}

#[test]
fn colour_bars_have_their_colours() {
    for (encoding, ycbcr, rgb) in BARS {
        let pixel = first_pixel(encoding, ycbcr);
        // Half a code of each of the three, times 1.86 at most.
        let worst = (0..3).map(|k| pixel[k].abs_diff(rgb[k])).max().unwrap();
        assert!(worst <= 2, "{encoding:?} {ycbcr:?}: {pixel:?}, not {rgb:?}");
    }
    // The reds of two standards differ: a table that is read with the wrong coefficients would be
    // detected.
    let mistaken = first_pixel(VIDEO_601, [63, 102, 240]);
    assert!(mistaken[0].abs_diff(255) > 20, "{mistaken:?}");
}

fn number(at: usize) -> u8 {
    u8::try_from(at * 37 % 251).unwrap()
}

const SIZE_PX: [u32; 2] = [7, 5];
const HALF: [usize; 2] = [4, 3];

fn luma_of(row: usize, column: usize) -> u8 {
    number(11 + 7 * row + column)
}
fn blue_of(row: usize, column: usize) -> u8 {
    number(101 + 4 * row + column)
}
fn red_of(row: usize, column: usize) -> u8 {
    number(201 + 4 * row + column)
}

/// Rows of samples `row_stride` bytes apart with other bytes between them; the last row ends with
/// its last sample.
fn padded(
    [columns, rows]: [usize; 2],
    (row_stride, pixel_stride): (usize, usize),
    sample: impl Fn(usize, usize) -> u8,
) -> Vec<u8> {
    let mut bytes = vec![77; (rows - 1) * row_stride + (columns - 1) * pixel_stride + 1];
    for row in 0..rows {
        for column in 0..columns {
            bytes[row * row_stride + column * pixel_stride] = sample(row, column);
        }
    }
    bytes
}

/// Two components, interleaved.
fn pairs(row_stride: usize, samples: [fn(usize, usize) -> u8; 2]) -> Vec<u8> {
    let mut bytes = vec![77; 2 * row_stride + 2 * HALF[0]];
    for row in 0..HALF[1] {
        for column in 0..HALF[0] {
            for (k, sample) in samples.iter().enumerate() {
                bytes[row * row_stride + 2 * column + k] = sample(row, column);
            }
        }
    }
    bytes
}

#[test]
fn every_layout_is_the_same_picture() {
    let luma = padded([7, 5], (16, 1), luma_of);
    let [blue, red] = [blue_of, red_of].map(|sample| padded(HALF, (9, 1), sample));
    let [blue_red, red_blue] = [[blue_of, red_of], [red_of, blue_of]].map(|order| pairs(12, order));
    let strided = [&blue_red[..blue_red.len() - 1], &blue_red[1..]].map(|bytes| Plane {
        bytes,
        row_stride: 12,
        pixel_stride: 2,
    });
    #[rustfmt::skip] // One layout a line.
    let layouts = [
        ("I420", Planes::i420(SIZE_PX, (&luma, 16), (&blue, 9), (&red, 9), FULL_601)),
        ("NV12", Planes::nv12(SIZE_PX, (&luma, 16), (&blue_red, 12), FULL_601)),
        ("NV21", Planes::nv21(SIZE_PX, (&luma, 16), (&red_blue, 12), FULL_601)),
        ("as Android's Image has NV12, each plane a byte short", Planes { blue: strided[0], red: strided[1], ..Planes::i420(SIZE_PX, (&luma, 16), (&blue, 9), (&red, 9), FULL_601) }),
    ];
    let expected = PlanarImage::new(&layouts[0].1).unwrap();
    for (name, planes) in &layouts {
        let image = PlanarImage::new(planes).unwrap();
        assert_eq!(image.luma(), expected.luma(), "{name}");
        assert_eq!(image.chroma(), expected.chroma(), "{name}");
    }
    let swapped = PlanarImage::new(&Planes::nv21(SIZE_PX, (&luma, 16), (&blue_red, 12), FULL_601)).unwrap();
    assert_ne!(
        swapped.chroma(),
        expected.chroma(),
        "Cb and Cr may be taken for each other"
    );
    for (at, byte) in expected.luma().iter().enumerate() {
        assert_eq!(*byte, luma_of(at / 7, at % 7));
    }
}

#[test]
fn pixels_are_those_of_the_reference() {
    let luma = padded([7, 5], (7, 1), luma_of);
    let [blue, red] = [blue_of, red_of].map(|sample| padded(HALF, (4, 1), sample));
    let planes = Planes::i420(SIZE_PX, (&luma, 7), (&blue, 4), (&red, 4), VIDEO_709);
    let image = PlanarImage::new(&planes).unwrap();
    let at = |sample: fn(usize, usize) -> u8, pixel| {
        let value = |x: i64, y: i64| f64::from(sample(y.try_into().unwrap(), x.try_into().unwrap()));
        chroma_at(value, [4, 3], pixel)
    };
    for (index, actual) in image.rgba().rgba8.chunks_exact(4).enumerate() {
        let (x, y) = (
            u32::try_from(index % 7).unwrap(),
            u32::try_from(index / 7).unwrap(),
        );
        let luma = f64::from(luma_of(index / 7, index % 7));
        let expected = decoded(VIDEO_709, [luma, at(blue_of, [x, y]), at(red_of, [x, y])]);
        let actual = DVec3::from([actual[0], actual[1], actual[2]].map(f64::from));
        // Rounding to codes, and to 32 bits.
        let error = (actual - expected).abs().max_element();
        assert!(error < 0.51, "at {x}, {y}: {actual}, not {expected}");
    }
}

#[test]
fn planes_that_hold_no_picture_are_refused_by_name() {
    let (luma, chroma) = (vec![0; 7 * 5], vec![0; 4 * 3]);
    let planes = Planes::i420(SIZE_PX, (&luma, 7), (&chroma, 4), (&chroma, 4), FULL_601);
    assert!(PlanarImage::new(&planes).is_ok());
    let error = |planes: Planes<'_>| PlanarImage::new(&planes).err().map(|error| error.to_string());
    let short = Plane {
        bytes: &chroma[..11],
        row_stride: 4,
        pixel_stride: 1,
    };
    #[rustfmt::skip] // One case a line.
    let cases = [
        (Planes { size_px: [0, 5], ..planes }, "camera planes: 0 x 5 px"),
        (Planes { size_px: [7, 9000], ..planes }, "camera planes: 7 x 9000 px"),
        (Planes { red: short, ..planes }, "camera planes, Cr: 11 bytes, 12 are needed"),
        (Planes::i420(SIZE_PX, (&luma, 6), (&chroma, 4), (&chroma, 4), FULL_601), "camera planes, luma: rows 6 and samples 1 bytes apart cannot hold 7 samples a row"),
        (Planes { blue: Plane { pixel_stride: 0, ..short }, ..planes }, "camera planes, Cb: rows 4 and samples 0 bytes apart"),
        (Planes { blue: Plane { row_stride: usize::MAX, ..short }, ..planes }, "camera planes, Cb: rows 18446744073709551615"),
    ];
    for (planes, expected) in cases {
        let error = error(planes).unwrap_or_default();
        assert!(error.starts_with(expected), "{error:?}, not {expected:?}");
    }
    assert!(matches!(
        PlanarImage::new(&Planes::nv12(SIZE_PX, (&luma, 7), (&[], 8), FULL_601)),
        Err(PlaneError::TooShort { plane: "Cb", .. })
    ));
}

fn stamp(id: u64, time_ms: i64, world_epoch: u32) -> Stamp {
    Stamp {
        id,
        time_ns: time_ms * 1_000_000,
        world_epoch,
    }
}

#[test]
fn frames_that_come_late_twice_or_after_a_gap_have_a_stated_result() {
    let mut arrivals = Arrivals::default();
    let mut arrive = |id, time_ms, epoch| arrivals.arrive(stamp(id, time_ms, epoch));
    let next = |arrival: Arrival, ms: f64| match arrival {
        Arrival::Next { elapsed_s } => (1e3 * elapsed_s - ms).abs() < 1e-9,
        _ => false,
    };
    assert_eq!(arrive(1, -1000, 0), Arrival::First);
    assert!(next(arrive(2, -983, 0), 17.0));
    assert!(next(arrive(3, -950, 0), 33.0));
    assert!(
        next(arrive(5, -900, 0), 50.0),
        "a frame was dropped before it reached us"
    );
    assert_eq!(arrive(5, -900, 0), Arrival::Again);
    assert_eq!(
        arrive(6, -900, 0),
        Arrival::Again,
        "the same moment under another number"
    );
    assert_eq!(arrive(4, -930, 0), Arrival::Late);
    assert!(
        next(arrive(7, -867, 0), 33.0),
        "what was not taken does not count"
    );
    let late = arrive(8, 0, 0);
    assert!(matches!(late, Arrival::AfterGap { elapsed_s } if (elapsed_s - 0.867).abs() < 1e-9));
    assert_eq!([late.filtered_s(), late.counted_s()], [0.0, LONGEST_GAP_S]);
    assert_eq!(arrive(9, -500, 1), Arrival::NewWorld, "its clock may begin anew");
    assert_eq!(arrive(10, 33, 0), Arrival::Late, "of the world before");
    assert!(next(arrive(11, -467, 1), 33.0));
    let far = [i64::MIN, i64::MAX].map(|time_ns| Stamp {
        time_ns,
        ..stamp(0, 0, 0)
    });
    let mut arrivals = Arrivals::default();
    arrivals.arrive(far[0]);
    assert!(matches!(arrivals.arrive(far[1]), Arrival::AfterGap { elapsed_s } if elapsed_s > 1e10));
}

#[test]
fn the_effect_goes_faster_than_it_comes_and_never_jumps() {
    let mut fade = Fade::default();
    assert_eq!(fade.effect(), 0.0);
    let mut frames = |is_known: bool, end: f64| {
        let mut before = fade.effect();
        (1..100).find(|_| {
            fade.step(1.0 / 60.0, is_known);
            assert!(
                (fade.effect() - before).abs() < 0.2,
                "{before} to {}",
                fade.effect()
            );
            before = fade.effect();
            before == end
        })
    };
    assert_eq!(frames(true, 1.0), Some(24));
    assert_eq!(frames(false, 0.0), Some(9));
    fade.step(f64::NAN, true);
    fade.step(-1.0, true);
    assert_eq!(fade.effect(), 0.0);
    fade.step(60.0, true);
    assert_eq!(fade.effect(), 1.0);
}

#[test]
fn a_screen_shows_the_middle_upright_and_its_corners_where_they_belong() {
    let image_px = [1920, 1440];
    let of = |quarter_turns, fit, screen_px, at: [f64; 2]| {
        let display = Display { quarter_turns, fit };
        display
            .image_from_screen(image_px, screen_px)
            .transform_point2(DVec2::from(at))
    };
    for quarter_turns in 0..4 {
        for (fit, screen_px) in [(Fit::Fill, [1125, 2436]), (Fit::Whole, [2436, 1125])] {
            let middle = screen_px.map(|side| f64::from(side) / 2.0);
            let at = of(quarter_turns, fit, screen_px, middle);
            assert!(at.abs_diff_eq(DVec2::new(960.0, 720.0), 1e-9), "{at}");
        }
    }
    // A phone in upright position shows the sensor's landscape picture turned clockwise: its left
    // border is at the top.
    let portrait = [1125, 2436];
    let scale = 1920.0 / 2436.0;
    let top_middle = of(1, Fit::Fill, portrait, [562.5, 0.0]);
    assert!(
        top_middle.abs_diff_eq(DVec2::new(0.0, 720.0), 1e-9),
        "{top_middle}"
    );
    let right = of(1, Fit::Fill, portrait, [1125.0, 1218.0]);
    assert!(
        right.abs_diff_eq(DVec2::new(960.0, 720.0 - 562.5 * scale), 1e-9),
        "{right}"
    );
    // Three quarter turns are one in the other direction, two are upside down.
    let top_middle = of(3, Fit::Fill, portrait, [562.5, 0.0]);
    assert!(
        top_middle.abs_diff_eq(DVec2::new(1920.0, 720.0), 1e-9),
        "{top_middle}"
    );
    let origin = of(2, Fit::Fill, [1920, 1440], [0.0, 0.0]);
    assert!(origin.abs_diff_eq(DVec2::new(1920.0, 1440.0), 1e-9), "{origin}");
    // A screen twice as wide: the whole picture leaves half of it black; a picture that fills the
    // screen loses half of itself.
    let left = of(0, Fit::Whole, [3840, 1440], [960.0, 0.0]);
    assert!(left.abs_diff_eq(DVec2::ZERO, 1e-9), "{left}");
    let top = of(0, Fit::Fill, [3840, 1440], [0.0, 0.0]);
    assert!(top.abs_diff_eq(DVec2::new(0.0, 360.0), 1e-9), "{top}");
}

#[test]
fn a_picture_of_planes_is_decoded_once() {
    let planes = Planes::i420([2, 2], (&[9; 4], 2), (&[128], 1), (&[128], 1), FULL_601);
    let image = CameraImage::from(PlanarImage::new(&planes).unwrap());
    assert!(std::sync::Arc::ptr_eq(image.rgba(), image.clone().rgba()));
    assert_eq!(image.rgba().rgba8, [9, 9, 9, 255].repeat(4));
}

#[test]
fn a_picture_is_as_old_as_a_clock_of_the_same_kind_tells() {
    let stamp = Stamp {
        id: 0,
        time_ns: 5_000_000_000,
        world_epoch: 0,
    };
    assert_eq!(stamp.age_ms(5_041_500_000), Some(41.5));
    assert_eq!(stamp.age_ms(5_000_000_000), Some(0.0));
    // Another clock, by which the picture is from the future, or very old.
    for now_ns in [4_999_999_999, 6_000_000_001, i64::MIN, i64::MAX] {
        assert_eq!(stamp.age_ms(now_ns), None, "{now_ns}");
    }
}
