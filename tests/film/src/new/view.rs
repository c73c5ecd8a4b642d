//! Sides from which a toy may have been photographed.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;
use std::str::FromStr;

use app_core::alignment::ViewDirection;

/// Number of turns to try if the visible side is unknown, and to either side of a given one.
const N_TURNS: u32 = 12;
const BESIDE: i32 = 3;
const BESIDE_RAD: f64 = PI / 12.0;
/// Elevations of the camera above the toy's horizon to try, in degrees: without a given height, and
/// for a low and a high camera.
const ELEVATIONS_DEG: [f64; 4] = [12.0, 28.0, 44.0, 62.0];
const LOW_DEG: [f64; 4] = [4.0, 12.0, 20.0, 28.0];
const HIGH_DEG: [f64; 4] = [44.0, 56.0, 68.0, 80.0];

/// A side of the toy: its front is the model's +Z, its left +X.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The model's +Z points to the camera.
    Front,
    /// The model's +X points to the camera.
    Left,
    /// The model's -Z points to the camera.
    Back,
    /// The model's -X points to the camera.
    Right,
}

/// Height of the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Height {
    Low,
    High,
}

/// A statement about the view: `front`, `left`, `back` or `right`, `low` or `high`, or one of each
/// with a comma between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct View {
    side: Option<Side>,
    height: Option<Height>,
}

impl Side {
    pub(super) const ALL: [Self; 4] = [Self::Front, Self::Left, Self::Back, Self::Right];

    fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Left => "left",
            Self::Back => "back",
            Self::Right => "right",
        }
    }

    /// Turn of the toy that shows this side.
    fn turn_rad(self) -> f64 {
        match self {
            Self::Front => 0.0,
            Self::Left => -FRAC_PI_2,
            Self::Back => PI,
            Self::Right => FRAC_PI_2,
        }
    }

    /// The side that a turn shows most of.
    #[must_use]
    pub fn of_turn(turn_rad: f64) -> Self {
        let away = |side: &Self| (turn_rad - side.turn_rad()).cos();
        let nearest = Self::ALL.into_iter().max_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.unwrap_or(Self::Front)
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for View {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut view = Self::default();
        for word in text.split(',').map(str::trim) {
            let side = Side::ALL.into_iter().find(|side| side.name() == word);
            let height = match word {
                "low" => Some(Height::Low),
                "high" => Some(Height::High),
                _ => None,
            };
            let is_said_twice =
                (side.is_some() && view.side.is_some()) || (height.is_some() && view.height.is_some());
            if is_said_twice || (side.is_none() && height.is_none()) {
                return Err(format!(
                    "{text:?} is not one of front, left, back and right, with low or high after a comma"
                ));
            }
            view.side = view.side.or(side);
            view.height = view.height.or(height);
        }
        Ok(view)
    }
}

impl View {
    /// The directions that agree with it.
    #[must_use]
    pub fn directions(self) -> Vec<ViewDirection> {
        let turns: Vec<f64> = match self.side {
            None => (0..N_TURNS)
                .map(|turn| TAU * f64::from(turn) / f64::from(N_TURNS))
                .collect(),
            Some(side) => (-BESIDE..=BESIDE)
                .map(|step| side.turn_rad() + BESIDE_RAD * f64::from(step))
                .collect(),
        };
        let elevations = match self.height {
            None => ELEVATIONS_DEG,
            Some(Height::Low) => LOW_DEG,
            Some(Height::High) => HIGH_DEG,
        };
        let directions = elevations.into_iter().flat_map(|elevation_deg| {
            let turns = turns.iter();
            turns.map(move |turn_rad| ViewDirection {
                turn_rad: *turn_rad,
                elevation_rad: elevation_deg.to_radians(),
            })
        });
        directions.collect()
    }
}
