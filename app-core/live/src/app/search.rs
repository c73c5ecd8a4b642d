//! Search on another thread for a toy that was put on the table: its presence and its turn.

use std::sync::Arc;

use glam::{DMat4, DVec2, DVec3, UVec2};

use super::aligning::FOUND_PX;
use app_alignment::{NewObject, StandingPose, StandingSearch, TableChange};
use app_scene::frame::FrameInput;
use app_scene::scene::Scene;

/// Time between two examinations of the table, in seconds.
const LOOK_S: f64 = 0.4;
/// Largest movement in metres and relative change of size between examinations at which a new thing
/// counts as standing still: a hand holds the phone.
const STILL_M: f64 = 0.015;
const STILL_SHARE: f64 = 0.25;
/// The same for a thing that was searched in vain: beyond, it is gone, or it is another thing.
const GONE_M: f64 = 0.05;
const GONE_SHARE: f64 = 0.5;
/// Number of consecutive examinations of an empty table after which a thing is gone.
const N_EMPTY: u32 = 2;
/// Waiting time after which the person gets more advice.
const LONG_S: f64 = 6.0;

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
    Look(Box<Look>),
    Step(Box<StandingSearch>),
}

/// A look at the table.
#[derive(Debug)]
struct Look {
    scene: Scene,
    input: FrameInput,
    /// The place of a thing that was searched before.
    searched_at: Option<DVec3>,
}

impl Look {
    /// Without a view of the searched place the table does not count as empty.
    fn change(&self) -> TableChange {
        let change = TableChange::of(&self.scene, &self.input).unwrap_or(TableChange::AtBorder);
        match change {
            TableChange::None if !self.searched_at.is_none_or(|at| self.sees(at)) => TableChange::AtBorder,
            change => change,
        }
    }

    fn sees(&self, at: DVec3) -> bool {
        let size_px = UVec2::from_array(self.input.image.size_px()).as_dvec2();
        let pixel = self.input.camera.pixel_of(at);
        pixel.is_some_and(|pixel| pixel.cmpgt(DVec2::ZERO).all() && pixel.cmplt(size_px).all())
    }
}

impl SearchJob {
    /// Continues the search; some tenths of a second.
    #[must_use]
    pub fn run(self) -> SearchedJob {
        let result = match self.part {
            Part::Look(look) => SearchResult::Looked(look.change()),
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
    Looked(TableChange),
    Stepped(Box<StandingSearch>),
    Refused,
}

/// Cause and place of a search.
#[derive(Clone, Copy, Debug)]
enum Start {
    /// The ghost's place on a table without a plate.
    Given,
    /// A new thing on the table.
    Noticed(NewObject),
    /// A point of the world that the person has tapped, or at which the platform has recognised the
    /// toy.
    At(DVec3),
}

/// Stage of the search.
#[derive(Debug, Default)]
enum Stage {
    /// The table is examined from time to time; holds the new thing of the last examination.
    Watch(Option<NewObject>),
    /// A search begins with the next frame that has a pose.
    Begin(Start),
    /// The search waits for its next step.
    Step(Start, Box<StandingSearch>),
    /// The search is at a step.
    AtWork(Start),
    /// The search has ended. If it was for a new thing, the table is examined from time to time: it
    /// may have been a false alarm.
    Ended(Start),
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
    /// Number of the search that a thread works for: there is one thread at most, also for a search
    /// that was dropped.
    at_work: Option<u64>,
    /// Seconds since the last examination, and since the start of the search.
    looked_s: f64,
    waited_s: f64,
    /// Number of latest examinations that showed an empty table.
    n_empty: u32,
    pub(super) best: Option<StandingPose>,
}

impl Search {
    /// Starts again: with a plate it waits for a new thing on the table, otherwise it searches at
    /// the ghost's place.
    pub(super) fn begin(&mut self, has_plate: bool) {
        let stage = if has_plate {
            Stage::Watch(None)
        } else {
            Stage::Begin(Start::Given)
        };
        self.turn_to(stage);
    }

    /// Leaves the ghost to the person from now on.
    pub(super) fn give_up(&mut self) {
        self.turn_to(Stage::ByHand);
    }

    /// Starts at once, at a point of the world, with a ghost's pose until a better one is known.
    pub(super) fn look_again(&mut self, at: DVec3, ghost: Option<DMat4>) {
        self.turn_to(Stage::Begin(Start::At(at)));
        self.best = ghost.map(|world_from_object| StandingPose {
            world_from_object,
            outline_px: None,
        });
    }

    /// Handles a thread that did not end: the person goes on by hand.
    pub(super) fn die(&mut self) {
        if self.at_work.take() == Some(self.number) {
            self.give_up();
        }
    }

    fn turn_to(&mut self, stage: Stage) {
        *self = Self {
            number: self.number + 1,
            stage,
            // Its result is dropped.
            at_work: self.at_work,
            ..Self::default()
        };
    }

    /// Whether the ghost was left to the person.
    pub(super) fn is_by_hand(&self) -> bool {
        matches!(self.stage, Stage::ByHand)
    }

    /// Whether the search has ended with a pose that matches the picture.
    fn is_found(&self) -> bool {
        self.placing() == Placing::Asked { is_searching: false }
    }

    /// The state of the question.
    pub(super) fn placing(&self) -> Placing {
        match (&self.stage, self.best) {
            (Stage::ByHand, _) => Placing::ByHand,
            (Stage::Ended(_), Some(best)) if best.outline_px.is_some_and(|px| px <= FOUND_PX) => {
                Placing::Asked { is_searching: false }
            }
            // A thing that no turn of the toy fits is none.
            (Stage::Watch(_) | Stage::Ended(Start::Noticed(_)), None) => Placing::Waiting {
                is_long: self.waited_s > LONG_S,
            },
            // No pose matches the outline: the person turns the best start.
            (Stage::Ended(_), _) => Placing::ByHand,
            (_, Some(_)) => Placing::Asked { is_searching: true },
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
        if self.at_work.is_some() {
            return None;
        }
        let part = if self.watches() {
            if self.looked_s < LOOK_S {
                return None;
            }
            let (scene, input) = frame()?;
            self.looked_s = 0.0;
            let searched_at = match self.stage {
                Stage::Ended(Start::Noticed(before)) => Some(before.at),
                _ => None,
            };
            Part::Look(Box::new(Look {
                scene,
                input,
                searched_at,
            }))
        } else if let Stage::Begin(start) = self.stage {
            let (scene, input) = frame()?;
            let search = StandingSearch::new(Arc::new(scene), input);
            self.stage = Stage::AtWork(start);
            Part::Step(Box::new(match start {
                Start::At(at) => search.at(at),
                Start::Given | Start::Noticed(_) => search,
            }))
        } else {
            match std::mem::take(&mut self.stage) {
                Stage::Step(start, search) => {
                    self.stage = Stage::AtWork(start);
                    Part::Step(search)
                }
                stage => {
                    self.stage = stage;
                    return None;
                }
            }
        };
        self.at_work = Some(self.number);
        Some(SearchJob {
            number: self.number,
            part,
        })
    }

    /// Whether the table is examined from time to time.
    fn watches(&self) -> bool {
        matches!(self.stage, Stage::Watch(_) | Stage::Ended(Start::Noticed(_)))
    }

    /// Waits for the toy as before if a thing that was searched is no longer there. A found toy may
    /// also look different, as from another side.
    fn follow_searched(&mut self, before: NewObject, change: TableChange) {
        self.n_empty = match change {
            TableChange::None => self.n_empty + 1,
            TableChange::Object(_) | TableChange::AtBorder => 0,
        };
        let is_other = |now| !is_same([before, now], (GONE_M, GONE_SHARE));
        let is_replaced = !self.is_found() && object_of(change).is_some_and(is_other);
        if is_replaced || self.n_empty >= N_EMPTY {
            self.turn_to(Stage::Watch(object_of(change)));
        }
    }

    /// Adopts the result of a part. Returns whether there is a better pose.
    pub(super) fn take(&mut self, done: SearchedJob) -> bool {
        self.at_work = None;
        if done.number != self.number {
            return false;
        }
        match (done.result, &self.stage) {
            (SearchResult::Looked(change), Stage::Watch(before)) => {
                let seen = object_of(change);
                self.stage = match (*before, seen) {
                    (Some(before), Some(now)) if is_same([before, now], (STILL_M, STILL_SHARE)) => {
                        Stage::Begin(Start::Noticed(now))
                    }
                    _ => Stage::Watch(seen),
                };
            }
            (SearchResult::Looked(change), &Stage::Ended(Start::Noticed(before))) => {
                self.follow_searched(before, change);
            }
            (SearchResult::Stepped(search), &Stage::AtWork(start)) => {
                let before = std::mem::replace(&mut self.best, search.best());
                self.stage = if search.is_done() {
                    Stage::Ended(start)
                } else {
                    Stage::Step(start, search)
                };
                return before != self.best;
            }
            (SearchResult::Refused, &Stage::AtWork(start)) => self.stage = Stage::Ended(start),
            _ => {}
        }
        false
    }
}

fn object_of(change: TableChange) -> Option<NewObject> {
    match change {
        TableChange::Object(object) => Some(object),
        TableChange::None | TableChange::AtBorder => None,
    }
}

/// Whether a new thing is the same as before, within a distance in metres and a relative change of
/// its size.
fn is_same([before, now]: [NewObject; 2], (within_m, within_share): (f64, f64)) -> bool {
    before.at.distance(now.at) < within_m && (now.share - before.share).abs() < within_share * before.share
}
