//! What a person should hear of, for some seconds.

use super::event::{Recorded, Saved};
use super::launch_history::Simplified;

/// How long it stands, in seconds.
const SHOWN_S: f64 = 6.0;

/// Why the lens was not photographed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LensFailure {
    /// The camera cannot be darkened, or does not tell.
    NotDark,
    /// No light is seen on it.
    NoLight,
    /// It is not in the picture, or the picture makes no sense.
    NotSeen,
}

/// What a person should hear of.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// There is no table where the person tapped.
    NoTableThere,
    /// The toy is not where its ghost is: so many pixels, where that is known.
    ToyMissed {
        /// Outline to picture.
        outline_px: Option<f64>,
    },
    /// The lens was photographed, and shows so many lights.
    LensTaken(usize),
    /// It was not, and why.
    LensFailed(LensFailure),
    /// This phone does not look for the printed card.
    CardRefused,
    /// A file is no toy, and why.
    ToyRefused(String),
    /// The tracker has lost the place.
    WorldLost,
    /// Graphics had to be set up again.
    DeviceRestarted,
    /// A panic ended the app, and it began anew.
    Restarted,
    /// A photo, a video or what is to be shared.
    Saved(Saved),
    /// A recording has ended.
    Recorded(Recorded),
    /// A recording has ended without a frame.
    NothingRecorded,
    /// Frames come faster than they are written: the recording lacks some.
    RecordingDrops,
    /// A recording cannot begin.
    NoRoomToRecord,
    /// Memory is short: what was being kept was ended.
    MemoryLow,
    /// The questions of a new phone were answered, so many by yes.
    PhoneChecked {
        /// Of [`PhoneQuestion::ALL`](super::PhoneQuestion::ALL).
        n_yes: usize,
    },
    /// The simplest preset is used.
    Simplified(Simplified),
}

/// The latest notice.
#[derive(Clone, Debug, Default)]
pub(super) struct Notices {
    latest: Option<(f64, Notice)>,
}

impl Notices {
    pub(super) fn tell(&mut self, time_s: f64, notice: Notice) {
        self.latest = Some((time_s, notice));
    }

    pub(super) fn at(&self, time_s: f64) -> Option<&Notice> {
        let (told_s, notice) = self.latest.as_ref()?;
        (time_s - told_s < SHOWN_S).then_some(notice)
    }
}
