//! The page of the card to print ([`app_core::card`]), with lengths that a ruler can check.

use app_core::card::{Gray, LENS_M, PATTERN_M, SEED, SplitMix, leaves};
use glam::DVec2;
use image::ExtendedColorType;
use image::ImageEncoder;
use image::codecs::png::PngEncoder;

/// Dots per metre in a PNG of 300 dots per inch.
pub const DOTS_PER_M: u32 = 11_811;
/// Distance between the crosses: across, and down the page.
pub const CROSSES_M: DVec2 = DVec2::new(0.150, 0.240);

/// Position and size of the pattern beside the lens.
const BESIDE_M: [DVec2; 2] = [DVec2::new(0.098, 0.158), DVec2::new(0.052, 0.060)];
/// First cross, from the pattern's corner.
const FIRST_CROSS_M: DVec2 = DVec2::new(0.0, -0.008);
/// Start of the ruler, and its length.
const RULER_M: DVec2 = DVec2::new(0.025, 0.224);
const RULER_LENGTH_M: f64 = 0.100;
/// Half the length of a cross's arm.
const ARM_M: f64 = 0.005;
const LINE_M: f64 = 0.000_35;

/// A page to print on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paper {
    /// 210 x 297 mm.
    A4,
    /// 8.5 x 11 inches.
    Letter,
}

impl Paper {
    /// All papers.
    pub const ALL: [Self; 2] = [Self::A4, Self::Letter];

    /// The paper's part of a file's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::A4 => "a4",
            Self::Letter => "letter",
        }
    }

    /// Size of the paper.
    #[must_use]
    pub fn size_m(self) -> DVec2 {
        match self {
            Self::A4 => DVec2::new(0.210, 0.297),
            Self::Letter => DVec2::new(0.2159, 0.2794),
        }
    }

    /// Position of the pattern's upper left corner on the page.
    fn pattern_at_m(self) -> DVec2 {
        0.5 * (self.size_m() - CROSSES_M) - FIRST_CROSS_M
    }

    /// Centres of the four crosses, from the page's upper left corner.
    #[must_use]
    pub fn crosses_m(self) -> [DVec2; 4] {
        let first = self.pattern_at_m() + FIRST_CROSS_M;
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| first + DVec2::new(x, y) * CROSSES_M)
    }
}

/// The file of a picture, with its dots per metre.
///
/// # Errors
/// When the encoder fails.
pub fn png(gray: &Gray) -> Result<Vec<u8>, image::ImageError> {
    let mut png = Vec::new();
    let [width, height] = gray.size_px;
    PngEncoder::new(&mut png).write_image(&gray.codes, width, height, ExtendedColorType::L8)?;
    // Signature and header, which is the first chunk. Source: PNG specification (W3C, third edition), sections 5.2 and 11.3.4.3.
    png.splice(33..33, density_chunk(gray.dots_per_m));
    Ok(png)
}

fn density_chunk(dots_per_m: u32) -> Vec<u8> {
    let mut named = b"pHYs".to_vec();
    named.extend(dots_per_m.to_be_bytes());
    named.extend(dots_per_m.to_be_bytes());
    // The unit is a metre.
    named.push(1);
    let checksum = crc32fast::hash(&named);
    let mut chunk = 9_u32.to_be_bytes().to_vec();
    chunk.extend(named);
    chunk.extend(checksum.to_be_bytes());
    chunk
}

/// The page as a picture.
#[must_use]
pub fn page(paper: Paper) -> Gray {
    let mut page = Gray::white(paper.size_m(), DOTS_PER_M);
    let at = paper.pattern_at_m();
    let mut random = SplitMix::new(SEED);
    leaves(&mut page, [at, DVec2::splat(PATTERN_M)], &mut random);
    leaves(&mut page, [at + BESIDE_M[0], BESIDE_M[1]], &mut random);
    // Black, so that a lamp's reflection on the lens stands out in an underexposed picture.
    page.rectangle(at + LENS_M[0], LENS_M[1], 0);
    let inner = DVec2::splat(0.002);
    words(&mut page, at + LENS_M[0] + 2.0 * inner, "LENS", 255);
    for cross in paper.crosses_m() {
        for along in [DVec2::X, DVec2::Y] {
            let half = ARM_M * along + 0.5 * LINE_M * (DVec2::ONE - along);
            page.rectangle(cross - half, 2.0 * half, 0);
        }
    }
    let ruler = at + RULER_M;
    page.rectangle(ruler, DVec2::new(RULER_LENGTH_M, LINE_M), 0);
    for tick in 0..=10 {
        let length = if tick % 5 == 0 { 0.005 } else { 0.003 };
        let x = RULER_LENGTH_M * f64::from(tick) / 10.0 - 0.5 * LINE_M;
        page.rectangle(ruler + DVec2::new(x, -length), DVec2::new(LINE_M, length), 0);
    }
    words(&mut page, ruler + DVec2::new(0.106, -0.004), "100 mm", 0);
    page
}

/// Rows of five dots, the highest bit leftmost.
fn glyph(letter: char) -> [u8; 7] {
    match letter {
        '0' => [14, 17, 19, 21, 25, 17, 14],
        '1' => [4, 12, 4, 4, 4, 4, 14],
        'E' => [31, 16, 16, 30, 16, 16, 31],
        'L' => [16, 16, 16, 16, 16, 16, 31],
        'N' => [17, 25, 21, 19, 17, 17, 17],
        'S' => [15, 16, 16, 14, 1, 1, 30],
        'm' => [0, 0, 26, 21, 21, 21, 21],
        _ => [0; 7],
    }
}

fn words(gray: &mut Gray, at: DVec2, text: &str, code: u8) {
    const DOT_M: f64 = 0.000_5;
    let mut left = at;
    for letter in text.chars() {
        for (row, y) in glyph(letter).into_iter().zip(0_u8..) {
            for x in (0_u8..5).filter(|x| row >> (4 - x) & 1 == 1) {
                let dot = left + DOT_M * DVec2::new(f64::from(x), f64::from(y));
                gray.rectangle(dot, DVec2::splat(DOT_M), code);
            }
        }
        left.x += 6.0 * DOT_M;
    }
}
