//! Search on another thread for a toy that was put on the table: its presence and its turn.

use std::sync::Arc;

use glam::DMat4;

use app_alignment::{NewObject, StandingPose, StandingSearch};
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

/// Time between two examinations of the table, in seconds.
const LOOK_S: f64 = 0.4;
/// Largest movement in metres and relative change of size between examinations at which a new thing
/// counts as standing still: a hand holds the phone.
const STILL_M: f64 = 0.015;
const STILL_SHARE: f64 = 0.25;
/// Waiting time after which the person gets more advice.
const LONG_S: f64 = 6.0;
/// Largest distance between the outlines of a found pose and the picture, in pixels.
const FOUND_PX: f64 = 1.5;

/// State of the question about the toy's place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placing {
    /// The app waits for the toy.
    Waiting {
        /// Whether it waits so long that the toy may be there undetected.
        is_long: bool,
    },
    /// Something is there and is being examined.
    Looking,
    /// The ghost shows the estimated pose of the toy.
    Asked {
        /// Whether the pose may still improve.
        is_searching: bool,
    },
    /// The person moves and turns the ghost.
    ByHand,
}

/// A part of the search, as a job for another thread.
#[derive(Debug)]
pub struct SearchJob {
    number: u64,
    part: Part,
}

#[derive(Debug)]
enum Part {
    Look(Arc<Scene>, Box<FrameInput>),
    Step(Box<StandingSearch>),
}

impl SearchJob {
    /// Continues the search; some tenths of a second.
    #[must_use]
    pub fn run(self) -> SearchedJob {
        let result = match self.part {
            Part::Look(scene, input) => SearchResult::Looked(NewObject::of(&scene, &input).ok().flatten()),
            Part::Step(mut search) => match search.step() {
                Ok(()) => SearchResult::Stepped(search),
                Err(_) => SearchResult::Refused,
            },
        };
        SearchedJob {
            number: self.number,
            result,
        }
    }
}

/// The result of a search job.
#[derive(Debug)]
pub struct SearchedJob {
    number: u64,
    result: SearchResult,
}

#[derive(Debug)]
enum SearchResult {
    Looked(Option<NewObject>),
    Stepped(Box<StandingSearch>),
    Refused,
}

/// Stage of the search.
#[derive(Debug, Default)]
enum Stage {
    /// The table is examined from time to time; holds the new thing of the last examination.
    Watch(Option<NewObject>),
    /// A search begins with the next frame that has a pose.
    Begin,
    /// The search waits for its next step.
    Step(Box<StandingSearch>),
    /// The search has ended.
    Ended,
    /// The person moves the ghost.
    #[default]
    ByHand,
}

/// The search for a placed toy.
#[derive(Debug, Default)]
pub(super) struct Search {
    /// Number of the search: results of another search are dropped.
    number: u64,
    stage: Stage,
    is_at_work: bool,
    /// Seconds since the last examination, and since the start of the search.
    looked_s: f64,
    waited_s: f64,
    pub(super) best: Option<StandingPose>,
}

impl Search {
    /// Starts again: with a plate it waits for a new thing on the table, otherwise it searches at
    /// the ghost's place.
    pub(super) fn begin(&mut self, has_plate: bool) {
        let stage = if has_plate {
            Stage::Watch(None)
        } else {
            Stage::Begin
        };
        self.turn_to(stage);
    }

    /// Leaves the ghost to the person from now on.
    pub(super) fn give_up(&mut self) {
        self.turn_to(Stage::ByHand);
    }

    /// Starts at once, at a ghost's place.
    pub(super) fn look_again(&mut self, world_from_object: DMat4) {
        self.turn_to(Stage::Begin);
        self.best = Some(StandingPose {
            world_from_object,
            outline_px: None,
        });
    }

    /// Handles a thread that did not end: the person goes on by hand.
    pub(super) fn die(&mut self) {
        if self.is_at_work {
            self.give_up();
        }
    }

    fn turn_to(&mut self, stage: Stage) {
        *self = Self {
            number: self.number + 1,
            stage,
            // A thread that works on an earlier place is not waited for.
            ..Self::default()
        };
    }

    /// The state of the question.
    pub(super) fn placing(&self) -> Placing {
        match (&self.stage, self.best) {
            (Stage::ByHand, _) => Placing::ByHand,
            (Stage::Ended, Some(best)) if best.outline_px.is_some_and(|px| px <= FOUND_PX) => {
                Placing::Asked { is_searching: false }
            }
            // No pose matches the outline: the person turns the best start.
            (Stage::Ended, _) => Placing::ByHand,
            (_, Some(_)) => Placing::Asked { is_searching: true },
            (Stage::Watch(_), None) => Placing::Waiting {
                is_long: self.waited_s > LONG_S,
            },
            (_, None) => Placing::Looking,
        }
    }

    /// The next part, if one is due; `frame` is the latest with a pose.
    pub(super) fn job(
        &mut self,
        elapsed_s: f64,
        frame: impl FnOnce() -> Option<(Scene, FrameInput)>,
    ) -> Option<SearchJob> {
        self.looked_s += elapsed_s;
        self.waited_s += elapsed_s;
        if self.is_at_work {
            return None;
        }
        let part = match std::mem::take(&mut self.stage) {
            Stage::Watch(seen) => {
                self.stage = Stage::Watch(seen);
                if self.looked_s < LOOK_S {
                    return None;
                }
                let (scene, input) = frame()?;
                self.looked_s = 0.0;
                Part::Look(Arc::new(scene), Box::new(input))
            }
            Stage::Begin => {
                self.stage = Stage::Begin;
                let (scene, input) = frame()?;
                Part::Step(Box::new(StandingSearch::new(Arc::new(scene), input)))
            }
            Stage::Step(search) => {
                self.stage = Stage::Begin;
                Part::Step(search)
            }
            ended => {
                self.stage = ended;
                return None;
            }
        };
        self.is_at_work = true;
        Some(SearchJob {
            number: self.number,
            part,
        })
    }

    /// Adopts the result of a part. Returns whether there is a better pose.
    pub(super) fn take(&mut self, done: SearchedJob) -> bool {
        if done.number != self.number {
            return false;
        }
        self.is_at_work = false;
        match done.result {
            SearchResult::Looked(seen) => {
                if let Stage::Watch(before) = std::mem::take(&mut self.stage) {
                    self.stage = match (before, seen) {
                        (Some(before), Some(now)) if is_still([before, now]) => Stage::Begin,
                        _ => Stage::Watch(seen),
                    };
                }
                false
            }
            SearchResult::Stepped(search) => {
                let before = std::mem::replace(&mut self.best, search.best());
                self.stage = if search.is_done() {
                    Stage::Ended
                } else {
                    Stage::Step(search)
                };
                before != self.best
            }
            SearchResult::Refused => {
                self.stage = Stage::Ended;
                false
            }
        }
    }
}

/// Whether the new thing is the same, at the same place.
fn is_still([before, now]: [NewObject; 2]) -> bool {
    before.at.distance(now.at) < STILL_M && (now.share - before.share).abs() < STILL_SHARE * before.share
}
