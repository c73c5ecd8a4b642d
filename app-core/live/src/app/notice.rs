//! Notices for the person, which are shown for some seconds.

use super::aligning::Verdict;
use super::event::{Recorded, Saved};
use super::launch_history::Simplified;
use super::toy_refusal::ToyRefusal;

/// Duration of a notice, in seconds.
const SHOWN_S: f64 = 6.0;

/// The reason why the lens was not photographed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LensFailure {
    /// The camera cannot be darkened, or does not report its exposure.
    NotDark,
    /// No light is visible on it.
    NoLight,
    /// It is not in the picture, or the picture is unusable.
    NotSeen,
}

/// A notice for the person.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// There is no table where the person tapped.
    NoTableThere,
    /// The toy is not known to be at its ghost's place, according to this alignment.
    ToyMissed(Verdict),
    /// The empty place could not be photographed.
    NoPlate,
    /// The lens was photographed and shows this number of lights.
    LensTaken(usize),
    /// It was not photographed; with the reason.
    LensFailed(LensFailure),
    /// This phone does not detect the printed card.
    CardRefused,
    /// A file is not a toy; with the reason.
    ToyRefused(ToyRefusal),
    /// The tracker has lost the place.
    WorldLost,
    /// Graphics had to be set up again.
    DeviceRestarted,
    /// A panic ended the app, and it started again.
    Restarted,
    /// The toy's picture could not be made; the log has the reason.
    PictureFailed,
    /// A photo, a video or a shared file was saved.
    Saved(Saved),
    /// A video has ended and is saved, since its file can be no larger.
    VideoTooLarge,
    /// A recording has ended.
    Recorded(Recorded),
    /// A recording has ended without a frame.
    NothingRecorded,
    /// Frames arrive faster than they are written: the recording lacks some.
    RecordingDrops,
    /// A recording cannot begin.
    NoRoomToRecord,
    /// Memory is short: the video or recording was ended.
    MemoryLow,
    /// The questions for a new phone were answered.
    PhoneChecked {
        /// Number of those of [`PhoneQuestion::ALL`](super::PhoneQuestion::ALL) that were answered
        /// with yes.
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
