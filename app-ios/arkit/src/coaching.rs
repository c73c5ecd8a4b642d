//! ARKit's own guidance over the camera's picture, in the phone's language: it shows how to move
//! the phone until a table is found.

use objc2::MainThreadOnly;
use objc2::rc::Retained;
use objc2_ar_kit::{ARCoachingGoal, ARCoachingOverlayView, ARSession};
use objc2_ui_kit::{UIView, UIViewAutoresizing};

/// The guidance.
pub(super) struct Coach(Retained<ARCoachingOverlayView>);

impl Coach {
    /// The guidance over a whole view; it passes touches through.
    pub(super) fn over(view: &UIView, session: &ARSession) -> Self {
        // SAFETY: made on the main thread, as the view was; the session lives as long as what refers to it.
        let overlay = unsafe {
            let overlay = ARCoachingOverlayView::new(view.mtm());
            overlay.setSession(Some(session));
            overlay.setGoal(ARCoachingGoal::HorizontalPlane);
            overlay.setActivatesAutomatically(false);
            overlay
        };
        overlay.setFrame(view.bounds());
        overlay.setAutoresizingMask(UIViewAutoresizing::FlexibleWidth | UIViewAutoresizing::FlexibleHeight);
        overlay.setUserInteractionEnabled(false);
        view.addSubview(&overlay);
        Self(overlay)
    }

    /// Lets the guidance appear when it helps, or hides it.
    pub(super) fn helps(&self, is_on: bool) {
        // SAFETY: setting properties of a view, on the main thread.
        unsafe {
            self.0.setActivatesAutomatically(is_on);
            if !is_on {
                self.0.setActive_animated(false, true);
            }
        }
    }
}
