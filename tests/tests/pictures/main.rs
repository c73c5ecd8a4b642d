//! Drawing, decisions and counts: the core, its plans, its reports and the app on top of it.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod app;
mod camera_frame;
mod core;
mod device;
mod device_kept;
mod goldens;
mod governor;
mod inbetween;
mod ledger;
mod plan;
mod profile;
mod self_test;
mod trace;
