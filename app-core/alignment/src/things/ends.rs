//! Where things before the toy end, as the marks of a picture tell with them.

use app_scene::things::{Front, Mark};

/// Where things before the toy end.
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    /// The fronts in the world of all things before the toy; empty if they are unknown.
    pub(super) fronts: Vec<Front>,
    /// Indices of pixels that are before the toy, though they hide nothing of the real one.
    pub(super) before: Vec<usize>,
}

impl Ends {
    /// Marks pixels of things as before the toy.
    pub(super) fn mark(&self, marks: &mut [Mark]) {
        for index in &self.before {
            if marks[*index] == Mark::Thing {
                marks[*index] = Mark::BeforeToy;
            }
        }
    }
}
