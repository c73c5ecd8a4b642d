//! The app itself: its steps, its interface, and the loop that a platform shell drives.
#![forbid(unsafe_code)]

pub mod app;
pub mod interface;
pub mod live;
pub mod self_test;
