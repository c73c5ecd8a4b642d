//! Films: their grammar, the pose of each frame, and the content of their folder.

mod fine;
mod folder;
mod grammar;
mod names;
mod timeline;

use film::animate::grammar::ClipFacts;

/// Clips of a second and of half a second.
pub(crate) fn clips() -> Vec<ClipFacts> {
    [("Look", 1.0), ("Step", 0.5), ("a*b@2x", 0.25), ("hold:3", 0.1)]
        .map(|(name, duration_secs)| ClipFacts {
            name: name.to_owned(),
            duration_secs,
        })
        .into()
}
