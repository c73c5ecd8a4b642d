//! The state of a thing, by its evidence.

/// Evidence that a thing needs if it was marked in the previous picture, over that of a single
/// picture.
pub(super) const HELD: f32 = 0.5;

/// State of a thing in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Known {
    /// There is hardly any evidence for it.
    #[default]
    Nothing,
    /// It has less evidence than it needs, but enough to stay if it had been marked before.
    Candidate,
    /// It is marked.
    Marked,
}

impl Known {
    /// The state of a thing that needs `needed` times the evidence of a single picture.
    pub(super) fn of(needed: f32, has: impl Fn(f32) -> bool) -> Self {
        if has(needed) {
            Self::Marked
        } else if has(HELD) {
            Self::Candidate
        } else {
            Self::Nothing
        }
    }
}
