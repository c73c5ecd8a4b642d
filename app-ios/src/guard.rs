//! The border between iOS and Rust: panics stop here.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs the body of one callback, or of one thread. `None` if it panicked; the panic hook has then written message and place to
/// standard error, and the caller must not trust what the body was changing.
///
/// Objective-C frames neither handle nor clean up after a Rust panic, so each callback that runs our code comes
/// through here.
pub(crate) fn guarded<T>(body: impl FnOnce() -> T) -> Option<T> {
    catch_unwind(AssertUnwindSafe(body)).ok()
}
