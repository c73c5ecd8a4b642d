//! The phone's position by ARCore: a session from its installation to its frames.
//!
//! All of it is plain Rust over a table of C functions ([`ffi::Functions`]). On a phone the table
//! is that of the loaded library; in tests it is a fake's, so that no code here runs for the first
//! time on a phone. `convert` contains all knowledge of ARCore's axes and pixel rules.

pub mod convert;
pub mod feed;
pub mod ffi;
pub mod frame;
pub mod java;
pub mod session;
pub mod status;
pub mod tracker;

#[cfg(target_os = "android")]
pub mod library;

mod anchors;
mod card;
mod exposure;
pub mod modes;
mod owned;
mod planes;

#[cfg(any(test, feature = "fake"))]
pub mod fake;
#[cfg(test)]
mod header;
#[cfg(test)]
mod tests;
