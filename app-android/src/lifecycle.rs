//! The activity's event loop: which life cycle event does what to the stage.
//!
//! The loop polls the activity's glue itself. winit's event loop does not pass `onDestroy` on, while the Java thread
//! waits in it for `android_main` to return (winit issue 4303), refuses to be created a second time in one process
//! (3325), and hides `onPause` and `onResume`, which an ARCore session must follow.

use std::time::Duration;

use android_activity::{AndroidApp, InputStatus, MainEvent, PollEvent};

use crate::stage::{Stage, StageError};

/// What the activity is doing, as far as drawing is concerned.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Activity {
    /// Between `onResume` and `onPause`.
    Resumed,
    /// Not in front: there may be a window, but nothing new is drawn.
    Paused,
    /// `onDestroy` waits for the loop to end.
    Destroyed,
}

/// Runs until the activity is destroyed.
///
/// # Errors
/// The first error of the graphics core, which ends the loop: a fresh activity starts with a fresh core.
pub(crate) fn run(app: &AndroidApp) -> Result<(), StageError> {
    let mut stage = Stage::new();
    let mut activity = Activity::Paused;
    loop {
        let draws = activity == Activity::Resumed && stage.has_window();
        // While drawing, the wait for the display inside `present` sets the pace; otherwise sleep until an event.
        let timeout = draws.then_some(Duration::ZERO);
        let mut outcome = Ok(());
        app.poll_events(timeout, |event| {
            if let PollEvent::Main(event) = event {
                outcome = handle(event, app, &mut stage, &mut activity);
            }
        });
        outcome?;
        if activity == Activity::Destroyed {
            return Ok(());
        }
        decline_input(app);
        if activity == Activity::Resumed {
            stage.present()?;
        }
    }
}

/// Applies one life cycle event. For `TerminateWindow` the surface is gone before this returns, as Android demands.
fn handle(
    event: MainEvent<'_>,
    app: &AndroidApp,
    stage: &mut Stage,
    activity: &mut Activity,
) -> Result<(), StageError> {
    match event {
        MainEvent::InitWindow { .. } => {
            if let Some(window) = app.native_window() {
                stage.attach(window)?;
            }
        }
        MainEvent::WindowResized { .. } => stage.resize(),
        MainEvent::TerminateWindow { .. } => stage.detach(),
        MainEvent::Resume { .. } => *activity = Activity::Resumed,
        MainEvent::Pause => *activity = Activity::Paused,
        MainEvent::Destroy => *activity = Activity::Destroyed,
        _ => {}
    }
    Ok(())
}

/// Hands every input event back to Android. An app that leaves its queue unread is reported as not responding.
fn decline_input(app: &AndroidApp) {
    if let Ok(mut events) = app.input_events_iter() {
        while events.next(|_| InputStatus::Unhandled) {}
    }
}
