//! A toy that was put on the table, found on another thread: when something stands there, and how it is turned.

use std::sync::Arc;

use glam::DMat4;

use app_alignment::{Newcomer, StandingPose, StandingSearch};
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

/// Time between two looks at the table, in seconds.
const LOOK_S: f64 = 0.4;
/// What is new there stands still if it moves by less from look to look, in metres, and its size changes by a smaller part: the phone is
/// held by a hand.
const STILL_M: f64 = 0.015;
const STILL_SHARE: f64 = 0.25;
/// A person who waits for longer is told what else helps.
const LONG_S: f64 = 6.0;
/// An outline that comes no nearer to the picture's, in pixels, is no find.
const FOUND_PX: f64 = 1.5;

/// How a person is asked where the toy is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Placing {
    /// The toy is waited for.
    Waiting {
        /// For so long that it may stand there unseen.
        is_long: bool,
    },
    /// Something stands there and is looked at.
    Looking,
    /// The ghost shows where the toy seems to be.
    Asked {
        /// It may still become better.
        is_searching: bool,
    },
    /// The person moves and turns the ghost.
    ByHand,
}

/// A part of the search, for another thread.
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
    /// Searches on; some tenths of a second.
    #[must_use]
    pub fn run(self) -> SearchedJob {
        let come = match self.part {
            Part::Look(scene, input) => Come::Looked(Newcomer::of(&scene, &input).ok().flatten()),
            Part::Step(mut search) => match search.step() {
                Ok(()) => Come::Stepped(search),
                Err(_) => Come::Refused,
            },
        };
        SearchedJob {
            number: self.number,
            come,
        }
    }
}

/// What came of it.
#[derive(Debug)]
pub struct SearchedJob {
    number: u64,
    come: Come,
}

#[derive(Debug)]
enum Come {
    Looked(Option<Newcomer>),
    Stepped(Box<StandingSearch>),
    Refused,
}

/// What is going on.
#[derive(Debug, Default)]
enum Stage {
    /// The table is looked at from time to time; what was new there at the last look.
    Watch(Option<Newcomer>),
    /// A search begins with the next frame that has a pose.
    Begin,
    /// It waits for its next step.
    Step(Box<StandingSearch>),
    /// It has come to its end.
    Ended,
    /// The person moves the ghost.
    #[default]
    ByHand,
}

/// The search for a toy that is placed.
#[derive(Debug, Default)]
pub(super) struct Search {
    /// Counts searches: results of another are not taken.
    number: u64,
    stage: Stage,
    is_at_work: bool,
    /// Since the last look, and since the search was begun.
    looked_s: f64,
    waited_s: f64,
    pub(super) best: Option<StandingPose>,
}

impl Search {
    /// Begins anew: with a plate it waits until something new stands on the table, else it is where the ghost is.
    pub(super) fn begin(&mut self, has_plate: bool) {
        let stage = if has_plate {
            Stage::Watch(None)
        } else {
            Stage::Begin
        };
        self.turn_to(stage);
    }

    /// The ghost is a person's from now on.
    pub(super) fn give_up(&mut self) {
        self.turn_to(Stage::ByHand);
    }

    /// Begins at once, where a ghost was put.
    pub(super) fn look_again(&mut self, world_from_object: DMat4) {
        self.turn_to(Stage::Begin);
        self.best = Some(StandingPose {
            world_from_object,
            outline_px: None,
        });
    }

    /// The thread of a part did not come to an end: the person goes on by hand.
    pub(super) fn die(&mut self) {
        if self.is_at_work {
            self.give_up();
        }
    }

    fn turn_to(&mut self, stage: Stage) {
        *self = Self {
            number: self.number + 1,
            stage,
            // A thread that works on what was before is not waited for.
            ..Self::default()
        };
    }

    /// How the person is asked.
    pub(super) fn placing(&self) -> Placing {
        match (&self.stage, self.best) {
            (Stage::ByHand, _) => Placing::ByHand,
            (Stage::Ended, Some(best)) if best.outline_px.is_some_and(|px| px <= FOUND_PX) => {
                Placing::Asked { is_searching: false }
            }
            // Nothing meets the outline: the best start is the person's to turn.
            (Stage::Ended, _) => Placing::ByHand,
            (_, Some(_)) => Placing::Asked { is_searching: true },
            (Stage::Watch(_), None) => Placing::Waiting {
                is_long: self.waited_s > LONG_S,
            },
            (_, None) => Placing::Looking,
        }
    }

    /// The next part, if it is time for one; `frame` is the latest that has a pose.
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

    /// Takes what came of a part; whether there is a better pose.
    pub(super) fn take(&mut self, done: SearchedJob) -> bool {
        if done.number != self.number {
            return false;
        }
        self.is_at_work = false;
        match done.come {
            Come::Looked(seen) => {
                if let Stage::Watch(before) = std::mem::take(&mut self.stage) {
                    self.stage = match (before, seen) {
                        (Some(before), Some(now)) if is_still([before, now]) => Stage::Begin,
                        _ => Stage::Watch(seen),
                    };
                }
                false
            }
            Come::Stepped(search) => {
                let before = std::mem::replace(&mut self.best, search.best());
                self.stage = if search.is_done() {
                    Stage::Ended
                } else {
                    Stage::Step(search)
                };
                before != self.best
            }
            Come::Refused => {
                self.stage = Stage::Ended;
                false
            }
        }
    }
}

/// Whether what is new is the same, in the same place.
fn is_still([before, now]: [Newcomer; 2]) -> bool {
    before.at.distance(now.at) < STILL_M && (now.share - before.share).abs() < STILL_SHARE * before.share
}
