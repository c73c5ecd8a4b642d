//! The border between a platform and Rust: panics stop here.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs the body of a callback; the message has the callback's name. `None` if it panicked; the
/// panic hook has then written message and place to standard error, and the caller must not trust
/// the data that the body was changing.
///
/// Neither Objective-C nor C nor Java cleans up after a Rust panic, so each callback that runs our
/// code comes through here.
pub fn guarded<T>(callback: &str, body: impl FnOnce() -> T) -> Option<T> {
    let outcome = catch_unwind(AssertUnwindSafe(body)).ok();
    if outcome.is_none() {
        eprintln!("{callback} panicked, see above");
    }
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_in_the_guard() {
        assert_eq!(guarded("a callback", || panic!("planted")), None::<u8>);
        assert_eq!(guarded("a callback", || 1), Some(1));
    }
}
