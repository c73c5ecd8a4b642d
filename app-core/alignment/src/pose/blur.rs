//! The camera's edge response, from the codes beside the toy's outline.

use super::contour::Element;
use super::edge::{Edges, LEAST_SPREAD_PX, Optics, Piece};
use super::sides::Beside;
use crate::median::part_of;
use app_scene::sharpness::Spread;

/// Largest blur of a lens.
pub(super) const MOST_SPREAD_PX: f64 = 4.0;
/// Half the band in which blurs are compared, the same for all, in pixels.
pub(super) const COMPARED_PX: f64 = 4.0;
/// Blur above which overshoot and less blur are ambiguous.
const SPREAD_WITHOUT_OVERSHOOT_PX: f64 = 1.0;
const MOST_OVERSHOOT: f64 = 1.5;
/// Fraction of the pieces that count: the worst ones are something else.
const FITTING: f64 = 0.7;
/// An unknown of the camera is included if the misfit falls to less than this fraction.
const GAIN: f64 = 0.98;
/// Blur in pixels from which a picture is soft: that of a sharp lens, compressed or not, has .6 at most.
pub(crate) const SOFT_PX: f64 = 0.7;
/// Fraction of the pieces that it must explain better than none does. Where the toy is hardly
/// brighter than the table, errors of its predicted colours look like a blur of 1 to 4 px.
///
/// Measured: 71 to 99 % in seven blurred pictures, 54 to 57 % in sharp ones of a pale llama on dark
/// wood.
const BETTER: f64 = 0.65;

/// The optics that explain the pixels of a wide band best, whatever the pose, since each piece has a
/// free displacement; and the remaining residual.
pub(super) fn optics(beside: &Beside<'_>, elements: &[Element]) -> (Optics, f64) {
    let edges = Edges::new(beside, elements, COMPARED_PX);
    let pieces = Pieces::all(&edges);
    let (spread_px, misfit) = pieces.blur();
    let blurred = Optics::blurred(spread_px);
    if spread_px < SPREAD_WITHOUT_OVERSHOOT_PX {
        let with = |overshoot| Optics { overshoot, ..blurred };
        let (overshoot, of_overshoot) =
            least((0.0, MOST_OVERSHOOT), |overshoot| pieces.misfit(with(overshoot)));
        if of_overshoot < GAIN * misfit {
            return (with(overshoot), of_overshoot);
        }
    }
    (blurred, misfit)
}

/// Some pieces of an outline.
pub(super) struct Pieces<'a> {
    pub(super) edges: &'a Edges<'a>,
    pub(super) are_used: Vec<bool>,
}

impl<'a> Pieces<'a> {
    pub(super) fn all(edges: &'a Edges<'a>) -> Self {
        let are_used = vec![true; edges.are_known.len()];
        Self { edges, are_used }
    }

    /// Those of all that are used.
    pub(super) fn used<'b, T>(&'b self, all: &'b [T]) -> impl Iterator<Item = &'b T> {
        let both = all.iter().zip(&self.are_used);
        both.filter(|(_, is_used)| **is_used).map(|(one, _)| one)
    }

    /// The blur that explains them best, in pixels, and what it leaves; 0 if they are as sharp.
    pub(super) fn blur(&self) -> (f64, f64) {
        let sharp = self.misfit_of(Spread::NONE);
        let (spread_px, misfit) = self.blur_beyond(Spread::NONE, sharp);
        if self.are_softer(spread_px) {
            (spread_px, misfit)
        } else {
            (0.0, sharp)
        }
    }

    /// The round blur beside a known one that explains them best, in pixels, and what both leave; 0 if
    /// it explains no more.
    pub(super) fn blur_beside(&self, known: Spread) -> (f64, f64) {
        self.blur_beyond(known, self.misfit_of(known))
    }

    /// The same, given what the known one leaves.
    fn blur_beyond(&self, known: Spread, of_known: f64) -> (f64, f64) {
        let (spread_px, of_both) = least((LEAST_SPREAD_PX, MOST_SPREAD_PX), |px| {
            self.misfit_of(known.and(Spread::round(px)))
        });
        if of_both < GAIN * of_known {
            (spread_px, of_both)
        } else {
            (0.0, of_known)
        }
    }

    /// Mean square of the residual over the contrast, for the pieces that fit.
    fn misfit(&self, optics: Optics) -> f64 {
        self.left(&self.edges.pieces(optics))
    }

    /// The same for a lens with this blur.
    pub(super) fn misfit_of(&self, lens: Spread) -> f64 {
        self.left(&self.edges.pieces_of(lens))
    }

    fn left(&self, pieces: &[Piece]) -> f64 {
        let mut left: Vec<f64> = self.used(pieces).filter_map(|piece| piece.left()).collect();
        left.sort_by(f64::total_cmp);
        let n = part_of(left.len(), FITTING);
        let sum: f64 = left[..n].iter().sum();
        if n == 0 { f64::INFINITY } else { sum / n as f64 }
    }

    /// Whether a blur is so small that errors of the colours hardly look like it, or explains most
    /// pieces better than none does.
    fn are_softer(&self, spread_px: f64) -> bool {
        if spread_px < SOFT_PX {
            return true;
        }
        let [soft, sharp] = [spread_px, 0.0].map(|px| self.edges.pieces_of(Spread::round(px)));
        let both = self.used(&soft).zip(self.used(&sharp));
        let left = both.filter_map(|(soft, sharp)| soft.left().zip(sharp.left()));
        let are_better: Vec<bool> = left.map(|(soft, sharp)| soft < sharp).collect();
        let n_better = are_better.iter().filter(|is_better| **is_better).count();
        n_better as f64 >= BETTER * are_better.len() as f64
    }
}

/// The minimum of a unimodal function between two bounds, and its value. Source: golden-section
/// search, Kiefer 1953.
fn least((mut low, mut high): (f64, f64), of: impl Fn(f64) -> f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    const N_CUTS: usize = 7;
    let (mut a, mut b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
    let (mut of_a, mut of_b) = (of(a), of(b));
    for _ in 0..N_CUTS {
        if of_a < of_b {
            (high, b, of_b) = (b, a, of_a);
            a = high - GOLDEN * (high - low);
            of_a = of(a);
        } else {
            (low, a, of_a) = (a, b, of_b);
            b = low + GOLDEN * (high - low);
            of_b = of(b);
        }
    }
    if of_a < of_b { (a, of_a) } else { (b, of_b) }
}
