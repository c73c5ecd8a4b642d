//! Where the outline is to a fraction of a pixel, by how much of each pixel beside it the toy covers.
//!
//! A pixel there is a mixture of toy and background: alpha matting, with a background that the plate tells. Colours are
//! carried across the band from just inside and just outside it.

use glam::{DVec2, IVec2};

use super::contour::Element;
use super::motion::Measured;
use crate::picture::{Color, Level, index_in, noise_deviation, places};
use crate::raster::Coverage;

/// What colours that are carried across the band are wrong by, over the contrast.
const CARRIED: f32 = 0.05;
/// Linear light that ratios to the plate are taken above, where a plate is black in a channel.
const FLOOR: f32 = 5e-4;
/// Samples of colour on either side of the band, and where the first is beyond it, in pixels.
const N_SAMPLES: i32 = 3;
const BEYOND_PX: f64 = 0.75;
/// Covered as much, a pixel shows the toy alone; the same for its background.
const ALONE: f32 = 0.001;
/// Mixtures beyond 0 and 1 by noise; further ones are something else.
const MOST_BEYOND: f32 = 0.5;

/// The band of pixels that are read beside the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Band {
    /// Half its width.
    pub(super) half_px: f64,
    /// Displacements beyond count less: scale of the Geman-McClure weights.
    pub(super) robust_px: f64,
}

impl Band {
    /// Mean loss of what was measured, in square pixels: its mean square, but that a piece counts at most `robust_px`.
    pub(super) fn loss_px2(&self, measured: &[Measured]) -> f64 {
        let scale = self.robust_px * self.robust_px;
        let (mut sum, mut total) = (0.0, 0.0);
        for one in measured {
            let weight = one.precision * one.element.length_px;
            let square = one.offset_px * one.offset_px;
            sum += weight * scale * square / (scale + square);
            total += weight;
        }
        if total > 0.0 { sum / total } else { scale }
    }
}

/// Measures each piece's displacement: the covered area that the picture has beyond the model's, over its length.
pub(super) fn measure(level: &Level, coverage: &Coverage, elements: &[Element], band: Band) -> Vec<Measured> {
    if elements.is_empty() {
        return Vec::new();
    }
    let mut pieces: Vec<Piece> = elements
        .iter()
        .map(|element| Piece::new(level, coverage, element, band.half_px))
        .collect();
    let owners = Owners::new(elements, coverage, band.half_px);
    for (at, owner) in owners.pixels() {
        pieces[owner].add(level, at, coverage.at(at));
    }
    let measured = elements
        .iter()
        .zip(&pieces)
        .filter_map(|(element, piece)| piece.measured(element, band));
    measured.collect()
}

/// Colours on both sides of a piece of the outline.
#[derive(Clone, Copy)]
struct Sides {
    toy: Color,
    /// Of the background over the plate; without a plate the background itself.
    ratio: Color,
}

/// What the pixels beside a piece of the outline say.
#[derive(Clone, Copy)]
struct Piece {
    sides: Option<Sides>,
    /// In square pixels.
    more_area: f32,
    contrast: f32,
    n_pixels: f32,
    has_unknown: bool,
}

impl Piece {
    fn new(level: &Level, coverage: &Coverage, element: &Element, half_px: f64) -> Self {
        Self {
            sides: sides(level, coverage, element, half_px),
            more_area: 0.0,
            contrast: 0.0,
            n_pixels: 0.0,
            has_unknown: false,
        }
    }

    fn add(&mut self, level: &Level, at: IVec2, covered: f32) {
        let (Some(sides), Some(seen), Some(plate)) = (self.sides, level.frame.get(at), plate_at(level, at))
        else {
            self.has_unknown = true;
            return;
        };
        let (mut along, mut contrast) = (0.0, 0.0);
        for channel in 0..3 {
            let background = (sides.ratio[channel] * (plate[channel] + FLOOR) - FLOOR).max(0.0);
            let apart = sides.toy[channel] - background;
            let middle = 0.5 * (sides.toy[channel] + background);
            let variance = noise_deviation(middle).powi(2);
            along += (seen[channel] - background) * apart / variance;
            contrast += apart * apart / variance;
        }
        self.n_pixels += 1.0;
        if contrast > 0.0 {
            let alpha = (along / contrast).clamp(-MOST_BEYOND, 1.0 + MOST_BEYOND);
            self.more_area += alpha - covered;
            self.contrast += contrast;
        }
    }

    fn measured(&self, element: &Element, band: Band) -> Option<Measured> {
        if self.has_unknown || self.contrast <= 0.0 {
            return None;
        }
        let offset_px = f64::from(self.more_area) / element.length_px;
        let noise = self.n_pixels / self.contrast;
        let excess = (offset_px / band.robust_px).powi(2);
        Some(Measured {
            element: *element,
            offset_px: offset_px.clamp(-band.half_px, band.half_px),
            precision: f64::from(1.0 / (noise + CARRIED * CARRIED)),
            robust: 1.0 / (1.0 + excess).powi(2),
        })
    }
}

fn plate_at(level: &Level, at: IVec2) -> Option<Color> {
    match &level.plate {
        Some(plate) => plate.get(at),
        None => Some([1.0; 3]),
    }
}

/// Means of the toy just within the band and of the background just beyond it, along the normal.
fn sides(level: &Level, coverage: &Coverage, element: &Element, half_px: f64) -> Option<Sides> {
    let (mut toy, mut background, mut plate) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    let (mut n_toy, mut n_background) = (0.0, 0.0);
    for sample in 0..N_SAMPLES {
        let distance_px = half_px + BEYOND_PX + f64::from(sample);
        let inside = element.pixel(-distance_px);
        if coverage.at(inside) > 1.0 - ALONE {
            toy = plus(toy, level.frame.get(inside)?);
            n_toy += 1.0;
        }
        let outside = element.pixel(distance_px);
        if coverage.at(outside) < ALONE {
            background = plus(background, level.frame.get(outside)?);
            plate = plus(plate, plate_at(level, outside)?);
            n_background += 1.0;
        }
    }
    (n_toy > 0.0 && n_background > 0.0).then(|| Sides {
        toy: toy.map(|sum| sum / n_toy),
        ratio: [0, 1, 2].map(|channel| {
            let floor = n_background * FLOOR;
            (background[channel] + floor) / (plate[channel] + floor)
        }),
    })
}

fn plus(a: Color, b: Color) -> Color {
    [0, 1, 2].map(|channel| a[channel] + b[channel])
}

/// The piece of the outline that each pixel of the band is nearest to.
struct Owners {
    origin_px: IVec2,
    size_px: IVec2,
    /// Index of the piece, with the distance squared.
    nearest: Vec<Option<(usize, f64)>>,
}

impl Owners {
    fn new(elements: &[Element], coverage: &Coverage, half_px: f64) -> Self {
        #[allow(clippy::cast_possible_truncation, reason = "some pixels")]
        let margin_px = half_px.ceil() as i32 + 1;
        let size_px = coverage.size_px + 2 * margin_px;
        let mut owners = Self {
            origin_px: coverage.origin_px - margin_px,
            size_px,
            nearest: vec![None; (size_px.x * size_px.y) as usize],
        };
        for (index, element) in elements.iter().enumerate() {
            for y in -margin_px..=margin_px {
                for x in -margin_px..=margin_px {
                    let at = element.pixel(0.0) + IVec2::new(x, y);
                    owners.offer(at, index, element, half_px);
                }
            }
        }
        owners
    }

    fn offer(&mut self, at: IVec2, index: usize, element: &Element, half_px: f64) {
        let from = at.as_dvec2() + DVec2::splat(0.5) - element.at_px;
        let distance = from.length_squared();
        let is_in_band =
            from.dot(element.normal).abs() <= half_px + 0.5 && distance <= (half_px + 1.0).powi(2);
        let Some(index_of_pixel) = index_in(self.size_px, at - self.origin_px).filter(|_| is_in_band) else {
            return;
        };
        let nearest = &mut self.nearest[index_of_pixel];
        if nearest.is_none_or(|(_, other)| distance < other) {
            *nearest = Some((index, distance));
        }
    }

    fn pixels(&self) -> impl Iterator<Item = (IVec2, usize)> + '_ {
        let owned = places(self.size_px).zip(&self.nearest);
        owned.filter_map(|(place, nearest)| Some((self.origin_px + place, (*nearest)?.0)))
    }
}
