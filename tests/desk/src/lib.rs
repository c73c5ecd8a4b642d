//! The desktop programs: they run the core over recorded sessions, score its pictures and report
//! its cost.

pub mod alignment;
pub mod card;
pub mod check;
pub mod convert;
mod doubts;
pub mod false_color;
pub mod files;
pub mod frames;
pub mod gizmo;
pub mod import;
pub mod lens;
mod lights_drawn;
pub mod metrics;
pub mod opened;
pub mod output;
pub mod page;
pub mod program;
pub mod progress;
mod ratio;
pub mod replay;
mod replay_error;
mod replay_out;
pub mod report;
pub mod shaders;
pub mod stored;
pub mod toy_file;
