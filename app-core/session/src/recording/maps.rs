//! The maps of a frame, of which a recording has a channel each.

use super::topics::Topic;

/// Number of kinds of maps.
pub(super) const N_MAPS: usize = 2;
/// Channels of the maps, in the order of [`Maps::in_order`].
pub(super) const MAP_TOPICS: [Topic; N_MAPS] = [Topic::Depth, Topic::People];

/// Something of each map of a frame, `None` for maps that it lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Maps<T> {
    /// Of its depths.
    pub depth: Option<T>,
    /// Of its mask of people.
    pub people: Option<T>,
}

impl<T> Default for Maps<T> {
    /// None of any.
    fn default() -> Self {
        Self {
            depth: None,
            people: None,
        }
    }
}

impl<T> Maps<T> {
    /// All, in a fixed order.
    #[must_use]
    pub fn in_order(self) -> [Option<T>; N_MAPS] {
        [self.depth, self.people]
    }

    /// The inverse of [`Self::in_order`].
    #[must_use]
    pub fn from_ordered([depth, people]: [Option<T>; N_MAPS]) -> Self {
        Self { depth, people }
    }

    /// References to all.
    #[must_use]
    pub fn as_ref(&self) -> Maps<&T> {
        Maps {
            depth: self.depth.as_ref(),
            people: self.people.as_ref(),
        }
    }

    /// The same of other values.
    #[must_use]
    pub fn map<U>(self, of: impl Fn(T) -> U) -> Maps<U> {
        Maps {
            depth: self.depth.map(&of),
            people: self.people.map(&of),
        }
    }
}
