//! The search for things beside the toy between two alignments, on another thread.

use app_alignment::{Conditions, ThingWatcher, Watched};
use app_scene::frame::FrameInput;
use app_scene::things::Things;

/// Time between the starts of two searches, in seconds: a hand moves by a few centimetres.
const PERIOD_S: f64 = 0.2;

/// One search, for another thread.
#[derive(Debug)]
pub struct WatchJob {
    place: u64,
    time_s: f64,
    watcher: ThingWatcher,
    conditions: Conditions,
    input: FrameInput,
}

impl WatchJob {
    /// Runs the search, which takes a tenth of a second or two.
    #[must_use]
    pub fn run(mut self) -> WatchedJob {
        let watched = self.watcher.look(&self.conditions, &self.input).ok();
        WatchedJob {
            place: self.place,
            time_s: self.time_s,
            watcher: self.watcher,
            watched,
        }
    }

    /// The result if the thread of the search does not end normally: nothing, and a new watcher.
    #[must_use]
    pub fn without_result(&self) -> WatchedJob {
        WatchedJob {
            place: self.place,
            time_s: self.time_s,
            watcher: ThingWatcher::default(),
            watched: None,
        }
    }
}

/// The result of a search.
#[derive(Debug)]
pub struct WatchedJob {
    place: u64,
    time_s: f64,
    watcher: ThingWatcher,
    /// `None` if the search failed.
    watched: Option<Watched>,
}

/// The things beside a placed toy, and the search for them.
#[derive(Debug)]
pub(super) struct Watch {
    /// Number of the place: results of another place are dropped.
    place: u64,
    /// `None` while it runs on its thread.
    watcher: Option<ThingWatcher>,
    started_s: Option<f64>,
    /// Of the latest alignment; `None` if it did not find the toy.
    conditions: Option<Conditions>,
    things: Option<Things>,
    /// Time of the picture of `things`.
    seen_s: Option<f64>,
}

impl Watch {
    pub(super) fn new(place: u64) -> Self {
        Self {
            place,
            watcher: Some(ThingWatcher::default()),
            started_s: None,
            conditions: None,
            things: None,
            seen_s: None,
        }
    }

    /// The things in the latest picture that was searched.
    pub(super) fn things(&self) -> Option<Things> {
        self.things.clone()
    }

    /// Adopts the result of an alignment of the picture at `time_s`; its things unless those of a
    /// later picture are known.
    pub(super) fn align(
        &mut self,
        conditions: Option<Conditions>,
        things: Option<Things>,
        time_s: Option<f64>,
    ) {
        self.conditions = conditions;
        if self
            .seen_s
            .is_none_or(|seen_s| time_s.is_some_and(|time_s| time_s >= seen_s))
        {
            (self.things, self.seen_s) = (things, time_s);
        }
    }

    /// Forgets the things, since the toy is not where it was.
    pub(super) fn forget(&mut self) {
        *self = Self {
            watcher: self.watcher.take(),
            started_s: self.started_s,
            ..Self::new(self.place)
        };
    }

    /// A search in `input`, which has the corrections of the latest alignment, if one is due.
    pub(super) fn job(&mut self, time_s: f64, input: FrameInput) -> Option<WatchJob> {
        let is_due = self
            .started_s
            .is_none_or(|started_s| time_s - started_s >= PERIOD_S);
        if !is_due {
            return None;
        }
        let conditions = self.conditions.clone()?;
        let watcher = self.watcher.take()?;
        self.started_s = Some(time_s);
        // A platform lends only a few pictures.
        let kept = input.image.kept();
        Some(WatchJob {
            place: self.place,
            time_s,
            watcher,
            conditions,
            input: input.with_image(kept),
        })
    }

    /// Adopts the result of a search.
    pub(super) fn take(&mut self, done: WatchedJob) {
        if done.place != self.place {
            return;
        }
        self.watcher = Some(done.watcher);
        let is_later = self.seen_s.is_none_or(|seen_s| done.time_s >= seen_s);
        if self.conditions.is_none() || !is_later {
            return;
        }
        match done.watched {
            // An alignment may have found other things in between, in an earlier picture.
            Some(Watched::Unchanged(things) | Watched::Things(things)) => {
                (self.things, self.seen_s) = (things, Some(done.time_s));
            }
            None => self.things = None,
        }
    }
}
