//! The activity's event loop: the effect of each life cycle event and each touch on the stage.
//!
//! The loop polls the activity's glue itself. winit's event loop does not pass `onDestroy` on,
//! while the Java thread waits in it for `android_main` to return (winit issue 4303), refuses to be
//! created a second time in one process (3325), and hides `onPause` and `onResume`, which an ARCore
//! session must follow.

use android_activity::input::{InputEvent, KeyAction, Keycode, MotionAction, MotionEvent};
use android_activity::{AndroidApp, InputStatus, MainEvent, PollEvent};

use crate::input::{Finger, Motion, touches};
use crate::stage::{Stage, StageError};
use app_shell::guard::guarded;

/// Runs until the activity is destroyed.
///
/// # Errors
/// The first error of the graphics core, which ends the loop: a fresh activity starts with a fresh
/// core.
pub(crate) fn run(app: &AndroidApp) -> Result<(), StageError> {
    let mut stage = Stage::new(app.clone());
    let mut is_destroyed = false;
    loop {
        // While drawing, until the next picture may be due; otherwise until an event.
        let timeout = stage.sleep();
        let mut outcome = Ok(());
        app.poll_events(timeout, |event| {
            if let PollEvent::Main(event) = event {
                is_destroyed |= matches!(event, MainEvent::Destroy);
                let handled = guarded("the life cycle", || handle(&event, app, &mut stage));
                outcome = stage.settle(handled);
            }
        });
        outcome?;
        if is_destroyed {
            return Ok(());
        }
        let taken = guarded("input", || take_input(app, &mut stage));
        stage.settle(taken.map(Ok))?;
        if stage.draws() {
            let drawn = guarded("a picture", || stage.present());
            stage.settle(drawn)?;
        }
    }
}

/// Applies one life cycle event. For `TerminateWindow` the surface is dropped before this returns,
/// as Android demands, and for `Pause` the camera is released.
fn handle(event: &MainEvent<'_>, app: &AndroidApp, stage: &mut Stage) -> Result<(), StageError> {
    match event {
        MainEvent::InitWindow { .. } => {
            if let Some(window) = app.native_window() {
                stage.attach(window)?;
            }
        }
        MainEvent::WindowResized { .. } => stage.resize(),
        MainEvent::TerminateWindow { .. } => stage.detach(),
        MainEvent::Resume { .. } => stage.set_foreground(true),
        MainEvent::Pause => stage.set_foreground(false),
        MainEvent::LostFocus => stage.cancel_back(),
        MainEvent::LowMemory => stage.memory_low(),
        _ => {}
    }
    Ok(())
}

/// Processes touches and the back key, and returns every other event to Android. An app that leaves
/// its queue unread is reported as not responding.
fn take_input(app: &AndroidApp, stage: &mut Stage) {
    let Ok(mut events) = app.input_events_iter() else {
        return;
    };
    let mut take = |event: &InputEvent<'_>| match event {
        InputEvent::MotionEvent(event) => take_motion(event, stage),
        InputEvent::KeyEvent(event) if event.key_code() == Keycode::Back => {
            // Java gets neither half of a press: it leaves the activity only if it gets both, so
            // the stage finishes the activity itself.
            match event.action() {
                KeyAction::Down => stage.press_back(),
                KeyAction::Up => stage.release_back(),
                _ => {}
            }
            InputStatus::Handled
        }
        _ => InputStatus::Unhandled,
    };
    while events.next(&mut take) {}
}

fn take_motion(event: &MotionEvent<'_>, stage: &mut Stage) -> InputStatus {
    let motion = match event.action() {
        MotionAction::Down | MotionAction::PointerDown => Motion::Down(event.pointer_index()),
        MotionAction::Move => Motion::Moved,
        MotionAction::Up | MotionAction::PointerUp => Motion::Up(event.pointer_index()),
        MotionAction::Cancel => Motion::Cancelled,
        _ => return InputStatus::Unhandled,
    };
    let fingers: Vec<Finger> = event
        .pointers()
        .map(|finger| Finger {
            id: finger.pointer_id(),
            at_px: [finger.x(), finger.y()],
        })
        .collect();
    for touch in touches(motion, &fingers) {
        stage.touch(touch);
    }
    InputStatus::Handled
}
