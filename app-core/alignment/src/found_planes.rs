//! Keeps the found planes of things, which become receivers of the scene.

use std::sync::Arc;

use super::report::PlaneAlignment;
use super::things::Colored;
use app_scene::scene::{Receiver, Scene};

/// Most searches, in the first views that show things: each takes some seconds.
const MOST_SEARCHES: usize = 2;

/// A thing's plane as a receiver.
#[derive(Clone, Debug)]
pub(super) struct FoundReceiver {
    pub(super) receiver: Receiver,
    /// Index of the scene's receiver that it replaces.
    pub(super) instead_of: Option<usize>,
    pub(super) report: PlaneAlignment,
}

/// Planes that were found.
#[derive(Clone, Debug, Default)]
pub(super) struct FoundPlanes {
    found: Vec<FoundReceiver>,
    pub(super) report: Vec<PlaneAlignment>,
    /// Number of those that were found before the latest search.
    n_before: usize,
    n_searches: usize,
    /// Whether things in the place's own colours were searched.
    is_alike_searched: bool,
}

impl FoundPlanes {
    /// Whether a search is due.
    fn are_wanted(&self) -> bool {
        // The sides of a listed top are known without a thing's own plane.
        let is_found = self.report.iter().any(|plane| !plane.is_upright());
        !is_found && self.n_searches < MOST_SEARCHES
    }

    /// Things whose planes are to be searched, if a search is due: `may_be_alike` once those in the
    /// place's own colours, too, since these are sought anywhere.
    pub(super) fn wanted(&self, may_be_alike: bool) -> Option<Colored> {
        if !self.are_wanted() {
            return None;
        }
        Some(if may_be_alike && !self.is_alike_searched {
            Colored::Alike
        } else {
            Colored::Otherwise
        })
    }

    /// Adds the result of a search for the planes of such things in a view that shows things; whether it found any.
    pub(super) fn take(&mut self, planes: Vec<FoundReceiver>, planes_of: Option<Colored>) -> bool {
        self.n_searches += 1;
        self.is_alike_searched |= planes_of == Some(Colored::Alike);
        let is_any = !planes.is_empty();
        self.n_before = self.found.len();
        self.report.extend(planes.iter().map(|found| found.report));
        self.found.extend(planes);
        is_any
    }

    /// The largest loss of the tops that the latest search found by the toy's shadow; `None` if it found none.
    pub(super) fn latest_loss(&self) -> Option<f64> {
        let latest = self.found[self.n_before..].iter().map(|found| &found.report);
        // Those that edges alone have corrected have no loss.
        let tops = latest.filter(|plane| !plane.is_upright() && plane.losses != [0.0; 2]);
        tops.map(|plane| plane.losses[1]).reduce(f64::max)
    }

    /// With the searches that another count has.
    pub(super) fn count_as(&mut self, other: &Self) {
        (self.n_searches, self.is_alike_searched) = (other.n_searches, other.is_alike_searched);
    }

    /// Adds all planes to a scene that has none of them.
    pub(super) fn add_to(&self, scene: &mut Arc<Scene>) {
        add(&self.found, scene);
    }

    /// Adds the planes of the latest search to the scene in which it searched.
    pub(super) fn add_latest_to(&self, scene: &mut Arc<Scene>) {
        add(&self.found[self.n_before..], scene);
    }
}

fn add(found: &[FoundReceiver], scene: &mut Arc<Scene>) {
    for found in found {
        let receivers = &mut Arc::make_mut(scene).receivers;
        let receiver = found.receiver.clone();
        match found.instead_of.and_then(|index| receivers.get_mut(index)) {
            Some(known) => *known = receiver,
            None => receivers.push(receiver),
        }
    }
}
