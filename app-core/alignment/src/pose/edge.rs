//! Locates the outline to a small fraction of a pixel, by predicting the codes of the pixels beside
//! it.
//!
//! A camera mixes toy and background by the area that each covers, spreads the mixture by its lens,
//! encodes it and sharpens the codes. Each step is predicted, so that symmetric effects of the
//! camera make a toy neither fat nor thin.

use glam::{DVec2, IVec2};

use super::contour::Element;
use super::motion::Measured;
use super::owners::Owners;
use super::paint::Shaded;
use super::sides::{Beside, Sides, carried};
use crate::picture::{Color, NOISE_CODES, index_in, places, taps_of};
use crate::raster::Coverage;
use crate::robust;
use app_scene::geometry::color::{linear_per_srgb, srgb_from_linear};
use app_scene::sharpness::Spread as Covariance;

/// Error of the prediction of a piece, in pixels, independent of its number of pixels.
const CARRIED_PX: f64 = 0.05;
/// Width of the band without blur, and its increase with blur, in pixels.
const HALF_PX: f64 = 1.0;
const HALF_OF_SPREAD: f64 = 1.5;
/// Scale of the Geman-McClure weights of displacements, in pixels.
const ROBUST_PX: f64 = 0.5;
/// Largest displacement of a piece: beyond it one linear step does not predict the codes.
const MOST_PX: f64 = 1.5;
/// Blur of the unsharp mask of a camera's sharpening, in pixels.
const SHARPENED_PX: f64 = 1.2;
/// Variance of a point's place within a pixel, along any direction, in square pixels.
const PIXEL_PX2: f64 = 1.0 / 12.0;
/// A smaller blur is invisible beside the shape of the pixel.
pub(super) const LEAST_SPREAD_PX: f64 = 0.3;

/// A camera's edge response, the same all around the toy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Optics {
    /// Standard deviation of the lens's blur, in pixels.
    pub(super) spread_px: f64,
    /// Strength of sharpening, relative to the difference between the codes and their blur by 1.2
    /// px.
    pub(super) overshoot: f64,
}

impl Optics {
    /// Blur alone.
    pub(super) const fn blurred(spread_px: f64) -> Self {
        Self {
            spread_px,
            overshoot: 0.0,
        }
    }

    /// Half the width of the band that an edge of this blur needs, in pixels.
    pub(super) fn half_px(&self) -> f64 {
        HALF_PX + HALF_OF_SPREAD * self.spread_px
    }
}

/// Measures each piece's displacement by the step that explains its pixels best.
pub(super) fn measure(
    beside: &Beside<'_>,
    elements: &[Element],
    optics: Optics,
    half_px: f64,
) -> Vec<Measured> {
    measured_by(beside, elements, (optics, half_px), Piece::measured)
}

/// The same, weighted by the fit of each piece's pixels.
pub(super) fn measure_explained(
    beside: &Beside<'_>,
    elements: &[Element],
    optics: Optics,
    half_px: f64,
) -> Vec<Measured> {
    measured_by(beside, elements, (optics, half_px), |piece, element| {
        let measured = piece.measured(element)?;
        let precision = 1.0 / (1.0 / measured.precision + piece.unexplained_px2());
        Some(Measured {
            precision,
            ..measured
        })
    })
}

fn measured_by(
    beside: &Beside<'_>,
    elements: &[Element],
    (optics, half_px): (Optics, f64),
    of: impl Fn(&Piece, &Element) -> Option<Measured>,
) -> Vec<Measured> {
    let pieces = Edges::new(beside, elements, half_px).pieces(optics);
    let measured = elements.iter().zip(&pieces);
    measured
        .filter_map(|(element, piece)| of(piece, element))
        .collect()
}

/// The pixels beside an outline, each with its colours of toy and background alone.
pub(super) struct Edges<'a> {
    coverage: &'a Coverage,
    /// The toy's model, if a lens mixes its colours as well.
    model: Option<Model>,
    pixels: Vec<EdgePixel>,
    /// For each piece, whether all of its pixels and both its sides are known.
    pub(super) are_known: Vec<bool>,
}

/// The toy's model times its coverage, by channels, and the coverage that it colours.
struct Model {
    channels: [Coverage; 3],
    colored: Coverage,
}

struct EdgePixel {
    at: IVec2,
    owner: usize,
    /// Distance from the piece along its normal.
    from_px: f64,
    normal: DVec2,
    toy: Color,
    /// The toy over its model.
    toy_over_model: Color,
    background: Color,
    /// The toy's codes minus the background's.
    contrast_codes: [f64; 3],
    seen_codes: [f64; 3],
}

impl<'a> Edges<'a> {
    pub(super) fn new(beside: &Beside<'a>, elements: &[Element], half_px: f64) -> Self {
        let sides: Vec<Option<Sides>> = elements
            .iter()
            .map(|element| Sides::new(beside, element, half_px))
            .collect();
        let mut are_known: Vec<bool> = sides.iter().map(Option::is_some).collect();
        let mut pixels = Vec::new();
        if !elements.is_empty() {
            for (at, owner) in Owners::new(elements, beside.coverage, half_px).pixels() {
                let Some(sides) = &sides[owner] else { continue };
                let (Some([toy, background]), Some(seen)) =
                    (sides.at(beside, at), beside.level.frame.get(at))
                else {
                    are_known[owner] = false;
                    continue;
                };
                let element = &elements[owner];
                let (toy_codes, background_codes) = (codes(toy), codes(background));
                pixels.push(EdgePixel {
                    at,
                    owner,
                    from_px: (at.as_dvec2() + DVec2::splat(0.5) - element.at_px).dot(element.normal),
                    normal: element.normal,
                    toy,
                    toy_over_model: sides.toy,
                    background,
                    contrast_codes: [0, 1, 2].map(|channel| toy_codes[channel] - background_codes[channel]),
                    seen_codes: codes(seen),
                });
            }
        }
        Self {
            coverage: beside.coverage,
            model: None,
            pixels,
            are_known,
        }
    }

    /// With a lens that mixes the colours of the toy's model, too. In a wrong place these are other colours, so
    /// that a pose is searched without it.
    pub(super) fn mixing(self, beside: &Beside<'_>) -> Self {
        let model = beside.shaded.map(|shaded| Model::new(shaded, beside.coverage));
        Self { model, ..self }
    }

    /// The statistics of each piece under these optics.
    pub(super) fn pieces(&self, optics: Optics) -> Vec<Piece> {
        let of = |spread_px| self.spread(Covariance::round(spread_px));
        let wider = (optics.overshoot > 0.0).then(|| of(optics.spread_px.hypot(SHARPENED_PX)));
        let beyond = wider.as_ref().map(|wider| (wider, optics.overshoot));
        self.pieces_by(&of(optics.spread_px), beyond, |pixel| pixel.toy)
    }

    /// The same for a lens with this blur.
    pub(super) fn pieces_of(&self, lens: Covariance) -> Vec<Piece> {
        let spread = self.spread(lens);
        let Some(model) = &self.model else {
            return self.pieces_by(&spread, None, |pixel| pixel.toy);
        };
        let of = |coverage| Spread::new(coverage, lens, self.pixels.iter().map(|pixel| pixel.at));
        let (channels, colored) = (model.channels.each_ref().map(of), of(&model.colored));
        self.pieces_by(&spread, None, |pixel| {
            let weight = colored.place(pixel.at - colored.origin_px);
            if weight == 0.0 {
                return pixel.toy;
            }
            let mean = |channel: &Spread| channel.place(pixel.at - channel.origin_px) / weight;
            carried(pixel.toy_over_model, channels.each_ref().map(mean))
        })
    }

    fn spread(&self, lens: Covariance) -> Spread {
        Spread::new(self.coverage, lens, self.pixels.iter().map(|pixel| pixel.at))
    }

    /// With the colour of the toy at each pixel; beside a wider spread and the overshoot over it.
    fn pieces_by(
        &self,
        spread: &Spread,
        beyond: Option<(&Spread, f64)>,
        toy: impl Fn(&EdgePixel) -> Color,
    ) -> Vec<Piece> {
        let mut pieces: Vec<Piece> = self
            .are_known
            .iter()
            .map(|is_known| Piece {
                is_known: *is_known,
                ..Piece::default()
            })
            .collect();
        for pixel in &self.pixels {
            let of = |spread: &Spread| Mixed {
                covered: spread.at(pixel.at),
                density: density(pixel.from_px, pixel.normal, spread.along_px(pixel.normal)),
            };
            let lens = of(spread);
            let beyond = beyond.map_or(Mixed::default(), |(wider, overshoot)| {
                let wider = of(wider);
                Mixed {
                    covered: overshoot * (lens.covered - wider.covered),
                    density: overshoot * (lens.density - wider.density),
                }
            });
            pieces[pixel.owner].add((pixel, toy(pixel)), lens, beyond);
        }
        pieces
    }
}

impl Model {
    fn new(shaded: &Shaded<'_>, coverage: &Coverage) -> Self {
        let channel = |channel: usize| move |at| shaded.at(at).map_or(0.0, |color| color[channel]);
        Self {
            channels: [0, 1, 2].map(|index| coverage.times(channel(index))),
            colored: coverage.times(|at| if shaded.at(at).is_some() { 1.0 } else { 0.0 }),
        }
    }
}

/// A pixel's coverage by the toy, and its derivative by the outline's outward move in pixels.
#[derive(Clone, Copy, Default)]
struct Mixed {
    covered: f64,
    density: f64,
}

/// Derivative of a pixel's coverage by the move of a straight edge at the given distance.
fn density(from_px: f64, normal: DVec2, spread_px: f64) -> f64 {
    if spread_px >= LEAST_SPREAD_PX {
        let variance = spread_px * spread_px + PIXEL_PX2;
        return (-0.5 * from_px * from_px / variance).exp() / (std::f64::consts::TAU * variance).sqrt();
    }
    // The length of the edge within the pixel: a trapezoid over the distance.
    let [a, b] = normal.abs().to_array();
    let (wide, narrow) = (0.5 * (a + b), 0.5 * (a - b).abs());
    let height = 1.0 / a.max(b);
    let slope = wide - narrow;
    let within = wide - from_px.abs();
    if within <= 0.0 {
        0.0
    } else if within >= slope {
        height
    } else {
        height * within / slope
    }
}

/// Statistics of the pixels beside a piece of the outline: weighted sums of squares, in codes.
#[derive(Clone, Copy, Default)]
pub(super) struct Piece {
    is_known: bool,
    slope2: f64,
    slope_by_residual: f64,
    residual2: f64,
    contrast2: f64,
    n: f64,
}

impl Piece {
    fn add(&mut self, (pixel, toy): (&EdgePixel, Color), lens: Mixed, beyond: Mixed) {
        for (channel, toy) in toy.into_iter().enumerate() {
            let apart = f64::from(toy - pixel.background[channel]);
            let mixed = f64::from(pixel.background[channel]) + lens.covered * apart;
            let contrast = pixel.contrast_codes[channel];
            let unclipped = code(mixed) + beyond.covered * contrast;
            let predicted = unclipped.clamp(0.0, 255.0);
            let slope = if unclipped == predicted {
                slope_of_code(mixed) * apart * lens.density + contrast * beyond.density
            } else {
                0.0
            };
            let residual = pixel.seen_codes[channel] - predicted;
            let weight = SLOPE_OF_WHITE / slope_of_code(mixed);
            self.slope2 += weight * slope * slope;
            self.slope_by_residual += weight * slope * residual;
            self.residual2 += weight * residual * residual;
            self.contrast2 += weight * contrast * contrast;
        }
        self.n += 1.0;
    }

    /// The residual over the contrast, once the piece is displaced.
    pub(super) fn left(&self) -> Option<f64> {
        if !self.is_known || self.slope2 <= 0.0 {
            return None;
        }
        let explained = self.slope_by_residual * self.slope_by_residual / self.slope2;
        let noise = self.n * 3.0 * f64::from(NOISE_CODES).powi(2);
        Some((self.residual2 - explained).max(0.0) / (self.contrast2 + noise))
    }

    /// Variance of the displacement by the residual.
    fn unexplained_px2(&self) -> f64 {
        let explained = self.slope_by_residual * self.slope_by_residual / self.slope2;
        let left = (self.residual2 - explained).max(0.0);
        left / ((3.0 * self.n - 1.0) * self.slope2)
    }

    fn measured(&self, element: &Element) -> Option<Measured> {
        if !self.is_known || self.slope2 <= 0.0 {
            return None;
        }
        let offset_px = (self.slope_by_residual / self.slope2).clamp(-MOST_PX, MOST_PX);
        let noise_px2 = f64::from(NOISE_CODES).powi(2) / self.slope2;
        Some(Measured {
            element: *element,
            offset_px,
            precision: 1.0 / (noise_px2 + CARRIED_PX * CARRIED_PX),
            robust: robust::weight((offset_px / ROBUST_PX).powi(2)),
        })
    }
}

/// Codes from 0 to 255, not rounded.
fn codes(linear: Color) -> [f64; 3] {
    linear.map(|value| code(f64::from(value)))
}

fn code(linear: f64) -> f64 {
    #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
    let encoded = srgb_from_linear(linear.clamp(0.0, 1.0) as f32);
    255.0 * f64::from(encoded)
}

/// Codes per unit of light at white. The prediction's errors are in light, the camera's in codes:
/// pixels are weighted halfway between the two.
const SLOPE_OF_WHITE: f64 = 255.0 * 1.055 / 2.4;

/// Codes per unit of light.
fn slope_of_code(linear: f64) -> f64 {
    #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
    let slope = linear_per_srgb(linear.min(1.0) as f32);
    255.0 / f64::from(slope)
}

/// Coverage blurred by a lens, at some pixels.
struct Spread {
    origin_px: IVec2,
    size_px: IVec2,
    values: Vec<f32>,
    covariance: Covariance,
}

impl Spread {
    fn new(coverage: &Coverage, covariance: Covariance, pixels: impl Iterator<Item = IVec2>) -> Self {
        if covariance.widest_px() < LEAST_SPREAD_PX {
            return Self::of(coverage, IVec2::ZERO, Covariance::NONE);
        }
        let [first, second] = taps_of(covariance);
        let reach = |taps: &[(IVec2, f32)]| {
            let offsets = taps.iter().map(|(offset, _)| offset.abs());
            offsets.fold(IVec2::ZERO, IVec2::max)
        };
        let spread = Self::of(coverage, reach(&first) + reach(&second), covariance);
        let at: Vec<IVec2> = pixels.map(|at| at - spread.origin_px).collect();
        let read = at
            .iter()
            .flat_map(|at| second.iter().map(move |(offset, _)| *at + *offset));
        spread.blurred(&first, read).blurred(&second, at.iter().copied())
    }

    /// Blurred along an axis at some places; unknown at all others, which are 0.
    fn blurred(self, taps: &[(IVec2, f32)], at: impl Iterator<Item = IVec2>) -> Self {
        let mut values = vec![0.0; self.values.len()];
        let mut are_known = vec![false; values.len()];
        for place in at {
            let index = index_in(self.size_px, place);
            let Some(index) = index.filter(|index| !std::mem::replace(&mut are_known[*index], true)) else {
                continue;
            };
            let values_along = taps
                .iter()
                .map(|(offset, weight)| weight * self.place(place + *offset));
            values[index] = values_along.sum();
        }
        Self { values, ..self }
    }

    /// The unblurred coverage, with a margin around it.
    fn of(coverage: &Coverage, margin_px: IVec2, covariance: Covariance) -> Self {
        let (origin_px, size_px) = (coverage.origin_px - margin_px, coverage.size_px + 2 * margin_px);
        Self {
            origin_px,
            size_px,
            values: places(size_px)
                .map(|place| coverage.at(origin_px + place))
                .collect(),
            covariance,
        }
    }

    /// Standard deviation along a direction.
    fn along_px(&self, DVec2 { x, y }: DVec2) -> f64 {
        let Covariance {
            xx_px2,
            xy_px2,
            yy_px2,
        } = self.covariance;
        (xx_px2 * x * x + 2.0 * xy_px2 * x * y + yy_px2 * y * y)
            .max(0.0)
            .sqrt()
    }

    fn place(&self, place: IVec2) -> f32 {
        index_in(self.size_px, place).map_or(0.0, |index| self.values[index])
    }

    fn at(&self, at: IVec2) -> f64 {
        f64::from(self.place(at - self.origin_px))
    }
}
