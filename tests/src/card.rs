//! A card to print and to lay on the table: something patterned for a tracker to hold on to, with a place for the lens of a light
//! probe and lengths that a ruler can check.
//!
//! The pattern is one of dead leaves: shapes of many sizes, drawn one over the other in an order by chance, so that there are
//! corners at every scale. It is the same wherever it is drawn.

use glam::{DMat2, DVec2};
use image::ExtendedColorType;
use image::ImageEncoder;
use image::codecs::png::PngEncoder;

use crate::random::Random;

/// Dots of a printed metre at 300 dots an inch, as PNG counts them.
pub const DOTS_PER_M: u32 = 11_811;
/// Side of the square pattern, which a platform knows as an image of this width.
pub const PATTERN_M: f64 = 0.150;
/// Distance between the crosses: across, and down the page.
pub const CROSSES_M: DVec2 = DVec2::new(0.150, 0.240);
/// Pixels along a side of the picture for a platform.
pub const REFERENCE_PX: u32 = 600;

/// Place for a lens of the size of a bank card, with some room: its corner and its size, from the pattern's corner.
const LENS_M: [DVec2; 2] = [DVec2::new(0.0, 0.158), DVec2::new(0.092, 0.060)];
/// The pattern beside it.
const BESIDE_M: [DVec2; 2] = [DVec2::new(0.098, 0.158), DVec2::new(0.052, 0.060)];
/// First cross, from the pattern's corner.
const FIRST_CROSS_M: DVec2 = DVec2::new(0.0, -0.008);
/// Beginning of the ruler, and its length.
const RULER_M: DVec2 = DVec2::new(0.025, 0.224);
const RULER_LENGTH_M: f64 = 0.100;
/// Half a cross.
const ARM_M: f64 = 0.005;
const LINE_M: f64 = 0.000_35;

/// Leaves a square metre, and their radii.
const LEAVES_PER_M2: f64 = 300_000.0;
const RADII_M: [f64; 2] = [0.001, 0.005];
const SEED: u64 = 13;
/// The grey of a leaf: far apart, and more black and white than between.
const GRAYS: [u8; 6] = [0, 0, 90, 165, 255, 255];

/// A page to print on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paper {
    /// 210 x 297 mm.
    A4,
    /// 8.5 x 11 inches.
    Letter,
}

impl Paper {
    /// All there are.
    pub const ALL: [Self; 2] = [Self::A4, Self::Letter];

    /// Part of a file's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::A4 => "a4",
            Self::Letter => "letter",
        }
    }

    /// Its size.
    #[must_use]
    pub fn size_m(self) -> DVec2 {
        match self {
            Self::A4 => DVec2::new(0.210, 0.297),
            Self::Letter => DVec2::new(0.2159, 0.2794),
        }
    }

    /// Where the pattern's upper left corner lies on it.
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

/// A picture in greys.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gray {
    /// Width and height.
    pub size_px: [u32; 2],
    /// Rows from the top.
    pub codes: Vec<u8>,
    dots_per_m: u32,
}

impl Gray {
    fn white(size_m: DVec2, dots_per_m: u32) -> Self {
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "some thousand dots"
        )]
        let size_px = (size_m * f64::from(dots_per_m))
            .to_array()
            .map(|side| side.round() as u32);
        Self {
            size_px,
            codes: vec![255; size_px[0] as usize * size_px[1] as usize],
            dots_per_m,
        }
    }

    /// Fills what is inside of a shape and of a rectangle, both in metres.
    fn fill(&mut self, [from_m, to_m]: [DVec2; 2], code: u8, is_inside: impl Fn(DVec2) -> bool) {
        let dots_per_m = f64::from(self.dots_per_m);
        let [width, height] = self.size_px;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to the picture"
        )]
        let within = |at: f64, side: u32| (at * dots_per_m).floor().clamp(0.0, f64::from(side)) as u32;
        for y in within(from_m.y, height)..within(to_m.y + 1.0 / dots_per_m, height) {
            for x in within(from_m.x, width)..within(to_m.x + 1.0 / dots_per_m, width) {
                let at = (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / dots_per_m;
                if at.cmpge(from_m).all() && at.cmple(to_m).all() && is_inside(at) {
                    self.codes[y as usize * width as usize + x as usize] = code;
                }
            }
        }
    }

    fn rectangle(&mut self, from_m: DVec2, size_m: DVec2, code: u8) {
        self.fill([from_m, from_m + size_m], code, |_| true);
    }

    /// The file, with its dots a metre.
    ///
    /// # Errors
    /// When the encoder refuses.
    pub fn png(&self) -> Result<Vec<u8>, image::ImageError> {
        let mut png = Vec::new();
        let [width, height] = self.size_px;
        PngEncoder::new(&mut png).write_image(&self.codes, width, height, ExtendedColorType::L8)?;
        // Signature and header, which is the first chunk. Source: PNG specification (W3C, third edition), sections 5.2 and 11.3.4.3.
        png.splice(33..33, density_chunk(self.dots_per_m));
        Ok(png)
    }
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

/// The page.
#[must_use]
pub fn page(paper: Paper) -> Gray {
    let mut page = Gray::white(paper.size_m(), DOTS_PER_M);
    let at = paper.pattern_at_m();
    let mut random = Random::new(SEED);
    leaves(&mut page, [at, DVec2::splat(PATTERN_M)], &mut random);
    leaves(&mut page, [at + BESIDE_M[0], BESIDE_M[1]], &mut random);
    // Black: what a lamp makes on the lens stands out in an underexposed picture.
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

/// The square pattern alone, small, as a platform takes it to know the card by.
#[must_use]
pub fn reference() -> Gray {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "4000")]
    let dots_per_m = (f64::from(REFERENCE_PX) / PATTERN_M).round() as u32;
    let mut pattern = Gray::white(DVec2::splat(PATTERN_M), dots_per_m);
    leaves(
        &mut pattern,
        [DVec2::ZERO, DVec2::splat(PATTERN_M)],
        &mut Random::new(SEED),
    );
    pattern
}

/// Leaves over a rectangle: corner and size.
fn leaves(gray: &mut Gray, [at, size_m]: [DVec2; 2], random: &mut Random) {
    let area = [at, at + size_m];
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "some thousand"
    )]
    let n = (LEAVES_PER_M2 * size_m.x * size_m.y) as usize;
    for _ in 0..n {
        let center = at + DVec2::new(random.uniform(), random.uniform()) * size_m;
        // As many of each size for what they cover: radii as one over their cube. Source: Lee, Mumford and Huang 2001.
        let [small, large] = RADII_M.map(|radius| radius.powi(-2));
        let radius = (large + (small - large) * random.uniform()).powf(-0.5);
        let turn = DMat2::from_angle(std::f64::consts::TAU * random.uniform());
        let (kind, gray_of) = (random.uniform(), random.uniform());
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "below six"
        )]
        let code = GRAYS[((gray_of * 6.0) as usize).min(5)];
        let reach = DVec2::splat(1.5 * radius);
        let bounds = [(center - reach).max(area[0]), (center + reach).min(area[1])];
        gray.fill(bounds, code, |point| {
            is_in_leaf(turn * (point - center) / radius, kind)
        });
    }
}

/// A square, a triangle, a disc or a bar, of about the same area.
fn is_in_leaf(point: DVec2, kind: f64) -> bool {
    let DVec2 { x, y } = point;
    match kind {
        ..0.35 => x.abs().max(y.abs()) <= 0.9,
        ..0.7 => y >= -0.6 && y <= 1.2 - 1.8 * x.abs(),
        ..0.85 => point.length_squared() <= 1.0,
        _ => x.abs() <= 1.4 && y.abs() <= 0.5,
    }
}

/// Rows of five dots, the highest bit left.
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
