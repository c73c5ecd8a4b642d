//! Keeps the found planes of things, which become receivers of the scene.

use std::sync::Arc;

use super::report::PlaneAlignment;
use app_scene::scene::{Receiver, Scene};

/// Most searches, in the first views that show things: each takes some seconds.
const MOST_SEARCHES: usize = 2;

/// A thing's plane as a receiver.
#[derive(Debug)]
pub(super) struct FoundReceiver {
    pub(super) receiver: Receiver,
    /// Index of the scene's receiver that it replaces.
    pub(super) instead_of: Option<usize>,
    pub(super) report: PlaneAlignment,
}

/// Planes that were found.
#[derive(Debug, Default)]
pub(super) struct FoundPlanes {
    found: Vec<FoundReceiver>,
    pub(super) report: Vec<PlaneAlignment>,
    n_searches: usize,
}

impl FoundPlanes {
    /// Whether a search is due.
    pub(super) fn are_wanted(&self) -> bool {
        // The sides of a listed top are known without a thing's own plane.
        let is_found = self.report.iter().any(|plane| !plane.is_upright());
        !is_found && self.n_searches < MOST_SEARCHES
    }

    /// Adds the result of a search in a view that shows things; whether it found any.
    pub(super) fn take(&mut self, planes: Vec<FoundReceiver>) -> bool {
        self.n_searches += 1;
        let is_any = !planes.is_empty();
        self.report.extend(planes.iter().map(|found| found.report));
        self.found.extend(planes);
        is_any
    }

    /// Adds the planes to a scene, each once.
    pub(super) fn add_to(&self, scene: &mut Arc<Scene>) {
        for found in &self.found {
            let receivers = &mut Arc::make_mut(scene).receivers;
            let receiver = found.receiver.clone();
            match found.instead_of.and_then(|index| receivers.get_mut(index)) {
                Some(known) => *known = receiver,
                None => receivers.push(receiver),
            }
        }
    }
}
