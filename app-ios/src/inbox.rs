//! What callbacks leave for the shell, which takes it when it is free: no callback finds it at work.

use std::cell::RefCell;

use app_core::app::ShellEvent;
use app_core::interface::Touch;

/// What a callback tells.
#[derive(Debug)]
pub enum Told {
    /// For the app.
    Event(ShellEvent),
    /// For its interface.
    Touch(Touch),
}

/// What was told and not taken yet, in its order.
#[derive(Debug, Default)]
pub struct Inbox(RefCell<Vec<Told>>);

impl Inbox {
    /// Leaves an event. A camera frame takes the place of one that still waits: late frames are of no use.
    pub fn tell(&self, event: ShellEvent) {
        let mut waiting = self.0.borrow_mut();
        if matches!(event, ShellEvent::Frame(_)) {
            waiting.retain(|told| !matches!(told, Told::Event(ShellEvent::Frame(_))));
        }
        waiting.push(Told::Event(event));
    }

    /// Leaves a touch.
    pub fn touch(&self, touch: Touch) {
        self.0.borrow_mut().push(Told::Touch(touch));
    }

    /// All of it; what is told meanwhile waits for the next time.
    #[must_use]
    pub fn take(&self) -> Vec<Told> {
        self.0.take()
    }
}
