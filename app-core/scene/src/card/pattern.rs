//! The pattern of dead leaves: shapes of many sizes, drawn one over the other in a random order, so
//! that there are corners at every scale. The generator is deterministic.

use glam::{DMat2, DVec2};

use super::split_mix::SplitMix;

/// Side of the square pattern, which is the image width for a platform.
pub const PATTERN_M: f64 = 0.150;
/// Pixels along a side of the platform's reference image.
pub const REFERENCE_PX: u32 = 600;
/// Leaves per square metre, and their radii.
const LEAVES_PER_M2: f64 = 300_000.0;
const RADII_M: [f64; 2] = [0.001, 0.005];
/// Seed of the pattern.
pub const SEED: u64 = 13;
/// The grey levels of leaves: far apart, with more black and white than others.
const GRAYS: [u8; 6] = [0, 0, 90, 165, 255, 255];

/// A grey picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gray {
    /// Width and height.
    pub size_px: [u32; 2],
    /// Rows from the top.
    pub codes: Vec<u8>,
    /// Dots per metre.
    pub dots_per_m: u32,
}

impl Gray {
    /// A white picture.
    #[must_use]
    pub fn white(size_m: DVec2, dots_per_m: u32) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "some thousand dots")]
        let size_px = (size_m * f64::from(dots_per_m))
            .to_array()
            .map(|side| side.round() as u32);
        Self {
            size_px,
            codes: vec![255; size_px[0] as usize * size_px[1] as usize],
            dots_per_m,
        }
    }

    /// Fills the intersection of a shape and a rectangle, both in metres.
    fn fill(&mut self, [from_m, to_m]: [DVec2; 2], code: u8, is_inside: impl Fn(DVec2) -> bool) {
        let dots_per_m = f64::from(self.dots_per_m);
        let [width, height] = self.size_px;
        #[allow(clippy::cast_possible_truncation, reason = "clamped to the picture")]
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

    /// Fills a rectangle: corner and size, in metres.
    pub fn rectangle(&mut self, from_m: DVec2, size_m: DVec2, code: u8) {
        self.fill([from_m, from_m + size_m], code, |_| true);
    }
}

/// The square pattern alone, small, as a platform's reference image of the card.
#[must_use]
pub fn reference() -> Gray {
    #[allow(clippy::cast_possible_truncation, reason = "4000")]
    let dots_per_m = (f64::from(REFERENCE_PX) / PATTERN_M).round() as u32;
    let mut pattern = Gray::white(DVec2::splat(PATTERN_M), dots_per_m);
    leaves(
        &mut pattern,
        [DVec2::ZERO, DVec2::splat(PATTERN_M)],
        &mut SplitMix::new(SEED),
    );
    pattern
}

/// Draws leaves over a rectangle: corner and size.
pub fn leaves(gray: &mut Gray, [at, size_m]: [DVec2; 2], random: &mut SplitMix) {
    let area = [at, at + size_m];
    #[allow(clippy::cast_possible_truncation, reason = "some thousand")]
    let n = (LEAVES_PER_M2 * size_m.x * size_m.y) as usize;
    for _ in 0..n {
        let center = at + DVec2::new(random.uniform(), random.uniform()) * size_m;
        // Radii are distributed as one over their cube, so that all sizes cover equal areas.
        // Source: Lee, Mumford and Huang 2001.
        let [small, large] = RADII_M.map(|radius| radius.powi(-2));
        let radius = (large + (small - large) * random.uniform()).powf(-0.5);
        let turn = DMat2::from_angle(std::f64::consts::TAU * random.uniform());
        let (kind, gray_of) = (random.uniform(), random.uniform());
        #[allow(clippy::cast_possible_truncation, reason = "below six")]
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
