//! A model of receivers without the toy, if there is no plate: a smooth colour each.
//!
//! Texture is treated as noise: lights are less accurate than with a plate, and faint ones are not
//! found. The ratio of light to that in a plate (`relight`) has no texture, and may have a higher
//! degree.

use glam::{DVec2, DVec3};
use nalgebra::{SMatrix, SVector};

use crate::median::{DEVIATION_OF_MEDIAN, part_of};
use crate::picture::{Color, Level, places};
use crate::raster::Coverage;
use crate::receivers::{SeenReceiver, receiver_at};

/// Number of coefficients of polynomials of the second and of the fourth degree in two variables.
pub(super) const QUADRATIC: usize = 6;
pub(super) const QUARTIC: usize = 15;
/// Radius of the fitted region around the toy, over the toy's radius.
pub(super) const REACH: f64 = 5.0;
/// Rounds of reweighting; shadows are outliers.
const N_ROUNDS: usize = 12;
/// Keeps a colour flat if too few pixels are visible.
const PRIOR: f64 = 1e-6;

type Terms<const N: usize> = SVector<f64, N>;

/// The colour of each receiver, a polynomial of N coefficients.
#[derive(Debug)]
pub(super) struct Background<const N: usize> {
    /// `None` for a receiver that is not visible.
    receivers: Vec<Option<Seen<N>>>,
    middle: DVec3,
    reach_m: f64,
}

#[derive(Debug)]
struct Seen<const N: usize> {
    colors: [Terms<N>; 3],
    /// Standard deviation of its texture, over its colour.
    texture: f64,
}

impl<const N: usize> Background<N> {
    /// The background of a picture with a toy around `middle`, in camera space, within `reach_m` of
    /// it.
    pub(super) fn of(
        level: &Level,
        coverage: &Coverage,
        receivers: &[SeenReceiver],
        (middle, reach_m): (DVec3, f64),
    ) -> Self {
        let mut out = Self {
            receivers: Vec::new(),
            middle,
            reach_m,
        };
        let mut seen: Vec<Vec<(Terms<N>, Color)>> = vec![Vec::new(); receivers.len()];
        for at in places(level.frame.size_px).filter(|at| coverage.at(*at) <= 0.0) {
            let Some((receiver, point)) = receiver_at(receivers, &level.intrinsics, at) else {
                continue;
            };
            if let (true, Some(color)) = (out.reaches(point), level.frame.get(at)) {
                seen[receiver].push((out.terms(&receivers[receiver], point), color));
            }
        }
        out.receivers = seen.iter().map(|seen| Seen::of(seen)).collect();
        out
    }

    /// Colour of a receiver's point in camera space, and the relative standard deviation of its
    /// texture.
    pub(super) fn at(
        &self,
        receivers: &[SeenReceiver],
        receiver: usize,
        point: DVec3,
    ) -> Option<(Color, f32)> {
        let seen = self.receivers[receiver]
            .as_ref()
            .filter(|_| self.reaches(point))?;
        let terms = self.terms(&receivers[receiver], point);
        #[allow(clippy::cast_possible_truncation, reason = "light, to 7 digits")]
        let color = seen.colors.map(|color| color.dot(&terms).max(0.0) as f32);
        #[allow(clippy::cast_possible_truncation, reason = "a fraction")]
        let texture = seen.texture as f32;
        Some((color, texture))
    }

    fn reaches(&self, point: DVec3) -> bool {
        point.distance(self.middle) < self.reach_m
    }

    fn terms(&self, receiver: &SeenReceiver, point: DVec3) -> Terms<N> {
        let all = polynomial(receiver, point, (self.middle, self.reach_m));
        Terms::from_fn(|term, _| all[term])
    }
}

/// Terms of a polynomial over a receiver's plane at a point in camera space, those of lower degrees
/// first.
pub(super) fn polynomial(
    receiver: &SeenReceiver,
    point: DVec3,
    (middle, reach_m): (DVec3, f64),
) -> [f64; QUARTIC] {
    let along = receiver.plane_from_camera.transform_vector3(point - middle) / reach_m;
    let DVec2 { x, y } = DVec2::new(along.x, along.z);
    let (xx, xy, yy) = (x * x, x * y, y * y);
    #[rustfmt::skip]
    let all = [
        1.0, x, y, xx, xy, yy,
        xx * x, xx * y, x * yy, yy * y,
        xx * xx, xx * xy, xx * yy, xy * yy, yy * yy,
    ];
    all
}

impl<const N: usize> Seen<N> {
    fn of(pixels: &[(Terms<N>, Color)]) -> Option<Self> {
        if pixels.len() < 4 * N {
            return None;
        }
        let mut texture = 0.0;
        let colors = [0, 1, 2].map(|channel| {
            let values: Vec<(Terms<N>, f64)> = pixels
                .iter()
                .map(|(terms, color)| (*terms, f64::from(color[channel])))
                .collect();
            let (color, deviation) = robust(&values);
            texture += deviation / color[0].abs().max(PRIOR) / 3.0;
            color
        });
        Some(Self { colors, texture })
    }
}

/// A smooth value and its deviation, by iteratively reweighted least squares (Geman and McClure
/// 1987).
fn robust<const N: usize>(values: &[(Terms<N>, f64)]) -> (Terms<N>, f64) {
    let mut sorted: Vec<f64> = values.iter().map(|(_, value)| *value).collect();
    let mut color = Terms::<N>::zeros();
    // Shadows are dark: the start is brighter than they are.
    color[0] = quantile(&mut sorted, 0.7);
    let mut deviation = f64::INFINITY;
    for _ in 0..N_ROUNDS {
        let mut away: Vec<f64> = values
            .iter()
            .map(|(terms, value)| (value - color.dot(terms)).abs())
            .collect();
        deviation = (DEVIATION_OF_MEDIAN * quantile(&mut away, 0.5)).max(PRIOR);
        let (mut normal, mut side) = (SMatrix::<f64, N, N>::identity() * PRIOR, Terms::<N>::zeros());
        for (terms, value) in values {
            let excess = (value - color.dot(terms)) / (2.0 * deviation);
            let weight = crate::robust::weight(excess * excess);
            normal.ger(weight, terms, terms, 1.0);
            side.axpy(weight * value, terms, 1.0);
        }
        if let Some(factor) = normal.cholesky() {
            color = factor.solve(&side);
        }
    }
    (color, deviation)
}

fn quantile(values: &mut [f64], part: f64) -> f64 {
    let index = part_of(values.len() - 1, part);
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}
