//! The interface for screen readers.

use super::Live;
use crate::interface::{Widget, accesskit};

impl Live {
    /// The elements of the latest picture for a screen reader.
    #[must_use]
    pub fn widgets(&self) -> &[Widget] {
        self.interface.widgets()
    }

    /// The whole tree of the latest picture for a platform's adapter of AccessKit; `None` before
    /// the first picture.
    #[must_use]
    pub fn accessibility_tree(&self) -> Option<&accesskit::TreeUpdate> {
        self.interface.accessibility_tree()
    }

    /// Executes an action of a screen reader with the next picture.
    pub fn request(&mut self, request: accesskit::ActionRequest) {
        self.interface.request(request);
    }
}
