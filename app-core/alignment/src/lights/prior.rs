//! Prior knowledge of a lamp.

use glam::DQuat;

use super::lamp::{INVERSE_DISTANCE, Lamp, N_PARTS, SPREAD};
use app_scene::scene::LightUncertainty;

/// Standard deviations of a given lamp: direction in radians, inverse distance and spread relative
/// to the given ones.
const GIVEN_RAD: f64 = 0.2;
const GIVEN_INVERSE_DISTANCE: f64 = 0.3;
const GIVEN_SPREAD: f64 = 0.7;
/// Smallest standard deviation of a spread; a point light stays one.
const GIVEN_POINT: f64 = 0.003;
/// Standard deviations of an unknown lamp: direction in radians, inverse distance over the toy's
/// radius, spread.
const FREE_RAD: f64 = 1.0;
const FREE_INVERSE_DISTANCE: f64 = 0.3;
const FREE_SPREAD: f64 = 0.5;

/// The mean of each parameter and its standard deviation; a parameter without one is fixed.
/// Directions are free within theirs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Prior {
    lamp: Lamp,
    deviations: [f64; N_PARTS],
    /// Largest distance of a lamp from it.
    uncertainty: LightUncertainty,
}

impl Prior {
    /// The prior of a given lamp; one at infinity stays there.
    pub(super) fn given(lamp: &Lamp, uncertainty: &LightUncertainty) -> Self {
        let spread = match uncertainty.size_ratio {
            Some(ratio) if ratio <= 1.0 => 0.0,
            Some(ratio) => (ratio - 1.0) * lamp.spread + GIVEN_POINT,
            None => GIVEN_SPREAD * lamp.spread + GIVEN_POINT,
        };
        let inverse_distance = uncertainty
            .distance_ratio
            .map_or(GIVEN_INVERSE_DISTANCE, |ratio| ratio - 1.0);
        Self {
            lamp: *lamp,
            deviations: [
                GIVEN_RAD,
                GIVEN_RAD,
                inverse_distance * lamp.inverse_distance,
                spread,
            ],
            uncertainty: *uncertainty,
        }
    }

    /// The prior of an unknown lamp, beside a toy of the given radius.
    pub(super) fn free(lamp: &Lamp, radius_m: f64) -> Self {
        let far_point = Lamp {
            inverse_distance: 0.0,
            spread: 0.0,
            ..*lamp
        };
        Self {
            lamp: far_point,
            deviations: [FREE_RAD, FREE_RAD, FREE_INVERSE_DISTANCE / radius_m, FREE_SPREAD],
            uncertainty: LightUncertainty::default(),
        }
    }

    /// The same for a lamp at infinity.
    pub(super) fn far(lamp: &Lamp) -> Self {
        let mut prior = Self::free(lamp, 1.0);
        prior.deviations[INVERSE_DISTANCE] = 0.0;
        prior
    }

    /// The prior of a fixed lamp.
    pub(super) fn held(lamp: &Lamp) -> Self {
        Self {
            lamp: *lamp,
            deviations: [0.0; N_PARTS],
            uncertainty: LightUncertainty::default(),
        }
    }

    /// The nearest lamp within the given one's uncertainty.
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
            inverse_distance: within_ratio(lamp.inverse_distance, self.lamp.inverse_distance, distance_ratio),
            // A point has no size that a ratio could bound.
            spread: if self.lamp.spread > 0.0 {
                within_ratio(lamp.spread, self.lamp.spread, size_ratio)
            } else {
                lamp.spread
            },
        }
    }

    /// Whether the lamp was given at a finite distance.
    pub(super) fn is_near(&self) -> bool {
        self.lamp.inverse_distance > 0.0
    }

    /// Whether a parameter is fixed.
    pub(super) fn holds(&self, part: usize) -> bool {
        self.deviations[part] <= 0.0
    }

    /// The difference of each parameter from the prior, and its information.
    pub(super) fn pull(&self, lamp: &Lamp) -> [(f64, f64); N_PARTS] {
        [0, 1, INVERSE_DISTANCE, SPREAD].map(|part| {
            let away = match part {
                INVERSE_DISTANCE => lamp.inverse_distance - self.lamp.inverse_distance,
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
