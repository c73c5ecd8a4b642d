//! Selects the camera frames to use, and measures the time between them.

/// Gap in seconds after which state filtered over frames is no longer valid, and the most that a
/// pause counts for clocks.
pub const LONGEST_GAP_S: f64 = 0.25;
/// A picture that is older than this at delivery was timed by another clock.
const OLDEST_NS: i64 = 1_000_000_000;

/// The time stamp of a camera frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Number of the frame, counted by the camera.
    pub id: u64,
    /// Time on the camera's own clock, which is compared with no other.
    pub time_ns: i64,
    /// Number of worlds that the tracker has begun: resets and relocalisations.
    pub world_epoch: u32,
}

impl Stamp {
    /// Milliseconds from the picture until `now_ns` on a clock of the processor. `None` if that is
    /// not the camera's clock, which is concluded from an age that is negative or too large for a
    /// camera.
    #[must_use]
    pub fn age_ms(&self, now_ns: i64) -> Option<f64> {
        let age_ns = now_ns.checked_sub(self.time_ns)?;
        (0..=OLDEST_NS).contains(&age_ns).then(|| age_ns as f64 / 1e6)
    }
}

/// The handling of a frame that arrives.
///
/// | | frame is used | filtered state | state learned about the place |
/// | --- | --- | --- | --- |
/// | `First` | yes | begins | begins |
/// | `Next`, whatever the gap up to 250 ms | yes | goes on by the elapsed time | stays |
/// | `AfterGap` | yes | begins anew | stays |
/// | `NewWorld` | yes | begins anew | is dropped: earlier poses belong to another world |
/// | `Again` | no, the picture shown stays | stays | stays |
/// | `Late` | no, the picture shown stays | stays | stays |
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrival {
    /// The first frame.
    First,
    /// A frame later than the last.
    Next {
        /// Time since the last frame, in seconds.
        elapsed_s: f64,
    },
    /// A frame too late for filters to bridge the gap.
    AfterGap {
        /// Time since the last frame, in seconds.
        elapsed_s: f64,
    },
    /// A frame with a new world.
    NewWorld,
    /// The last frame once more.
    Again,
    /// A frame older than the last, or of an older world.
    Late,
}

impl Arrival {
    /// Whether the frame is used.
    #[must_use]
    pub fn is_taken(self) -> bool {
        !matches!(self, Self::Again | Self::Late)
    }

    /// Seconds by which filtered state goes on; 0 if it begins anew.
    #[must_use]
    pub fn filtered_s(self) -> f64 {
        match self {
            Self::Next { elapsed_s } => elapsed_s,
            _ => 0.0,
        }
    }

    /// Seconds by which clocks go on, such as that of a clip: the person has seen the last picture
    /// for all of a gap, but a pause is not made up for.
    #[must_use]
    pub fn counted_s(self) -> f64 {
        match self {
            Self::Next { elapsed_s } | Self::AfterGap { elapsed_s } => elapsed_s.min(LONGEST_GAP_S),
            _ => 0.0,
        }
    }
}

/// Compares the stamps of a camera's frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arrivals {
    latest: Option<Stamp>,
}

impl Arrivals {
    /// Classifies the frame of `stamp`; a used frame becomes the latest.
    pub fn arrive(&mut self, stamp: Stamp) -> Arrival {
        let arrival = self.latest.map_or(Arrival::First, |latest| after(latest, stamp));
        if arrival.is_taken() {
            self.latest = Some(stamp);
        }
        arrival
    }
}

fn after(latest: Stamp, stamp: Stamp) -> Arrival {
    if stamp.world_epoch < latest.world_epoch {
        return Arrival::Late;
    }
    if stamp.id == latest.id && stamp.time_ns == latest.time_ns && stamp.world_epoch == latest.world_epoch {
        return Arrival::Again;
    }
    if stamp.world_epoch > latest.world_epoch {
        return Arrival::NewWorld;
    }
    // In 128 bits, since clocks may begin at any number.
    let elapsed_ns = i128::from(stamp.time_ns) - i128::from(latest.time_ns);
    let elapsed_s = elapsed_ns as f64 * 1e-9;
    if elapsed_s < 0.0 {
        Arrival::Late
    } else if elapsed_ns == 0 {
        Arrival::Again
    } else if elapsed_s > LONGEST_GAP_S {
        Arrival::AfterGap { elapsed_s }
    } else {
        Arrival::Next { elapsed_s }
    }
}
