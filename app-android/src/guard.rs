//! The border between Android and Rust: panics stop here.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Where Android, or a thread, calls this shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Callback {
    /// A change of the activity's life cycle.
    LifeCycle,
    /// Fingers.
    Input,
    /// The next picture.
    Picture,
    /// An app that a panic left half changed is dropped.
    Drop,
    /// Java's own thread.
    Java,
    /// A thread of the shell's.
    Thread,
}

/// Runs the body of one callback. `None` if it panicked; the panic hook has then written message and place to the log, and the
/// caller must not trust what the body was changing.
pub(crate) fn guarded<T>(callback: Callback, body: impl FnOnce() -> T) -> Option<T> {
    let body = || {
        #[cfg(test)]
        planted::panic_in(callback);
        body()
    };
    let outcome = catch_unwind(AssertUnwindSafe(body)).ok();
    if outcome.is_none() {
        eprintln!("app-android: {callback:?} panicked, see above");
    }
    outcome
}

/// A panic on purpose.
#[cfg(test)]
mod planted {
    use std::cell::Cell;

    use super::Callback;

    thread_local! {
        pub(super) static IN: Cell<Option<Callback>> = const { Cell::new(None) };
    }

    pub(super) fn panic_in(callback: Callback) {
        assert_ne!(IN.get(), Some(callback), "planted");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Callback; 6] = [
        Callback::LifeCycle,
        Callback::Input,
        Callback::Picture,
        Callback::Drop,
        Callback::Java,
        Callback::Thread,
    ];

    #[test]
    fn a_panic_in_any_callback_ends_there() {
        for callback in ALL {
            planted::IN.set(Some(callback));
            assert_eq!(guarded(callback, || 1), None, "{callback:?}");
            planted::IN.set(None);
            assert_eq!(guarded(callback, || 1), Some(1), "{callback:?}");
        }
    }

    /// Calls of functions that take a callback, without a guard right at its beginning.
    fn unguarded(source: &str) -> Vec<&str> {
        let takers = [".poll_events(", ".run_on_java_main_thread(", ".spawn(", ".next(|"];
        let calls = takers.iter().flat_map(|taker| source.split(taker).skip(1));
        calls
            .map(|rest| rest.split_once("\n    }\n").map_or(rest, |(body, _)| body))
            .filter(|body| !body.contains("guarded(Callback::"))
            .collect()
    }

    #[test]
    fn each_callback_of_the_platform_is_guarded() {
        let sources = [
            include_str!("lifecycle.rs"),
            include_str!("java.rs"),
            include_str!("stage.rs"),
        ];
        for source in sources {
            assert_eq!(unguarded(source), [""; 0]);
        }
        for callback in ALL {
            let name = format!("guarded(Callback::{callback:?}");
            assert!(
                sources.iter().any(|source| source.contains(&name)),
                "{name} is nowhere"
            );
        }
        let planted = "fn a() {\n        app.poll_events(None, |event| handle(event));\n    }\n";
        assert_eq!(unguarded(planted).len(), 1);
    }
}
