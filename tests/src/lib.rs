//! Replay harness: runs the core over recorded sessions on a desktop, scores what it makes and reports what it took.

pub mod alignment;
pub mod bench;
pub mod check;
pub mod compare;
pub mod convert;
pub mod endless;
pub mod false_color;
pub mod files;
pub mod fuzz;
pub mod glb;
pub mod golden;
pub mod heap;
pub mod metrics;
pub mod output;
pub mod page;
pub mod photographer;
pub mod process;
pub mod program;
pub mod progress;
pub mod random;
pub mod reference;
pub mod replay;
pub mod report;
pub mod session_format;
pub mod stability;
pub mod stored;
