//! Locates the outline to a fraction of a pixel, from the toy's coverage of each pixel beside it.
//!
//! A pixel there is a mixture of toy and background: alpha matting, with a background known from
//! the plate. The colours on either side are extrapolated across the band (`sides`).

use glam::IVec2;

use super::contour::Element;
use super::motion::Measured;
use super::owners::Owners;
use super::sides::{Beside, Sides};
use crate::picture::noise_deviation;
use crate::robust;

/// Error of extrapolated colours, over the contrast.
const CARRIED: f32 = 0.05;
/// Range of mixtures beyond 0 and 1 by noise; beyond it, the pixel shows something else.
const MOST_BEYOND: f32 = 0.5;

/// The band of pixels beside the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Band {
    /// Half its width.
    pub(super) half_px: f64,
    /// Scale of the Geman-McClure weights of displacements.
    pub(super) robust_px: f64,
}

impl Band {
    /// Mean loss of the measured pieces, in square pixels: the mean square, but each piece counts
    /// at most `robust_px`.
    pub(super) fn loss_px2(&self, measured: &[Measured]) -> f64 {
        let scale = self.robust_px * self.robust_px;
        let (mut sum, mut total) = (0.0, 0.0);
        for one in measured {
            let weight = one.precision * one.element.length_px;
            let square = one.offset_px * one.offset_px;
            sum += weight * robust::loss(square, scale);
            total += weight;
        }
        if total > 0.0 { sum / total } else { scale }
    }
}

/// Measures each piece's displacement: the difference of covered area between picture and model,
/// over the piece's length.
pub(super) fn measure(beside: &Beside<'_>, elements: &[Element], band: Band) -> Vec<Measured> {
    if elements.is_empty() {
        return Vec::new();
    }
    let mut pieces: Vec<Piece> = elements
        .iter()
        .map(|element| Piece::new(beside, element, band.half_px))
        .collect();
    let owners = Owners::new(elements, beside.coverage, band.half_px);
    for (at, owner) in owners.pixels() {
        pieces[owner].add(beside, at, beside.coverage.at(at));
    }
    let measured = elements
        .iter()
        .zip(&pieces)
        .filter_map(|(element, piece)| piece.measured(element, band));
    measured.collect()
}

/// Statistics of the pixels beside a piece of the outline.
#[derive(Clone, Copy)]
struct Piece {
    sides: Option<Sides>,
    /// Difference of covered area, in square pixels.
    more_area: f32,
    contrast: f32,
    n_pixels: f32,
    has_unknown: bool,
}

impl Piece {
    fn new(beside: &Beside<'_>, element: &Element, half_px: f64) -> Self {
        Self {
            sides: Sides::new(beside, element, half_px),
            more_area: 0.0,
            contrast: 0.0,
            n_pixels: 0.0,
            has_unknown: false,
        }
    }

    fn add(&mut self, beside: &Beside<'_>, at: IVec2, covered: f32) {
        let both = self.sides.and_then(|sides| sides.at(beside, at));
        let (Some([toy, background]), Some(seen)) = (both, beside.level.frame.get(at)) else {
            self.has_unknown = true;
            return;
        };
        let (mut along, mut contrast) = (0.0, 0.0);
        for channel in 0..3 {
            let apart = toy[channel] - background[channel];
            let middle = 0.5 * (toy[channel] + background[channel]);
            let variance = noise_deviation(middle).powi(2);
            along += (seen[channel] - background[channel]) * apart / variance;
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
        Some(Measured {
            element: *element,
            offset_px: offset_px.clamp(-band.half_px, band.half_px),
            precision: f64::from(1.0 / (noise + CARRIED * CARRIED)),
            robust: robust::weight((offset_px / band.robust_px).powi(2)),
        })
    }
}
