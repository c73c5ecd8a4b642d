//! The border between iOS and Rust: panics stop here.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Where iOS, or a thread, calls this shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Callback {
    /// The view was laid out.
    Layout,
    /// The next picture.
    Picture,
    /// Fingers.
    Touches,
    /// Memory is short.
    MemoryLow,
    /// A scene gets its window.
    Connect,
    /// And loses it.
    Disconnect,
    /// The app comes to the front.
    Foreground,
    /// And leaves it.
    Background,
    /// An app that a panic left half changed is dropped.
    Drop,
    /// The AR session has ended by itself.
    SessionFailed,
    /// It is interrupted, or no longer.
    SessionInterrupted,
    /// A camera frame.
    SessionFrame,
    /// A thread of an encoder's, or of the shell's.
    Thread,
}

/// Runs the body of one callback. `None` if it panicked; the panic hook has then written message and place to standard error, and the
/// caller must not trust what the body was changing.
///
/// Objective-C frames neither handle nor clean up after a Rust panic, so each callback that runs our code comes
/// through here.
pub(crate) fn guarded<T>(callback: Callback, body: impl FnOnce() -> T) -> Option<T> {
    let body = || {
        #[cfg(test)]
        planted::panic_in(callback);
        body()
    };
    let outcome = catch_unwind(AssertUnwindSafe(body)).ok();
    if outcome.is_none() {
        eprintln!("app-ios: {callback:?} panicked, see above");
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

    const ALL: [Callback; 13] = [
        Callback::Layout,
        Callback::Picture,
        Callback::Touches,
        Callback::MemoryLow,
        Callback::Connect,
        Callback::Disconnect,
        Callback::Foreground,
        Callback::Background,
        Callback::Drop,
        Callback::SessionFailed,
        Callback::SessionInterrupted,
        Callback::SessionFrame,
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

    /// Methods that Objective-C calls, without a guard. Those that only return a constant or call the superclass need none.
    fn unguarded(source: &str) -> Vec<&str> {
        const CONSTANT: [&str; 3] = ["layerClass)", "init)", "session_should_attempt_relocalization"];
        let classes = source
            .split("define_class!(")
            .skip(1)
            .map(|rest| rest.split_once("\n);").map_or(rest, |(class, _)| class));
        let methods = classes.flat_map(|class| {
            let methods = class.split("#[unsafe(method").skip(1);
            methods.map(|rest| rest.split_once("\n        }\n").map_or(rest, |(body, _)| body))
        });
        methods
            .filter(|body| !CONSTANT.iter().any(|constant| body.contains(constant)))
            .filter(|body| !body.contains("guarded(Callback::") && !body.contains("self.run(Callback::"))
            .collect()
    }

    #[test]
    fn each_method_that_objective_c_calls_is_guarded() {
        let sources = [
            include_str!("view.rs"),
            include_str!("scene.rs"),
            include_str!("arkit/session.rs"),
            include_str!("jpeg.rs"),
            include_str!("video.rs"),
        ];
        for source in sources {
            assert_eq!(unguarded(source), [""; 0]);
        }
        for callback in ALL {
            let name = format!("(Callback::{callback:?}");
            assert!(
                sources.iter().any(|source| source.contains(&name)),
                "{name} is nowhere"
            );
        }
        let planted = "define_class!(\n        #[unsafe(method(tapped:))]\n        fn tapped(&self) {\n            self.tap();\n        }\n);";
        assert_eq!(unguarded(planted).len(), 1);
    }
}
