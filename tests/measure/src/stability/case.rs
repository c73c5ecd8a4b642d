//! A case of the table.

use super::lab::{Lab, Label};
use super::row::Findings;

/// The function of a case.
pub type Run = fn(&mut Lab, Label) -> anyhow::Result<Findings>;

/// A case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its group and name.
    pub label: Label,
    /// The scope in which it runs.
    pub scope: Scope,
    /// Runs it.
    pub run: Run,
}

impl Case {
    /// A case of a group.
    #[must_use]
    pub const fn new(group: &'static str, name: &'static str, scope: Scope, run: Run) -> Self {
        Self {
            label: Label { group, case: name },
            scope,
            run,
        }
    }
}

/// The scope in which a case runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// With the tests, too: it takes seconds.
    Quick,
    /// Only by the command.
    Whole,
    /// Only by the command, and only by name: it takes as long as all others together.
    Named,
}
