//! A long light, for example a tube, as a line of round ones, for shadows that one round light does
//! not explain.
//!
//! The line's centre, its turn about the line of sight, its length, its width and its distance are
//! optimised one after the other by ever smaller steps, until all its pieces of equal brightness
//! together explain most of a small picture. Source: Hooke and Jeeves 1961.

use glam::DVec2;

use super::lamp::{INVERSE_DISTANCE, Lamp, N_PARTS, SPREAD, disc};
use super::shadows::{LEAST_PIXELS, ROBUST_NEAR, Shadows};
use crate::picture::Pyramid;
use crate::raster::Rasterizer;
use crate::receivers::SeenReceiver;
use crate::shape::Shape;
use app_scene::scene::MAX_LIGHTS;

/// Number of points over a piece.
const N_POINTS: usize = 8;
/// Number of turns about the line of sight to try first, over half a circle, and tangents of the
/// line's angular half length.
const N_TURNS: usize = 6;
const HALF_LENGTHS: [f64; 3] = [0.15, 0.3, 0.6];
/// Largest width of a piece, over the distance between two.
const MOST_OVERLAP: f64 = 1.0;
/// First steps: of the centre and of the turn in radians, of the half length and of the spread
/// relative to their values, of the inverse distance relative to one over the toy's radius.
const FIRST_STEPS: [f64; N_NUMBERS] = [0.05, 0.05, 0.25, 0.25, 0.3, 0.02];
/// Number of halvings of the steps, and largest number of rounds.
const N_HALVINGS: usize = 4;
const MOST_ROUNDS: usize = 24;
/// Largest loss of a line, as a fraction of one round light's.
///
/// Measured: .29 of a tube of 60 cm by 4 cm in a metre's distance.
const OF_ROUND: f64 = 0.6;
/// Largest loss of the best initial line, as a fraction of the round light's, for which it is
/// optimised: otherwise the shadow may fall on a step, and no line explains it.
///
/// Measured: .63 of that tube, 1.01 of a book and 1.03 of a mug under the shadow of a bulb.
const OF_ROUND_AT_FIRST: f64 = 0.9;
/// Side of the cells that vertices are merged in, in pixels.
const CELL_PX: f64 = 0.5;

/// Number of a line's parameters.
const N_NUMBERS: usize = 6;

/// A line of lamps.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Its centre; of the width of a piece.
    middle: Lamp,
    /// Turn about the line of sight, in radians.
    turn_rad: f64,
    /// Tangent of half its angular length.
    half_length: f64,
}

impl Line {
    /// Lamps side by side.
    fn pieces(&self) -> [Lamp; MAX_LIGHTS] {
        let along = DVec2::from_angle(self.turn_rad) * self.half_length;
        std::array::from_fn(|index| {
            // The centres of equal parts of the line.
            let part = (2.0 * index as f64 + 1.0) / MAX_LIGHTS as f64 - 1.0;
            let [across, up] = (part * along).to_array();
            let mut step = [0.0; N_PARTS];
            [step[0], step[1]] = [across.atan(), up.atan()];
            self.middle.moved(&step)
        })
    }

    /// The line with one parameter changed by a step, relative to the toy's radius.
    fn stepped(&self, number: usize, step: f64, radius_m: f64) -> Self {
        let mut out = *self;
        let mut parts = [0.0; N_PARTS];
        match number {
            0 | 1 => parts[number] = step,
            2 => out.turn_rad += step,
            3 => out.half_length *= step.exp(),
            4 => parts[SPREAD] = self.middle.spread * (step.exp() - 1.0),
            _ => parts[INVERSE_DISTANCE] = step / radius_m,
        }
        if number == 5 && self.middle.is_far() {
            return out;
        }
        out.middle = self.middle.moved(&parts);
        let most = MOST_OVERLAP * 2.0 * out.half_length / MAX_LIGHTS as f64;
        out.middle.spread = out.middle.spread.min(most);
        out
    }
}

/// A line of lamps that explains clearly more than a round one; `None` if there is none.
pub(super) fn line_of(
    round: &Lamp,
    (shape, receivers): (&Shape, &[SeenReceiver]),
    pyramid: &Pyramid,
) -> Option<[Lamp; MAX_LIGHTS]> {
    let mut raster = Rasterizer::default();
    let level = pyramid.level(pyramid.smallest_for_shadows());
    let coarse = shape.merged_in_px(CELL_PX, level);
    let mut shadows = Shadows::new(&mut raster, (&coarse, receivers), level, None);
    if shadows.pixels.len() < LEAST_PIXELS {
        return None;
    }
    let shading = shadows.shading(&mut raster, &[*round], ROBUST_NEAR);
    shadows.light(&[*round], &shading);
    let left_by_round = shadows.shading(&mut raster, &[*round], ROBUST_NEAR).loss;
    let disc = disc(N_POINTS);
    let mut left = |line: &Line| {
        let mut taken = vec![0.0; shadows.pixels.len()];
        for piece in line.pieces() {
            let of_piece = shadows.taken(&mut raster, &piece, &disc);
            for (taken, of_piece) in taken.iter_mut().zip(of_piece) {
                *taken += of_piece / MAX_LIGHTS as f32;
            }
        }
        let taken = [taken];
        shadows.shaded(&taken).fit(receivers.len(), ROBUST_NEAR).loss
    };
    let (by_first, line) = first(round, &mut left)?;
    if by_first > OF_ROUND_AT_FIRST * left_by_round {
        return None;
    }
    let (found, line) = moved((by_first, line), shape.radius_m, &mut left);
    (found < OF_ROUND * left_by_round).then(|| line.pieces())
}

/// The best of some turns and lengths, with its loss.
fn first(round: &Lamp, left: &mut impl FnMut(&Line) -> f64) -> Option<(f64, Line)> {
    let turns = (0..N_TURNS).map(|index| std::f64::consts::PI * index as f64 / N_TURNS as f64);
    let lines = turns.flat_map(|turn_rad| {
        HALF_LENGTHS.map(|half_length| Line {
            middle: Lamp {
                spread: half_length / MAX_LIGHTS as f64,
                ..*round
            },
            turn_rad,
            half_length,
        })
    });
    let scored = lines.map(|line| (left(&line), line));
    scored.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The optimised line, with its loss.
fn moved(from: (f64, Line), radius_m: f64, left: &mut impl FnMut(&Line) -> f64) -> (f64, Line) {
    let mut best = from;
    let mut scale = 1.0;
    let mut n_halvings = 0;
    for _ in 0..MOST_ROUNDS {
        let before = best.0;
        for (number, step) in FIRST_STEPS.into_iter().enumerate() {
            for step in [scale * step, -scale * step] {
                let line = best.1.stepped(number, step, radius_m);
                let scored = (left(&line), line);
                if scored.0 < best.0 {
                    best = scored;
                    break;
                }
            }
        }
        if best.0 >= before {
            n_halvings += 1;
            scale *= 0.5;
        }
        if n_halvings > N_HALVINGS {
            break;
        }
    }
    best
}
