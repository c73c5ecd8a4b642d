//! Which camera frames are taken, and how much time lies between them.

/// Time after which what was filtered over frames no longer holds.
const LONGEST_GAP_S: f64 = 0.25;
/// A picture that is older when it is delivered was timed by another clock.
const OLDEST_NS: i64 = 1_000_000_000;

/// A camera frame's place in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Counted by the camera.
    pub id: u64,
    /// On the camera's own clock, which no other is compared with.
    pub time_ns: i64,
    /// Counts how often the tracker began a new world: resets and relocalisations.
    pub world_epoch: u32,
}

impl Stamp {
    /// Milliseconds from the picture until `now_ns` on a clock of the processor. None where that is not the camera's clock, by which
    /// the picture would be of the future, or older than a camera's can be.
    #[must_use]
    pub fn age_ms(&self, now_ns: i64) -> Option<f64> {
        let age_ns = now_ns.checked_sub(self.time_ns)?;
        (0..=OLDEST_NS).contains(&age_ns).then(|| age_ns as f64 / 1e6)
    }
}

/// What becomes of a frame that arrives.
///
/// | | frame is taken | what was filtered | what was learned of the place |
/// | --- | --- | --- | --- |
/// | `First` | yes | begins | begins |
/// | `Next`, whatever the gap up to 250 ms | yes | goes on by the elapsed time | stays |
/// | `AfterGap` | yes | begins anew | stays |
/// | `NewWorld` | yes | begins anew | is dropped: poses of before are of another world |
/// | `Again` | no, the picture shown stays | stays | stays |
/// | `Late` | no, the picture shown stays | stays | stays |
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrival {
    /// The first of all.
    First,
    /// Later than the last by so much.
    Next {
        /// Seconds.
        elapsed_s: f64,
    },
    /// Later by more than filters can bridge.
    AfterGap {
        /// Seconds.
        elapsed_s: f64,
    },
    /// In a world of its own.
    NewWorld,
    /// The last one once more.
    Again,
    /// Older than the last, or of an older world.
    Late,
}

impl Arrival {
    /// Whether the frame is taken.
    #[must_use]
    pub fn is_taken(self) -> bool {
        !matches!(self, Self::Again | Self::Late)
    }
}

/// Follows the stamps of a camera's frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arrivals {
    latest: Option<Stamp>,
}

impl Arrivals {
    /// What becomes of the frame of `stamp`; those that are taken are the latest from then on.
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
    // In 128 bits, since clocks may begin anywhere.
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
