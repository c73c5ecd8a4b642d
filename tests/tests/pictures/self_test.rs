//! The core's self-test: every preset passes it here, and faults of a device fail it.

use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::self_test::{self, Difference, SIZE_PX, SelfTestError};

/// A picture whose pixels are functions of another's.
fn changed(picture: &Image, pixel: impl Fn(usize, usize) -> [u8; 4]) -> Image {
    let [width, height] = SIZE_PX.map(|side| side as usize);
    let pixels = (0..width * height).flat_map(|i| pixel(i % width, i / width));
    Image {
        rgba8: pixels.collect(),
        ..picture.clone()
    }
}

fn at(picture: &Image, x: usize, y: usize) -> [u8; 4] {
    let i = 4 * (y * SIZE_PX[0] as usize + x);
    picture.rgba8[i..i + 4].try_into().unwrap()
}

/// Possible faults of a device, by their effect on the picture.
fn faults(picture: &Image) -> Vec<(&'static str, Image)> {
    let [width, height] = SIZE_PX.map(|side| side as usize);
    let photograph = self_test::photograph().unwrap();
    let is_shadow = |x, y| {
        let [before, after] = [at(&photograph, x, y), at(picture, x, y)];
        // The code is darker than in the photograph in a lit part of the table.
        before
            .iter()
            .zip(after)
            .all(|(before, after)| *before == 255 || *before > after + 30)
    };
    let gamma = |code: u8| {
        let linear = f64::from(code) / 255.0;
        #[expect(clippy::cast_possible_truncation, reason = "a code")]
        let code = (255.0 * linear.powf(1.1)).round() as u8;
        code
    };
    let recoloured = |color: &dyn Fn([u8; 4]) -> [u8; 4]| changed(picture, |x, y| color(at(picture, x, y)));
    let replaced = |is_replaced: &dyn Fn(usize, usize) -> bool, by: &dyn Fn(usize, usize) -> [u8; 4]| {
        changed(picture, |x, y| {
            if is_replaced(x, y) {
                by(x, y)
            } else {
                at(picture, x, y)
            }
        })
    };
    let black = |_, _| [0, 0, 0, 255];
    #[rustfmt::skip] // One fault a line.
    let faults = vec![
        ("red is blue", recoloured(&|[r, g, b, a]| [b, g, r, a])),
        ("one pixel to the right", changed(picture, |x, y| at(picture, x.saturating_sub(1), y))),
        ("one pixel down", changed(picture, |x, y| at(picture, x, y.saturating_sub(1)))),
        ("upside down", changed(picture, |x, y| at(picture, x, height - 1 - y))),
        ("mirrored", changed(picture, |x, y| at(picture, width - 1 - x, y))),
        ("black shadow", replaced(&is_shadow, &black)),
        ("no shadow", replaced(&is_shadow, &|x, y| at(&photograph, x, y))),
        ("another transfer function", recoloured(&|[r, g, b, a]| [gamma(r), gamma(g), gamma(b), a])),
        ("a tile that is missing", replaced(&|x, y| x / 16 == 2 && y / 16 == 1, &black)),
        ("the toy as it stands", photograph.clone()),
        ("black", changed(picture, black)),
    ];
    faults
}

#[test]
fn every_preset_passes_and_no_fault_does() {
    let mut core = harness::open_core();
    for &preset in Preset::ALL {
        let picture = self_test::render(&mut core, preset).unwrap();
        let difference = self_test::check(&picture, preset);
        let Ok(Difference {
            worst_codes,
            mean_codes,
        }) = difference
        else {
            panic!("{preset}: {difference:?}");
        };
        println!("{preset}: {worst_codes:.2} {mean_codes:.2}");
        for (fault, broken) in faults(&picture) {
            let checked = self_test::check(&broken, preset);
            let Err(SelfTestError::Differs(difference)) = checked else {
                panic!("{preset}, {fault}: {checked:?}");
            };
            println!("{preset}, {fault}: {difference:?}");
        }
        let small = Image {
            width_px: 63,
            ..picture
        };
        assert!(matches!(
            self_test::check(&small, preset),
            Err(SelfTestError::Size { .. })
        ));
        // It leaves nothing on the screen.
        assert!(core.read_picture().is_err());
    }
}
