//! The core as a shell uses it, on the bundled session.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bundled;
mod camera;
mod coplanar;
mod file;
mod lent;
mod normals;
mod quirks;
mod refused;
mod reuse;
mod scale;
mod still;
mod warnings;
