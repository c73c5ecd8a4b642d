//! Replay harness: runs the core over recorded sessions on a desktop, scores what it makes and reports what it took.

pub mod files;
pub mod metrics;
pub mod output;
pub mod progress;
pub mod replay;
pub mod report;
