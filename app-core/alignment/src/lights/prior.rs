//! What is known of a lamp before its shadow is looked at.

use glam::DQuat;

use super::lamp::{Lamp, N_PARTS, NEARNESS, SPREAD};
use app_scene::scene::LightUncertainty;

/// Deviations of what is given: directions in radians, the nearness over the given one, and the spread over the given one.
const GIVEN_RAD: f64 = 0.2;
const GIVEN_NEARNESS: f64 = 0.3;
const GIVEN_SPREAD: f64 = 0.7;
/// The least deviation of a spread; a point light stays one.
const GIVEN_POINT: f64 = 0.003;
/// Of a lamp of which nothing is known: its direction in radians, its nearness over the toy's radius, its spread.
const FREE_RAD: f64 = 1.0;
const FREE_NEARNESS: f64 = 0.3;
const FREE_SPREAD: f64 = 0.5;

/// A lamp that each part is drawn to, and the deviations of that; a part without any is held as it is. Directions are free within
/// theirs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    lamp: Lamp,
    deviations: [f64; N_PARTS],
    /// How far from it a lamp may be at most.
    uncertainty: LightUncertainty,
}

impl Prior {
    /// Of a lamp that was given; one at infinity stays there.
    pub(super) fn given(lamp: &Lamp, uncertainty: &LightUncertainty) -> Self {
        let spread = match uncertainty.size_ratio {
            Some(ratio) if ratio <= 1.0 => 0.0,
            Some(ratio) => (ratio - 1.0) * lamp.spread + GIVEN_POINT,
            None => GIVEN_SPREAD * lamp.spread + GIVEN_POINT,
        };
        let nearness = uncertainty
            .distance_ratio
            .map_or(GIVEN_NEARNESS, |ratio| ratio - 1.0);
        Self {
            lamp: *lamp,
            deviations: [GIVEN_RAD, GIVEN_RAD, nearness * lamp.nearness, spread],
            uncertainty: *uncertainty,
        }
    }

    /// Of a lamp of which nothing is known, beside a toy of a radius.
    pub(super) fn free(lamp: &Lamp, radius_m: f64) -> Self {
        let far_point = Lamp {
            nearness: 0.0,
            spread: 0.0,
            ..*lamp
        };
        Self {
            lamp: far_point,
            deviations: [FREE_RAD, FREE_RAD, FREE_NEARNESS / radius_m, FREE_SPREAD],
            uncertainty: LightUncertainty::default(),
        }
    }

    /// The same for a lamp at infinity.
    pub(super) fn far(lamp: &Lamp) -> Self {
        let mut prior = Self::free(lamp, 1.0);
        prior.deviations[NEARNESS] = 0.0;
        prior
    }

    /// Of a lamp that stays as it is.
    pub(super) fn held(lamp: &Lamp) -> Self {
        Self {
            lamp: *lamp,
            deviations: [0.0; N_PARTS],
            uncertainty: LightUncertainty::default(),
        }
    }

    /// The nearest lamp that is no farther from the one given than that is uncertain.
    pub(super) fn within(&self, lamp: Lamp) -> Lamp {
        let within_ratio = |value: f64, given: f64, ratio: Option<f64>| {
            ratio.map_or(value, |ratio| value.clamp(given / ratio, given * ratio))
        };
        let LightUncertainty {
            direction_rad,
            distance_ratio,
            size_ratio,
        } = self.uncertainty;
        let from = self.lamp.direction;
        let turned_rad = from.angle_between(lamp.direction);
        let direction = match direction_rad {
            Some(most_rad) if turned_rad > most_rad => {
                let turn = DQuat::from_rotation_arc(from, lamp.direction).to_scaled_axis();
                (DQuat::from_scaled_axis(turn.clamp_length_max(most_rad)) * from).normalize()
            }
            _ => lamp.direction,
        };
        Lamp {
            direction,
            nearness: within_ratio(lamp.nearness, self.lamp.nearness, distance_ratio),
            // A point has no size that a ratio could bound.
            spread: if self.lamp.spread > 0.0 {
                within_ratio(lamp.spread, self.lamp.spread, size_ratio)
            } else {
                lamp.spread
            },
        }
    }

    /// Whether the lamp was given at a distance.
    pub(super) fn is_near(&self) -> bool {
        self.lamp.nearness > 0.0
    }

    /// Whether a part stays as it is.
    pub(super) fn holds(&self, part: usize) -> bool {
        self.deviations[part] <= 0.0
    }

    /// How far each part of a lamp is from what is known, and the information on that.
    pub(super) fn pull(&self, lamp: &Lamp) -> [(f64, f64); N_PARTS] {
        [0, 1, NEARNESS, SPREAD].map(|part| {
            let away = match part {
                NEARNESS => lamp.nearness - self.lamp.nearness,
                SPREAD => lamp.spread - self.lamp.spread,
                _ => 0.0,
            };
            if self.holds(part) {
                (0.0, 1.0)
            } else {
                (away, self.deviations[part].powi(-2))
            }
        })
    }
}
