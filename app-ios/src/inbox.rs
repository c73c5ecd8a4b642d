//! Messages that callbacks leave for the shell, which reads them when it is idle: no callback
//! interrupts its work.

use std::cell::RefCell;

use app_core::app::ShellEvent;
use app_core::interface::Touch;
use app_core::interface::accesskit::ActionRequest;

/// A message of a callback.
#[derive(Debug)]
pub enum CallbackMessage {
    /// An event for the app.
    Event(ShellEvent),
    /// A touch for its interface.
    Touch(Touch),
    /// An action of VoiceOver.
    Request(ActionRequest),
}

/// Unread messages, in their order.
#[derive(Debug, Default)]
pub struct Inbox(RefCell<Vec<CallbackMessage>>);

impl Inbox {
    /// Leaves an event. A camera frame replaces one that still waits, since late frames are
    /// useless.
    pub fn tell(&self, event: ShellEvent) {
        let mut waiting = self.0.borrow_mut();
        if matches!(event, ShellEvent::Frame(_)) {
            waiting.retain(|message| !matches!(message, CallbackMessage::Event(ShellEvent::Frame(_))));
        }
        waiting.push(CallbackMessage::Event(event));
    }

    /// Leaves a touch.
    pub fn touch(&self, touch: Touch) {
        self.0.borrow_mut().push(CallbackMessage::Touch(touch));
    }

    /// Leaves an action of VoiceOver.
    pub fn request(&self, request: ActionRequest) {
        self.0.borrow_mut().push(CallbackMessage::Request(request));
    }

    /// Returns all messages; those that arrive meanwhile wait for the next call.
    #[must_use]
    pub fn take(&self) -> Vec<CallbackMessage> {
        self.0.take()
    }
}
