//! Recordings: what they hold, what is left of damaged ones, and how they are written.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod converted;
mod damage;
mod killed;
mod library;
mod limits;
mod small;
