//! The pose of a part, and its motion in a clip.

use glam::{DMat4, DQuat, DVec3};

/// Place and turn of a part in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Place of its origin.
    pub place_m: DVec3,
    /// Its rotation, a unit quaternion.
    pub turn: DQuat,
}

/// A stance at a moment of a clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Since the clip began.
    pub time_secs: f64,
    /// The stance then.
    pub stance: Stance,
}

impl Stance {
    /// A stance without a turn.
    #[must_use]
    pub fn at(place_m: DVec3) -> Self {
        Self {
            place_m,
            turn: DQuat::IDENTITY,
        }
    }

    /// The same stance, turned.
    #[must_use]
    pub fn turned(self, turn: DQuat) -> Self {
        Self { turn, ..self }
    }

    /// The same stance in a mirror that swaps the sign of x.
    #[must_use]
    pub fn mirrored(self) -> Self {
        let DQuat { x, y, z, w } = self.turn;
        Self {
            place_m: self.place_m * DVec3::new(-1.0, 1.0, 1.0),
            turn: DQuat::from_xyzw(x, -y, -z, w),
        }
    }

    /// The transform from the part's space to object space.
    #[must_use]
    pub fn object_from_part(self) -> DMat4 {
        DMat4::from_rotation_translation(self.turn, self.place_m)
    }
}

/// The stance at a moment: places are interpolated linearly, turns along the shorter arc. Before
/// the first key it is that key's, after the last one the last's; without keys it is `rest`.
/// Source: glTF 2.0, appendix C.
#[must_use]
pub(super) fn stance_at(rest: Stance, keys: &[Key], time_secs: f64) -> Stance {
    let after = keys.partition_point(|key| key.time_secs <= time_secs);
    let before = after.checked_sub(1).map(|index| keys[index]);
    match (before, keys.get(after)) {
        (None, None) => rest,
        (Some(only), None) => only.stance,
        (None, Some(only)) => only.stance,
        (Some(from), Some(to)) => {
            let s = (time_secs - from.time_secs) / (to.time_secs - from.time_secs);
            Stance {
                place_m: from.stance.place_m.lerp(to.stance.place_m, s),
                turn: from.stance.turn.slerp(to.stance.turn, s),
            }
        }
    }
}
