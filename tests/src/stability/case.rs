//! A case of the table.

use super::lab::{Lab, Label};
use super::row::Findings;

/// How a case is run.
pub type Run = fn(&mut Lab, Label) -> anyhow::Result<Findings>;

/// A case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its group and name.
    pub label: Label,
    /// When it is run.
    pub scope: Scope,
    /// Runs it.
    pub run: Run,
}

/// When a case is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// With the tests, too: it takes seconds.
    Quick,
    /// Only by the command.
    Whole,
}
