//! Files: toys, sessions, recordings, imports; the programs that read and write them; and the rules
//! of the source tree.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bench;
mod card;
mod check;
mod dependencies;
mod documents;
mod film;
mod gizmo;
mod imported;
mod imports;
mod inbetween;
mod measured;
mod metrics;
mod mutated;
mod photographer;
mod recording;
mod session;
mod stability;
mod tidy;
mod toy;
